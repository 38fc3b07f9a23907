"""Whether the best design of a study can be worn and made, and how far to trust it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from flexor.design import Variables
from flexor.observables.snap_margin import snap_margin
from flexor.study.problem import FloatArray, Problem

if TYPE_CHECKING:
    from flexor.study.design import Design

# Manufacturing errors of dimensions that are thin and of others [m], and of everything else as a
# share of its value.
THIN, DIMENSION, SHARE = 1e-4, 5e-4, 0.01
# Dimensions below are thin [m].
_THIN_BELOW = 5e-3
# Of the range of a parameter: nearer than that to a bound, the bound binds.
_BINDS = 1e-3
# Of the bound: a constraint that is nearer to it is active.
_ACTIVE = 0.02
# Change of the answer for 1 % of a parameter, or for twice the elements, that is worth a warning.
FRAGILE, COARSE = 0.1, 0.02


@dataclass(frozen=True)
class Kept:
    """A constraint at the best design."""

    text: str  # as written
    value: str  # worst along the path, in its unit
    place: str  # where, and at which load
    excess: float  # in units of the bound; kept where not above 0
    default: str  # what it is called among the defaults; empty if it was asked for

    @property
    def state(self) -> str:
        """``"kept"``, ``"active"`` or ``"BROKEN"``."""
        return "BROKEN" if self.excess > 0.0 else "active" if self.excess > -_ACTIVE else "kept"


@dataclass(frozen=True, eq=False)
class Verdict:
    """What is known of a design beyond its value."""

    constraints: tuple[Kept, ...]
    bounds: tuple[str, ...]  # parameters at a bound, such as ``"wall at its lower bound, 1.5 mm"``
    # By parameter: its error, and the quantity of the objective if it is less and if it is more by
    # that, NaN where the design then fails.
    steps: tuple[str, ...]
    off: FloatArray  # (k, 2)
    broken: FloatArray  # (k, 2), the violation then; +inf where the design fails
    fragile: tuple[str, ...]  # parameters of which 1 % moves the quantity by more than a tenth
    shown: float  # the quantity of the objective
    finer: float | None  # the same with twice the elements; None where that is not known
    snaps: int  # along the path
    # How far beyond the last load the next one is, as a share of it; see
    # `flexor.observables.snap_margin`. None for the model without loads.
    snap_margin: float | None

    @property
    def feasible(self) -> bool:
        """Whether it keeps all constraints."""
        return all(each.state != "BROKEN" for each in self.constraints)

    @property
    def worst(self) -> int | None:
        """Parameter whose error loses most of the quantity; None if one makes the design fail."""
        loss = np.abs(self.off - self.shown).max(axis=1)
        return None if np.isnan(loss).any() else int(np.argmax(loss))

    @classmethod
    def of(cls, design: Design) -> Verdict:
        """Evaluate a design, those around it, and the same with twice the elements."""
        problem, x = design.problem, design.vector
        chosen = problem.parameters
        path, model = design.path, problem.model
        worst = problem.worst_of(design.constraint_values)
        excess = problem.worst_excesses(design.constraint_values)
        constraints = tuple(
            Kept(
                each.text(model),
                each.observable(model).shown(float(value)),
                each.place(path),
                float(over),
                each.default,
            )
            for each, value, over in zip(problem.constraints, worst, excess, strict=True)
        )
        step = np.array([_error(value, unit) for value, unit in zip(x, chosen.units, strict=True)])
        percent = 0.01 * np.abs(x)
        around = np.concatenate([np.diag(step), np.diag(percent)])
        off = problem.evaluate(x + np.concatenate([-around, around]))
        k = chosen.size
        shown, broken = off.shown.reshape(2, 2, k), off.violation.reshape(2, 2, k)
        change = np.abs(shown[:, 1] - design.shown).max(axis=0)
        moved = (change > FRAGILE * abs(design.shown)) | np.isnan(change)
        fragile = [label for label, much in zip(chosen.labels, moved, strict=True) if much]
        return cls(
            constraints=constraints,
            bounds=tuple(_binding(problem, x)),
            steps=tuple(
                f"{size / scale:.3g} {unit if unit != '1' else ''}".rstrip()
                for size, scale, unit in zip(step, chosen.scale, chosen.units, strict=True)
            ),
            off=shown[:, 0].T,
            broken=broken[:, 0].T,
            fragile=tuple(fragile),
            shown=design.shown,
            finer=_finer(problem, x),
            snaps=design.events,
            snap_margin=float(snap_margin(path.as_batch)[0, -1]) if model.inputs else None,
        )


def _error(value: float, unit: str) -> float:
    """Return the manufacturing error of a parameter, SI."""
    if unit in ("m", "cm", "mm", "um"):
        return THIN if abs(value) < _THIN_BELOW else DIMENSION
    return SHARE * abs(value) or SHARE


def _binding(problem: Problem, x: FloatArray) -> list[str]:
    chosen = problem.parameters
    rows = zip(
        chosen.labels, chosen.units, chosen.scale, x, chosen.lower, chosen.upper, strict=True
    )
    found = []
    for label, unit, scale, value, low, high in rows:
        for name, bound in (("lower", low), ("upper", high)):
            if abs(value - bound) <= _BINDS * (high - low):
                shown = f"{bound / scale:.4g} {unit if unit != '1' else ''}".rstrip()
                found.append(f"{label} at its {name} bound, {shown}")
    return found


def _finer(problem: Problem, x: FloatArray) -> float | None:
    """Return the quantity of the objective with twice the elements of every rod."""
    from flexor.model import load
    from flexor.objectives import evaluate_objective

    if not isinstance(problem.parameters, Variables):
        return None
    model = problem.model
    changes = dict(problem.parameters.changes(x))
    for name in model.rods:
        changes[f"bodies.{name}.elements"] = 2 * model.file.rod(name).elements
    finer = load(model.file, changes=changes)
    paths = finer.evaluate(
        finer.own_design, problem.loads_of(x), 1, **dict[str, Any](problem.options)
    )
    return float(evaluate_objective(problem.objective, paths).shown[0])
