"""Targets bound to their models: what is observed, what should come out, and how exactly."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from flexor.calibration.amount import Unit, amount
from flexor.calibration.follow import PathRun, check_design
from flexor.calibration.observable import observable
from flexor.calibration.optimum import BENDING, OptimumRun
from flexor.calibration.schema import Target
from flexor.calibration.system import System
from flexor.design import ParameterSet, parameter_set
from flexor.errors import InputError, unknown_name
from flexor.model.loads import loads as read_loads
from flexor.model.units import ANGLE, LENGTH, Dimension
from flexor.objectives import objective
from flexor.optimizers import method

Array = NDArray[np.float64]
_KINDS: dict[str, Dimension | None] = {
    **dict.fromkeys(("m", "cm", "mm"), LENGTH),
    **dict.fromkeys(("rad", "deg"), ANGLE),
    "1": None,
}
# A hard target is to be met within its tolerance, which then is no standard deviation but a limit:
# it counts as three of them.
_HARD = 3.0
_PATTERN_SEARCH = {"starts": 8, "tolerance": 1e-3}


@dataclass(frozen=True, eq=False)
class Goal:
    """A target bound to its model.

    Attributes
    ----------
    target : Target
        As the file has it.
    unit : Unit
        In which its value was written.
    value : (m,) array
        What should come out, SI; m loads.
    tolerance : (m,) array
        SI; NaN for held-out targets without one.
    force : tuple of m float
        Forces of the first input at which it is observed [N]; empty for optima.
    """

    target: Target
    unit: Unit
    value: Array
    tolerance: Array
    force: tuple[float, ...]

    @property
    def fitted(self) -> bool:
        """Whether the fit sees it."""
        return self.target.weight != "held-out"

    @property
    def hard(self) -> bool:
        """Whether it is to be met within its tolerance."""
        return self.target.weight == "hard"

    @property
    def deviation(self) -> Array:
        """Standard deviation with which it counts, (m,), SI."""
        return self.tolerance / _HARD if self.hard else self.tolerance


def bound(target: Target, system: System, place: str) -> tuple[Goal, PathRun | OptimumRun, slice]:
    """Bind a target to the system of its model.

    Parameters
    ----------
    target
        The target.
    system
        Its model.
    place
        File and target, for messages.

    Returns
    -------
    Goal, PathRun or OptimumRun, slice
        What should come out, the run of which it does, and where among its values.

    Raises
    ------
    InputError
        If nothing of the model matches it, or a value cannot be read.
    """
    if target.observable == "optimum":
        return _optimum(target, system, place)
    model = system.reference
    seen = observable(target, model, place)
    steps = _loads(target, system, place)
    many = isinstance(target.value, (list, tuple))
    if many and len(target.value) != len(steps):
        raise InputError(
            f"{place}.value has {len(target.value)} entries for {len(steps)} forces: give one "
            "for each force, or a single one for the last."
        )
    chosen = tuple(range(len(steps))) if many else (len(steps) - 1,)
    value, tolerance, unit = _values(target, seen.kind, place)
    force = tuple(float(u) for u in steps[list(chosen), 0]) if steps.shape[1] else ()
    design, parameters = _design(target, system, place)
    run = PathRun(system, design, parameters, steps, ((seen, chosen),), place)
    return Goal(target, unit, value, tolerance, force), run, slice(0, run.size)


def run_key(target: Target) -> str:
    """Return what tells apart the runs of one model that cannot be one."""
    if target.observable == "optimum":
        search = f"{target.method} {target.options!r}"
        return f"optimum {target.parameters} {target.objective} {search} {target.force!r}"
    return f"path {target.force!r} {target.parameters} {target.design!r}"


def _loads(target: Target, system: System, place: str) -> Array:
    model = system.reference
    try:
        if target.force is None:
            if not model.inputs:
                return np.zeros((1, 0))
            return read_loads(model.evaluation_forces, model.inputs)
        return read_loads(target.force, model.inputs)
    except InputError as error:
        raise InputError(f"{place}: {error}") from None


def _values(target: Target, kind: Dimension | None, place: str) -> tuple[Array, Array, Unit]:
    many = isinstance(target.value, (list, tuple))
    given: Sequence[Any] = target.value if many else [target.value]
    read = [
        amount(value, kind, f"{place}.value[{i}]" if many else f"{place}.value")
        for i, value in enumerate(given)
    ]
    value = np.array([number for number, _ in read])
    unit = read[0][1]
    return value, _tolerance(target.tolerance, value, kind, f"{place}.tolerance"), unit


def _tolerance(given: object, value: Array, kind: Dimension | None, place: str) -> Array:
    if given is None:
        return np.full(value.shape, np.nan)
    if isinstance(given, str) and given.rstrip().endswith("%"):
        share, _ = amount(_number(given.rstrip()[:-1]), None, place)
        tolerance = np.abs(value) * share / 100.0
    else:
        tolerance = np.full(value.shape, amount(given, kind, place)[0])
    if not np.all(tolerance > 0.0):
        zero = " (a part of zero)" if isinstance(given, str) and "%" in given else ""
        raise InputError(f"{place} is {given!r}{zero}: it must be greater than zero.")
    return tolerance


def _number(text: str) -> object:
    try:
        return float(text)
    except ValueError:
        return text


def _design(target: Target, system: System, place: str) -> tuple[Array | None, ParameterSet | None]:
    if target.design is None or target.parameters is None:
        return None, None
    chosen = _set(target.parameters, system, place)
    for label in target.design:
        if label not in chosen.labels:
            what = unknown_name(f"parameter of {chosen.name}", label, chosen.labels)
            raise InputError(f"{place}.design has an {what}.")
    for label in chosen.labels:
        if label not in target.design:
            raise InputError(f"{place}.design.{label} is missing: {chosen.name} has it.")
    kinds = dict(zip(chosen.labels, (_KINDS[unit] for unit in chosen.units), strict=True))
    values = [
        amount(target.design[label], kinds[label], f"{place}.design.{label}")[0]
        for label in chosen.labels
    ]
    return np.array(values), chosen


def _set(name: str, system: System, place: str) -> ParameterSet:
    try:
        chosen = parameter_set(name, system.reference.design)
    except InputError as error:
        raise InputError(f"{place}: {error}") from None
    check_design(chosen, system, place)
    return chosen


def _optimum(target: Target, system: System, place: str) -> tuple[Goal, OptimumRun, slice]:
    chosen = _set(str(target.parameters), system, place)
    kinds: Mapping[str, Dimension | None] = {
        **dict(zip(chosen.labels, (_KINDS[unit] for unit in chosen.units), strict=True)),
        BENDING: ANGLE,
    }
    part = str(target.of)
    if part not in kinds:
        what = unknown_name(f"part of an optimum of {chosen.name}", part, kinds)
        raise InputError(f"{place}.of is the {what}.")
    if isinstance(target.value, (list, tuple)):
        raise InputError(f"{place}.value is a list: an optimum is one design, at the last force.")
    value, tolerance, unit = _values(target, kinds[part], place)
    try:
        wanted = objective(target.objective)
        usual = _PATTERN_SEARCH if target.method == "pattern-search" else {}
        search = method(target.method, **{**usual, **target.options})
    except InputError as error:
        raise InputError(f"{place}: {error}") from None
    if target.force is not None:
        wanted = wanted.at(_loads(target, system, place)[:, 0])
    run = OptimumRun(system, chosen, wanted, search, place)
    return Goal(target, unit, value, tolerance, ()), run, run.column(part)
