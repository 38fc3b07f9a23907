"""Optima: published, found by one pattern search, and found by a multistage search."""

from __future__ import annotations

from typing import Any

import numpy as np

import flexor
from flexor.objectives import objective as named_objective
from flexor.study import Problem
from reproduction.multistage import MultistageSearch
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

# Each set contains those on the right: its optimum cannot be worse than theirs.
NESTED = {"L+R01": ("L", "R01"), "L+Rsc": ("Rsc",), "L+RLP": ("L", "RLP")}
# Evaluations grow with the number of parameters up to this number.
MAX_COUNTED = 3
# The other objectives count contacts or depend on a single sphere: they are discontinuous where f_b
# is smooth, and get more evaluations.
OTHER_OBJECTIVES = 2
# Minimum number of digits of a design, and the largest change of its objective by rounding.
DIGITS, ROUNDING = 5, 2e-5
# A search has found a minimum if it achieves this fraction of its gain over the default design.
SUCCESS = 0.99


def objective_value(name: str, design: Array, objective: str, constants: str) -> float:
    """Return the objective of a design; infinite if it fails."""
    problem = Problem(model(constants=constants), parameters(name), named_objective(objective))
    return float(problem.evaluate(np.array(design)[None, :]).value[0])


def evaluated(
    name: str, design: Array, objective: str = "bending", constants: str = SURFACE
) -> Data:
    """Return the response of a design at 5 N.

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
        ``overlap`` [m], and number of ``snaps`` along the path.
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
    """Return the response of the default design (Table I)."""
    return study.cached(
        f"default-{constants}",
        lambda: evaluated("L", parameters("L").start, constants=constants),
    )


def published(
    study: Study, name: str, objective: str = "bending", constants: str = SURFACE
) -> Data:
    """Return the response of the published optimum of a set."""
    return study.cached(
        f"published-{name}-{objective}-{constants}",
        lambda: evaluated(name, published_design(name, objective), objective, constants),
    )


def target(study: Study, best: float, constants: str = SURFACE) -> float:
    """Return the f_b at or below which a search counts as successful."""
    default = float(default_design(study, constants)["value"])
    return default - SUCCESS * (default - best)


def pattern_search(study: Study, name: str) -> Data:
    """Search a set as the paper did: one pattern search from the default design."""

    def compute() -> Data:
        found = flexor.optimize(
            model(),
            name,
            "bending",
            "pattern-search",
            seed=study.seed,
            budget=study.effort.pattern_search,
        )
        return {**evaluated(name, found.best.vector), "evaluations": found.evaluations}

    return study.cached(f"pattern-search-{name}", compute)


def optimum(study: Study, name: str, objective: str = "bending", constants: str = SURFACE) -> Data:
    """Return the optimum of a set by multistage search, rounded to the digits that it needs.

    The search starts from the default design, the published optima and the optima of the sets that
    this one contains, so that its optimum is never worse than theirs.

    Returns
    -------
    dict
        As `evaluated`, for the rounded design, and ``digits`` and ``evaluations``.
    """
    budget = study.effort.multistage * min(parameters(name).size, MAX_COUNTED)
    if objective != "bending":
        budget *= OTHER_OBJECTIVES

    def compute() -> Data:
        found = flexor.optimize(
            model(constants=constants), name, objective, MultistageSearch(budget),
            start=_starts(study, name, objective, constants), seed=study.seed,
        )  # fmt: skip
        design, digits = rounded(name, found.best.vector, objective, constants)
        return {
            **evaluated(name, design, objective, constants),
            "digits": digits,
            "evaluations": found.evaluations,
        }

    return study.cached(f"optimum-{name}-{objective}-{constants}", compute)


def rounded(
    name: str, design: Array, objective: str = "bending", constants: str = SURFACE
) -> tuple[Array, int]:
    """Round a design to the fewest digits, at least five, that preserve its objective.

    Returns
    -------
    design : (k,) array
        SI, rounded in the units of the paper.
    digits : int
        Maximum number of significant digits and decimals of each parameter.
    """
    chosen = parameters(name)
    value = objective_value(name, design, objective, constants)
    for digits in range(DIGITS, 17):
        shown = [round(float(f"{each:.{digits}g}"), digits) for each in design / chosen.scale]
        candidate = np.clip(np.array(shown) * chosen.scale, chosen.lower, chosen.upper)
        if abs(objective_value(name, candidate, objective, constants) - value) <= ROUNDING:
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
    """Return the sets whose optima a search starts from."""
    shape = name.removeprefix("L+")
    inner = ("L", shape) if shape != name else ()
    return (*inner, *{"RLP": ("R01",), "L+RLP": (LINEAR,)}.get(name, ()))


def as_legendre(radii: Array, count: int) -> Array:
    """Return the coefficients (12) of the linear profile between two radii (2,) [m].

    They may be outside the bounds of the set.
    """
    coefficients = np.zeros(count)
    coefficients[0] = 100.0 * radii[0] / 2.0
    coefficients[1] = 1.5 * 100.0 * (radii[1] - radii[0])
    return coefficients


def distance(study: Study, constants: str) -> float:
    """Return the mean deviation of the optima from the published ones.

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
