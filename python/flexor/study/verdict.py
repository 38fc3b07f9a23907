"""Whether the best design of a study can be worn and made, and how far to trust it."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from flexor.constraints import constraint, excesses
from flexor.design import Geometry, Variables
from flexor.model.geometry import SlotValues
from flexor.observables.snap_margin import snap_margin
from flexor.scenarios import Tolerance
from flexor.study.fragility import Fragile, fragile
from flexor.study.ineffective import ineffective
from flexor.study.margins import worst_errors
from flexor.study.problem import FloatArray, Problem
from flexor.study.scenario_problem import ScenarioProblem

if TYPE_CHECKING:
    from flexor.model import Path
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
# The same for the worst case within the tolerances to be worth a line.
_NEAR = 0.1
# Change of the answer for twice the elements that is worth a warning.
COARSE = 0.02


def _silent(_: str) -> None:
    pass


@dataclass(frozen=True)
class Kept:
    """A constraint at the best design."""

    name: str  # of the observable
    text: str  # as written
    value: str  # worst along the path, in its unit
    place: str  # where, and at which load
    excess: float  # in units of the bound; kept where not above 0
    default: str  # what it is called among the defaults; empty if it was asked for
    number: float  # the value, SI
    demanded: bool = True  # in every scenario; else who is served has it kept

    @property
    def state(self) -> str:
        """``"kept"``, ``"active"``, or ``"BROKEN"``; ``"not in all"`` where it need not be."""
        beyond = "BROKEN" if self.demanded else "not in all"
        return beyond if self.excess > 0.0 else "active" if self.excess > -_ACTIVE else "kept"


@dataclass(frozen=True)
class Within:
    """The worst that errors within the tolerances do."""

    what: str  # the constraint as written, or the objective's quantity
    value: str  # the worst value, in its unit; empty where the design fails
    place: str  # where, and at which load; empty for the objective
    error: str  # such as ``"exosuit.length + 0.5 mm, exosuit.section.wall - 0.1 mm"``
    # By tolerance: ``"+"`` or ``"-"`` of the whole of it, else the error with its unit, or nothing.
    signs: tuple[str, ...]
    scenario: str  # in which; empty for the model as it is
    excess: float  # in units of the bound; kept where not above 0, as the objective always is

    @property
    def kept(self) -> bool:
        """Whether the constraint holds for every error that was tried."""
        return self.excess <= 0.0

    @property
    def near(self) -> bool:
        """Whether it is nearly exceeded."""
        return self.kept and self.excess > -_NEAR


@dataclass(frozen=True, eq=False)
class Verdict:
    """What is known of a design beyond its value."""

    constraints: tuple[Kept, ...]
    bounds: tuple[str, ...]  # parameters at a bound, such as ``"wall at its lower bound, 1.5 mm"``
    # By parameter: its error, and the quantity of the objective if it is less and if it is more by
    # that, NaN where the design then fails.
    steps: tuple[str, ...]
    stated: tuple[bool, ...]  # whether that is a tolerance, or else a usual manufacturing error
    off: FloatArray  # (k, 2)
    broken: FloatArray  # (k, 2), the violation then; +inf where the design fails
    tolerances: tuple[str, ...]  # such as ``"exosuit.length ± 0.5 mm"``
    within: tuple[Within, ...]  # the constraints and the objective; none without tolerances
    fragile: tuple[Fragile, ...]  # of which 1 % moves the quantity by more than a tenth
    shown: float  # the quantity of the objective for the model as it is
    finer: float | None  # the same with twice the elements; None where that is not known
    snaps: int  # along the path
    bifurcations: int  # likewise
    # How far beyond the last load the next one is, as a share of it; see
    # `flexor.observables.snap_margin`. None for the model without loads.
    snap_margin: float | None
    warnings: tuple[str, ...]  # of the model with the design, as `flexor simulate` gives them
    ineffective: tuple[str, ...]  # variables without effect; see `flexor.study.ineffective`
    # The largest contact pressure along the path [Pa], and where; None without skins.
    pressure: tuple[float, str] | None

    @property
    def feasible(self) -> bool:
        """Whether it keeps all constraints."""
        return all(each.state != "BROKEN" for each in self.constraints)

    @property
    def robust(self) -> bool:
        """Whether it keeps them for every error within the tolerances that was tried."""
        return all(each.kept for each in self.within)

    @property
    def worst(self) -> int | None:
        """Parameter whose error changes the quantity most.

        None if one makes the design fail, and where none changes it.
        """
        loss = np.abs(self.off - self.shown).max(axis=1)
        return int(np.argmax(loss)) if loss.max() > 0.0 else None

    @classmethod
    def of(cls, design: Design, progress: Callable[[str], None] = _silent) -> Verdict:
        """Evaluate a design, those around it, and the same with twice the elements.

        ``progress`` is called with each part of the work.
        """
        problem, x = design.problem, design.vector
        chosen = problem.parameters
        progress("constraints")
        constraints = design.kept
        nominal = problem.nominal
        step = np.array([_step(problem, i, value) for i, value in enumerate(x.tolist())])
        around = np.concatenate([-np.diag(step), np.diag(step)])
        progress("an error of each parameter")
        off = nominal.evaluate(np.concatenate([x[None, :], x + around]))
        progress("all errors within the tolerances")
        within = _within(problem, x)
        progress("1 % of every number")
        sensitive = fragile(nominal, x)
        progress("twice the elements")
        finer, k = _finer(problem, x), chosen.size
        progress("variables without effect")
        # What is not the same with an error has an effect.
        same = np.isclose(off.shown[1:], off.shown[0], rtol=1e-9, atol=0.0).reshape(2, k)
        candidates = np.flatnonzero(same.all(axis=0))
        unmoved = ineffective(problem, np.stack([x, chosen.start]), candidates)
        progress("warnings of the model")
        path = design.model.equilibrium(problem.loads_of(x), **dict[str, Any](problem.options))
        kinds = [event.kind for event in path.events]
        return cls(
            constraints=constraints,
            bounds=tuple(binding(problem, x)),
            steps=tuple(_stated(problem, i, size) for i, size in enumerate(step.tolist())),
            stated=tuple(_tolerance(problem, i) is not None for i in range(k)),
            off=off.shown[1:].reshape(2, k).T,
            broken=off.violation[1:].reshape(2, k).T,
            tolerances=tuple(f"{each.field} ± {each.largest}" for each in _tolerances(problem)),
            within=within,
            fragile=sensitive,
            shown=float(off.shown[0]),
            finer=finer,
            snaps=kinds.count("snap"),
            bifurcations=kinds.count("bifurcation"),
            snap_margin=_snap_margin(design),
            warnings=tuple(path.warnings),
            ineffective=unmoved,
            pressure=_pressure(path),
        )


def _pressure(path: Path) -> tuple[float, str] | None:
    """Return the largest contact pressure along a path [Pa] and where it is."""
    if not path.model.has_skins:
        return None
    bound = constraint("contact-pressure <= 1 Pa", path.model)
    values = bound.observable(path.model).values(path.as_batch)
    if not np.isfinite(values).any():
        return None
    return float(np.nanmax(values)), bound.place(path)


def _snap_margin(design: Design) -> float | None:
    if not design.problem.model.inputs:
        return None
    return float(snap_margin(design.path.as_batch)[0, -1])


def kept(design: Design) -> Iterator[Kept]:
    """Yield the constraints of a design, each of the scenario where it is worst, without errors."""
    problem, x = design.problem, design.vector
    values = problem.worst_of(design.constraint_values)[None, :]
    if isinstance(problem, ScenarioProblem):
        none = np.zeros((1, len(problem.tolerances)))
        found = problem.by_case(x[None, :], none)
        values = np.concatenate([each.constraint_values for each in found])
    excess = excesses(problem.constraints, values)
    for i, each in enumerate(problem.constraints):
        worst = int(np.argmax(np.where(np.isnan(excess[:, i]), np.inf, excess[:, i])))
        where = each.place(_path(design, worst))
        if isinstance(problem, ScenarioProblem) and problem.named:
            where = f"{problem.scenarios[worst].name}: {where}"
        yield Kept(
            each.name,
            each.text(problem.model),
            each.observable(problem.model).shown(float(values[worst, i])),
            where,
            float(excess[worst, i]),
            each.default,
            float(values[worst, i]),
            not isinstance(problem, ScenarioProblem) or problem.aggregate.everywhere,
        )


def _path(design: Design, scenario: int) -> Path:
    """Return the path of a design in a scenario."""
    problem = design.problem
    if not isinstance(problem, ScenarioProblem) or not problem.scenarios[scenario].changes:
        return design.path
    return problem.path_of(design.vector, np.zeros(len(problem.tolerances)), scenario)


def _within(problem: Problem, x: FloatArray) -> tuple[Within, ...]:
    """Return the worst case of each constraint and of the objective within the tolerances."""
    if not isinstance(problem, ScenarioProblem) or not problem.tolerances:
        return ()
    if not problem.aggregate.everywhere:
        return ()
    found, rows = worst_errors(problem, x), []
    for i, each in enumerate(problem.constraints):
        scenario, error = found.scenario[i], found.errors[i]
        value, place = "", ""
        if np.isfinite(found.values[i]):
            path = problem.path_of(x, error, scenario)
            value = each.observable(path.model).shown(float(found.values[i]))
            place = each.place(path)
        rows.append(
            Within(
                each.text(problem.model),
                value,
                place,
                _in_words(problem, error),
                _signs(problem, error),
                problem.scenarios[scenario].name if problem.named else "",
                float(found.excess[i]),
            )
        )
    shown = f"{found.shown:.4g} {problem.objective.unit}".rstrip()
    rows.append(
        Within(
            problem.objective.quantity,
            shown if np.isfinite(found.shown) else "",
            "",
            _in_words(problem, found.error),
            _signs(problem, found.error),
            problem.scenarios[found.scenario[-1]].name if problem.named else "",
            -np.inf,
        )
    )
    return tuple(rows)


def _in_words(problem: ScenarioProblem, error: FloatArray) -> str:
    return ", ".join(
        f"{each.field} {'+' if value > 0.0 else '-'} {_size(problem, each, abs(value))}"
        for each, value in zip(problem.tolerances, error.tolist(), strict=True)
        if value
    )


def _signs(problem: ScenarioProblem, error: FloatArray) -> tuple[str, ...]:
    def sign(each: Tolerance, value: float) -> str:
        if not value:
            return ""
        whole = abs(value) == each.reach
        return f"{'+' if value > 0.0 else '-'}{'' if whole else _size(problem, each, abs(value))}"

    return tuple(map(sign, problem.tolerances, error.tolist()))


def _size(problem: ScenarioProblem, tolerance: Tolerance, size: float) -> str:
    """Return the size of an error, the largest as it was stated."""
    if size == tolerance.reach:
        return tolerance.largest
    return _amount(size, *problem.unit_of(tolerance))


def _amount(size: float, unit: str, scale: float) -> str:
    return f"{size / scale:.3g} {unit if unit != '1' else ''}".rstrip()


def _step(problem: Problem, i: int, value: float) -> float:
    """Return the tolerance of a parameter, or the usual manufacturing error, SI."""
    stated = _tolerance(problem, i)
    return _error(value, problem.parameters.units[i]) if stated is None else stated.reach


def _stated(problem: Problem, i: int, size: float) -> str:
    """Return an error of a parameter in words, as it was stated."""
    chosen, stated = problem.parameters, _tolerance(problem, i)
    if stated is not None:
        return stated.largest
    return _amount(size, chosen.units[i], float(chosen.scale[i]))


def _tolerances(problem: Problem) -> tuple[Tolerance, ...]:
    return problem.tolerances if isinstance(problem, ScenarioProblem) else ()


def _tolerance(problem: Problem, i: int) -> Tolerance | None:
    label = problem.parameters.labels[i]
    return next((each for each in _tolerances(problem) if each.field == label), None)


def _error(value: float, unit: str) -> float:
    """Return the manufacturing error of a parameter, SI."""
    if unit in ("m", "cm", "mm", "um"):
        return THIN if abs(value) < _THIN_BELOW else DIMENSION
    return SHARE * abs(value) or SHARE


def binding(problem: Problem, x: FloatArray) -> list[str]:
    """Return which parameters of a design (k,) are at a bound, SI."""
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

    model, chosen = problem.model, problem.parameters
    changes = dict(chosen.changes(x)) if isinstance(chosen, Variables) else {}
    for name in model.rods:
        changes[f"bodies.{name}.elements"] = 2 * model.file.rod(name).elements
    finer = load(model.file, changes=changes)
    design: SlotValues | Geometry = finer.own_design
    if not isinstance(chosen, Variables):
        design, _ = chosen.designs(x[None, :], finer)
    paths = finer.evaluate(design, problem.loads_of(x), 1, **dict[str, Any](problem.options))
    return float(evaluate_objective(problem.objective, paths).shown[0])
