"""Targets bound to their models: observable, target value and tolerance."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from typing import Any

import numpy as np

from flexor.arrays import Array
from flexor.calibration.observable import observable
from flexor.calibration.optimum_run import BENDING, OptimumRun
from flexor.calibration.path_run import PathRun, check_design
from flexor.calibration.schema import Target
from flexor.calibration.system import System
from flexor.design import ParameterSet, parameter_set
from flexor.errors import InputError, unknown_name
from flexor.model.loads import loads as read_loads
from flexor.model.quantity import Unit, parse_quantity
from flexor.model.units import ANGLE, LENGTH, Dimension
from flexor.objectives import objective
from flexor.optimizers import method

_KINDS = {"m": LENGTH, "cm": LENGTH, "mm": LENGTH, "rad": ANGLE, "deg": ANGLE, "1": None}
# The tolerance of a hard target is a limit: it counts as three standard deviations.
_HARD = 3.0
_PATTERN_SEARCH = {"starts": 8, "tolerance": 1e-3}


@dataclass(frozen=True, eq=False)
class BoundTarget:
    """A target bound to its model."""

    table: Target
    unit: Unit  # of its value, as written
    value: Array  # (m,) at m loads, SI
    tolerance: Array  # (m,), SI; NaN for held-out targets without one
    force: tuple[float, ...]  # of the first input at each load [N]; empty for optima

    @property
    def fitted(self) -> bool:
        """Whether it takes part in the fit."""
        return self.table.weight != "held-out"

    @property
    def hard(self) -> bool:
        """Whether it must be met within its tolerance."""
        return self.table.weight == "hard"

    @property
    def deviation(self) -> Array:
        """Standard deviation of its residuals, (m,), SI."""
        return self.tolerance / _HARD if self.hard else self.tolerance


def bind(
    target: Target, system: System, place: str
) -> tuple[BoundTarget, PathRun | OptimumRun, slice]:
    """Bind a target to the system of its model; messages begin with `place`."""
    if target.observable == "optimum":
        return _optimum(target, system, place)
    model = system.reference
    quantity = observable(target, model, place)
    steps = _loads(target, system, place)
    many = isinstance(target.value, (list, tuple))
    if many and len(target.value) != len(steps):
        raise InputError(
            f"{place}.value has {len(target.value)} entries for {len(steps)} forces: give one "
            "for each force, or a single one for the last."
        )
    chosen = tuple(range(len(steps))) if many else (len(steps) - 1,)
    value, tolerance, unit = _values(target, quantity.kind, place)
    force = tuple(float(u) for u in steps[list(chosen), 0]) if steps.shape[1] else ()
    design, parameters = _design(target, system, place)
    run = PathRun(system, design, parameters, steps, ((quantity, chosen),))
    return BoundTarget(target, unit, value, tolerance, force), run, slice(0, run.size)


def run_key(target: Target) -> str:
    """Return a key that is equal for targets of one model that can share a run."""
    if target.observable == "optimum":
        search = f"{target.method} {target.options!r}"
        return f"optimum {target.parameters} {target.objective} {search} {target.force!r}"
    return f"path {target.force!r} {target.parameters} {target.design!r}"


def _loads(target: Target, system: System, place: str) -> Array:
    model = system.reference
    if target.force is None and not model.inputs:
        return np.zeros((1, 0))
    try:
        if target.force is None:
            return model.evaluation_loads
        return read_loads(target.force, model.input_dimensions)
    except InputError as error:
        raise InputError(f"{place}: {error}") from None


def _values(target: Target, kind: Dimension | None, place: str) -> tuple[Array, Array, Unit]:
    many = isinstance(target.value, (list, tuple))
    given: Sequence[Any] = target.value if many else [target.value]
    read = [
        parse_quantity(value, kind, f"{place}.value[{i}]" if many else f"{place}.value")
        for i, value in enumerate(given)
    ]
    value = np.array([number for number, _ in read])
    unit = read[0][1]
    return value, _tolerance(target.tolerance, value, kind, f"{place}.tolerance"), unit


def _tolerance(given: object, value: Array, kind: Dimension | None, place: str) -> Array:
    if given is None:
        return np.full(value.shape, np.nan)
    if isinstance(given, str) and given.rstrip().endswith("%"):
        percent: Any = given.rstrip()[:-1]
        with suppress(ValueError):
            percent = float(percent)
        share, _ = parse_quantity(percent, None, place)
        tolerance = np.abs(value) * share / 100.0
    else:
        tolerance = np.full(value.shape, parse_quantity(given, kind, place)[0])
    if not np.all(tolerance > 0.0):
        zero = " (a part of zero)" if isinstance(given, str) and "%" in given else ""
        raise InputError(f"{place} is {given!r}{zero}: it must be greater than zero.")
    return tolerance


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
    values = [
        parse_quantity(target.design[label], kind, f"{place}.design.{label}")[0]
        for label, kind in _kinds(chosen).items()
    ]
    return np.array(values), chosen


def _kinds(chosen: ParameterSet) -> dict[str, Dimension | None]:
    units = zip(chosen.labels, chosen.units, strict=True)
    return {label: _KINDS[unit] for label, unit in units}


def _set(name: str, system: System, place: str) -> ParameterSet:
    try:
        chosen = parameter_set(name, system.reference.design)
    except InputError as error:
        raise InputError(f"{place}: {error}") from None
    check_design(chosen, system, place)
    return chosen


def _optimum(target: Target, system: System, place: str) -> tuple[BoundTarget, OptimumRun, slice]:
    chosen = _set(str(target.parameters), system, place)
    kinds = {**_kinds(chosen), BENDING: ANGLE}
    part = str(target.of)
    if part not in kinds:
        what = unknown_name(f"part of an optimum of {chosen.name}", part, kinds)
        raise InputError(f"{place}.of is the {what}.")
    if isinstance(target.value, (list, tuple)):
        raise InputError(f"{place}.value is a list: an optimum is one design, at the last force.")
    value, tolerance, unit = _values(target, kinds[part], place)
    try:
        wanted = objective(target.objective)
        defaults = _PATTERN_SEARCH if target.method == "pattern-search" else {}
        search = method(target.method, **{**defaults, **target.options})
    except InputError as error:
        raise InputError(f"{place}: {error}") from None
    if target.force is not None:
        wanted = wanted.at(_loads(target, system, place))
    run = OptimumRun(system, chosen, wanted, search)
    return BoundTarget(target, unit, value, tolerance, ()), run, run.column(part)
