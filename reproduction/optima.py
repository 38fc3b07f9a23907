"""Optima: as published, as one pattern search finds them, and as a thorough search does."""

from __future__ import annotations

from typing import Any

import numpy as np

import flexor
from flexor.objectives import objective as named_objective
from flexor.study import Problem
from reproduction.study import (
    LINEAR,
    SURFACE,
    Array,
    Data,
    Study,
    bending,
    follow,
    model,
    parameters,
    published_design,
)
from reproduction.thorough import Thorough

# Each set contains those on the right: its optimum cannot be worse than theirs.
NESTED = {"L+R01": ("L", "R01"), "L+Rsc": ("Rsc",), "L+RLP": ("L", "RLP")}
# Evaluations do not grow with the number of parameters without end.
MOST_COUNTED = 3
# The other objectives count contacts or look at one sphere: they jump where f_b is smooth.
OTHERS_HARDER = 2
# Designs have so many digits, and more where rounding moves the objective by more than this.
DIGITS, UNCHANGED = 5, 2e-5
# A search has found a minimum if it has this part of its gain over the default design.
FOUND = 0.99


def objective_value(name: str, design: Array, objective: str, constants: str) -> float:
    """Return the objective of a design; infinite if it fails."""
    problem = Problem(model(constants=constants), parameters(name), named_objective(objective))
    return float(problem.evaluate(np.array(design)[None, :]).value[0])


def evaluated(
    name: str, design: Array, objective: str = "bending", constants: str = SURFACE
) -> Data:
    """Return what a design does at 5 N.

    Parameters
    ----------
    name, objective, constants : str
        Parameter set, objective and set of constants.
    design : (k,) array
        SI.

    Returns
    -------
    dict
        ``design`` in SI and ``shown`` in the units of the paper, ``value`` of the objective,
        ``bending`` and ``joint_angles`` [rad], ``tip_force`` [N], ``touching`` spheres, largest
        ``overlap`` [m] and ``snaps`` on the way.
    """
    path = follow(name, design, constants)
    return {
        "design": [float(each) for each in design],
        "shown": (np.array(design) / parameters(name).scale).tolist(),
        "value": objective_value(name, design, objective, constants),
        "bending": bending(path),
        "joint_angles": path.joint_angles[-1].tolist(),
        "tip_force": float(path.tip_force[-1]),
        "touching": int(path.touching[-1]),
        "overlap": float(np.max(path.contact_forces(-1).depth, initial=0.0)),
        "snaps": len(path.events),
    }


def default_design(study: Study, constants: str = SURFACE) -> Data:
    """Return what the default design (Table I) does."""
    return study.kept(
        f"default-{constants}",
        lambda: evaluated("L", parameters("L").start, constants=constants),
    )


def published(
    study: Study, name: str, objective: str = "bending", constants: str = SURFACE
) -> Data:
    """Return what the published optimum of a set does."""
    return study.kept(
        f"published-{name}-{objective}-{constants}",
        lambda: evaluated(name, published_design(name, objective), objective, constants),
    )


def target(study: Study, best: float, constants: str = SURFACE) -> float:
    """Return the f_b from which on a search has found a minimum."""
    default = float(default_design(study, constants)["value"])
    return default - FOUND * (default - best)


def pattern_search(study: Study, name: str) -> Data:
    """Search a set as the paper did: one pattern search from the default design."""

    def compute() -> Data:
        found = flexor.optimize(
            model(), name, "bending", "pattern-search", seed=study.seed, budget=study.effort.search
        )
        return {**evaluated(name, found.best.vector), "evaluations": found.evaluations}

    return study.kept(f"pattern-search-{name}", compute)


