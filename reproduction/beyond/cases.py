"""What is compared: each model with Table I and with its best design for f_b."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np
import tomli_w

import flexor
from flexor.design import mapped, variables
from flexor.design.variables import Variables
from flexor.model import Model, parse
from reproduction.beyond import models
from reproduction.beyond.models import BASE_HEIGHT, PERCENTILE, TONE, Document
from reproduction.multistage import MultistageSearch
from reproduction.study import Array, Data, Study, bending, published_design

RADII = {
    "exosuit.radius.base": ("0.4 cm", "1.2 cm"),
    "exosuit.radius.tip": ("0.4 cm", "1.2 cm"),
}
LENGTH = {"exosuit.length": ("6 cm", "14 cm")}
# Two halves: what the radius at the base of the first is belongs to how it rests on the finger.
HALVES = {
    "exosuit.length": ("3 cm", "7 cm"),
    "far.length": ("3 cm", "7 cm"),
    "exosuit.radius.tip": ("0.4 cm", "1.2 cm"),
    "far.radius.base": ("0.4 cm", "1.2 cm"),
    "far.radius.tip": ("0.4 cm", "1.2 cm"),
    "evaluation.loads.first": ("0.1 N", "10 N"),
    "evaluation.loads.second": ("0.1 N", "10 N"),
}
CURL = ("angle.ph_2 >= 60 deg at end", "angle.ph_3 >= 40 deg at end")


@dataclass(frozen=True)
class Case:
    """One thing that the paper leaves out.

    Attributes
    ----------
    title : str
        What there is beyond the paper.
    document : callable
        Returns the model file.
    varied : str
        Which fields the search varies: "R01", "L+R01" or "halves".
    subject_to : tuple of str
        What is asked for.
    effort : float
        Share of the evaluations that others have.
    """

    title: str
    document: Callable[[], Document]
    varied: str = "R01"
    subject_to: tuple[str, ...] = ()
    effort: float = 1.0

    def model(self, changes: Data | None = None) -> Model:
        """Return the model, with changes of its fields."""
        text = tomli_w.dumps(self.document())
        return Model(parse(text, changes=changes or {}, source=self.title))

    def parameters(self, model: Model) -> Variables:
        """Return what the search varies."""
        if self.varied == "halves":
            return variables(HALVES, model)
        if "bracket" in model.file.bodies:
            return _with_bracket(model)
        return variables({**(LENGTH if "L" in self.varied else {}), **RADII}, model)


CASES: dict[str, Case] = {
    "paper": Case("as in the paper", models.finger),
    "pin": Case("tips tied by a pin", partial(models.tied, "pin")),
    "slider": Case("tips tied by a slider", partial(models.tied, "slider")),
    "weld": Case("tips tied by a weld", partial(models.tied, "weld")),
    "friction": Case(f"friction {models.FRICTION:g}", models.with_friction, effort=0.25),
    "wrapped": Case("wrapped", models.wrapped),
    "muscles": Case("relaxed muscles", partial(models.with_muscles, 0.0)),
    "tone": Case(f"muscles at {TONE:.1%}", partial(models.with_muscles, TONE)),
    "mean": Case("mean finger", models.finger, "L+R01"),
    "small": Case("5th percentile", partial(models.of_size, -PERCENTILE), "L+R01"),
    "large": Case("95th percentile", partial(models.of_size, PERCENTILE), "L+R01"),
    "curl": Case("two chambers", models.two_chambers, "halves", CURL, 0.5),
    "curl-slider": Case(
        "two chambers, tips tied by a slider",
        partial(models.two_chambers, "slider"),
        "halves",
        CURL,
        0.5,
    ),
}


def compute(study: Study, name: str) -> Data:
    """Return the response with Table I, and that of the best design for f_b at 5 N.

    Returns
    -------
    dict
        ``before`` and ``after``, each as `outcome` returns it, the ``labels`` and ``units`` of the
        design variables, and the number of ``evaluations``.
    """
    return study.cached(name, lambda: _compute(study, CASES[name]))


def outcome(path: flexor.Path) -> Data:
    """Return the angles of the joints and their sum [rad] at the last load, and what led there."""
    return {
        "angles": [float(angle) for angle in path.joint_angles[-1]],
        "bending": bending(path),
        "at_rest": bending(path, 0),
        "snaps": len(path.events),
        "converged": bool(path.converged.all()),
        "stable": bool(path.stable[-1]),
    }


def followed(case: Case, design: Array | None = None) -> flexor.Path:
    """Follow Table I, or a design of the case [SI], to the last load."""
    if design is None:
        return case.model().equilibrium()
    changes = case.parameters(case.model()).changes(np.asarray(design))
    return case.model(changes).equilibrium()


def _compute(study: Study, case: Case) -> Data:
    model = case.model()
    chosen = case.parameters(model)
    budget = max(int(case.effort * study.effort.multistage * min(chosen.size, 3) / 3), 10)
    search = "auto" if case.subject_to else MultistageSearch(budget)
    found = flexor.optimize(
        model,
        chosen,
        "bending",
        search,
        subject_to=case.subject_to,
        start=_starts(case, chosen),
        seed=study.seed,
        budget=budget if case.subject_to else None,
    )
    design = found.best.vector
    return {
        "labels": list(chosen.labels),
        "units": list(chosen.units),
        "design": [float(each) for each in design],
        "shown": (design / chosen.scale).tolist(),
        "evaluations": found.evaluations,
        "feasible": bool(found.best.feasible),
        "before": outcome(followed(case)),
        "after": outcome(followed(case, design)),
    }


def _starts(case: Case, chosen: Variables) -> Array:
    """Return Table I and the published optimum of the same parameters."""
    if case.varied == "halves":
        return chosen.start[None, :]
    published = published_design(case.varied)
    return np.clip(np.stack((chosen.start, published)), chosen.lower, chosen.upper)


def _with_bracket(model: Model) -> Variables:
    """Return the radii of the exosuit, whose axis the bracket's height follows."""
    free = variables(RADII, model)
    return mapped(
        "R01",
        ("R_0", "R_1"),
        free.lower,
        free.upper,
        free.start,
        {
            "exosuit.radius.base": lambda p: p[0],
            "exosuit.radius.tip": lambda p: p[1],
            "bracket.placement.z": lambda p: BASE_HEIGHT + p[0],
        },
        model,
        units=("cm", "cm"),
    )