def optimum(study: Study, name: str, objective: str = "bending", constants: str = SURFACE) -> Data:
    """Search a set thoroughly, and round the design to as many digits as it needs.

    The search starts from the default design, the published optima and the optima of the sets
    that it contains, so that a set is never worse than one of those.

    Returns
    -------
    dict
        As `evaluated`, of the rounded design; and ``digits`` and ``evaluations``.
    """
    most = study.effort.thorough * min(parameters(name).size, MOST_COUNTED)
    if objective != "bending":
        most *= OTHERS_HARDER

    def compute() -> Data:
        found = flexor.optimize(
            model(constants=constants), name, objective, Thorough(most),
            start=_starts(study, name, objective, constants), seed=study.seed,
        )  # fmt: skip
        design, digits = rounded(name, found.best.vector, objective, constants)
        return {
            **evaluated(name, design, objective, constants),
            "digits": digits,
            "evaluations": found.evaluations,
        }

    return study.kept(f"optimum-{name}-{objective}-{constants}", compute)


def rounded(
    name: str, design: Array, objective: str = "bending", constants: str = SURFACE
) -> tuple[Array, int]:
    """Round a design to the fewest digits, five at least, that leave its objective as it is.

    Returns
    -------
    design : (k,) array
        SI, of decimal numbers in the units of the paper.
    digits : int
        Significant digits and decimals that each has at most.
    """
    chosen = parameters(name)
    value = objective_value(name, design, objective, constants)
    for digits in range(DIGITS, 17):
        shown = [round(float(f"{each:.{digits}g}"), digits) for each in design / chosen.scale]
        candidate = np.clip(np.array(shown) * chosen.scale, chosen.lower, chosen.upper)
        if abs(objective_value(name, candidate, objective, constants) - value) <= UNCHANGED:
            return candidate, digits
    return design, 17


def _starts(study: Study, name: str, objective: str, constants: str) -> Array:
    chosen = parameters(name)
    starts = [chosen.start, published_design(name, objective)]
    if objective != "bending":
        starts += [
            published_design(name),
            np.array(optimum(study, name, "bending", constants)["design"]),
        ]
    else:
        inner: Any = {
            each: np.array(optimum(study, each, "bending", constants)["design"])
            for each in _contained(name)
        }
        if "L" in inner:
            starts.append(np.concatenate((inner["L"], chosen.start[1:])))
        shape = name.removeprefix("L+")
        if name.startswith("L+"):
            starts.append(np.concatenate((chosen.start[:1], inner[shape])))
            starts.append(np.concatenate((inner["L"], inner[shape])))
        if name == "L+RLP":
            line = inner[LINEAR]
            starts.append(np.concatenate((line[:1], as_legendre(line[1:], chosen.size - 1))))
        if name == "RLP":
            starts.append(as_legendre(inner["R01"], chosen.size))
    return np.unique(np.clip(np.array(starts), chosen.lower, chosen.upper), axis=0)


def _contained(name: str) -> tuple[str, ...]:
    """Sets whose optima a search begins from."""
    shape = name.removeprefix("L+")
    inner = ("L", shape) if shape != name else ()
    return (*inner, *{"RLP": ("R01",), "L+RLP": (LINEAR,)}.get(name, ()))


def as_legendre(radii: Array, count: int) -> Array:
    """Return the coefficients (12) of the straight surface between two radii (2,) [m].

    They may lie outside the bounds of the set.
    """
    coefficients = np.zeros(count)
    coefficients[0] = 100.0 * radii[0] / 2.0
    coefficients[1] = 1.5 * 100.0 * (radii[1] - radii[0])
    return coefficients


def distance(study: Study, constants: str) -> float:
    """Return how far the optima lie from the published ones.

    Returns
    -------
    float
        Mean over the 12 published lengths and radii of Tables III and IV, in % of the range of
        each parameter.
    """
    pairs = [(name, "bending") for name in ("L", "R01", LINEAR)]
    pairs += [(LINEAR, objective) for objective in ("tip-force", "bending-contact")]
    parts: list[float] = []
    for name, objective in pairs:
        chosen = parameters(name)
        ours = np.array(optimum(study, name, objective, constants)["design"])
        apart = np.abs(ours - published_design(name, objective))
        parts += (apart / (chosen.upper - chosen.lower)).tolist()
    return 100.0 * float(np.mean(parts))
