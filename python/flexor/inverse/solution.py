"""Find the loads at which observables have given values."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

from flexor.arrays import Array
from flexor.errors import InputError
from flexor.inverse.target import Target, targets
from flexor.model import Model, Path
from flexor.model.loads import loads as parse_loads
from flexor.model.model import Force
from flexor.model.results import Paths

# Of the change that a target asks for; far above what equilibria are solved to.
TOLERANCE = 1e-8
# Where a search that fails from the last loads begins again, on the way to each limit: the branch
# ends between them.
_RESTARTS = (0.0, 0.25, 0.5, 0.75, 1.0)
# Loads on the way to a limit at which targets are looked for, and places there to begin from.
_SAMPLES, _CROSSINGS = 32, 3


@dataclass(frozen=True)
class Reach:
    """Loads that bring a design to its targets.

    Attributes
    ----------
    path : Path
        Equilibria on the way to the targets and at them, under the loads found; the last one is
        nearest to the targets if they are not reached.
    targets : tuple of Target
        What was to be reached.
    values : (targets,) array
        What the observables are at the last load of the path, SI.
    reached : bool
        Whether these are the targets, to `TOLERANCE` of the change asked for.
    reason : str
        Why not, such as a first load without equilibrium; empty if reached.
    """

    path: Path
    targets: tuple[Target, ...]
    values: Array
    reached: bool
    reason: str = ""

    @property
    def loads(self) -> dict[str, float]:
        """The last load of each input, SI."""
        last = self.path.loads[-1].tolist()
        return dict(zip(self.path.model.inputs, last, strict=True))

    def __str__(self) -> str:
        values = zip(self.targets, self.values.tolist(), strict=True)
        shown = ", ".join(
            f"{each.observable.name} = {each.observable.shown(value, 6)}" for each, value in values
        )
        load = self.path.model.show_loads(self.path.loads[-1])
        if self.reached:
            return f"reached {shown} at {load}"
        wanted = ", ".join(map(str, self.targets))
        reason = self.reason[:1].upper() + self.reason[1:]
        return f"NOT REACHED: {wanted}. {reason}. Nearest: {shown} at {load}"

    def to_dict(self) -> dict[str, Any]:
        """Return what was to be reached, what was reached and at which loads, SI."""
        names = [each.observable.name for each in self.targets]
        return {
            "reached": self.reached,
            "reason": self.reason,
            "loads": self.loads,
            "targets": dict(zip(names, (each.value for each in self.targets), strict=True)),
            "values": dict(zip(names, self.values.tolist(), strict=True)),
        }


def reach(
    model: Model,
    to: str | Mapping[str, str | float],
    loads: Force | None = None,
    *,
    start: Any = None,
    **options: float,
) -> Reach:
    """Find the loads at which observables of a model have given values.

    The targets are approached in as many steps as the loads have, each solved for the loads by
    least squares within their range. Every state is a stable equilibrium found by following the
    loads from the start, so that a target between the two ends of a snap is not reached.

    Parameters
    ----------
    model
        The model.
    to
        Values by the name of a joint or an observable, such as ``"ph_1 = 40 deg"``; see `targets`.
        At most as many as the model has inputs. Of several solutions the one nearest to the
        step before is found.
    loads
        As for `Model.equilibrium`; the loads found stay within the range of these, input by input.
        Those of the file's ``[evaluation]`` unless given.
    start, **options
        As for `Model.equilibrium`.

    Returns
    -------
    Reach

    Raises
    ------
    InputError
        If targets or loads cannot be used.

    Examples
    --------
    >>> import flexor
    >>> model = flexor.load("examples/pneumatic-finger.toml")
    >>> found = flexor.reach(model, "bending = 45 deg")
    >>> found.reached, f"{found.loads['chamber'] / 1e3:.2f} kPa"
    (True, '40.09 kPa')
    """
    wanted = targets(to, model)
    search = _Search(model, wanted, _table(model, loads, len(wanted)), start, options)
    if search.failed:
        return _result(search, search.failed)
    steps = len(search.table) - 1
    for step in range(1, steps + 1):
        reason = search.advance(step / steps)
        if step == steps and reason:
            return _result(search, reason)
    return _result(search, "")


@dataclass
class _Search:
    """Loads found so far, and what comes next."""

    model: Model
    targets: tuple[Target, ...]
    table: Array  # (steps, inputs): loads that give the range and the number of steps
    start: Any
    options: dict[str, float]
    found: list[Array] = field(default_factory=list)  # loads, step by step

    def __post_init__(self) -> None:
        self.lower, self.upper = self.table.min(axis=0), self.table.max(axis=0)
        self.free = self.upper > self.lower
        path = self.follow(self.table[0])
        self.found.append(self.table[0])
        self.failed = ""
        if not path.converged[0, -1]:
            self.failed = f"the first load has no equilibrium ({path.status[0, -1]})"
        self.goal = np.array([each.value for each in self.targets])
        initial = self.values(path)
        # What has no value at first, such as an efficiency, is not approached in steps.
        self.initial = np.where(np.isnan(initial), self.goal, initial)
        units = np.array([each.observable.unit[0] for each in self.targets])
        # A target that holds already is kept to within its unit for display.
        change = np.abs(self.goal - self.initial)
        self.scale = np.where(change > 1e-6 * units, change, units)

    def follow(self, load: Array) -> Paths:
        """Follow the loads found so far and this one."""
        loads = np.stack([*self.found, load])
        design = self.model.own_design
        return self.model.evaluate(design, loads, 1, start=self.start, **self.options)  # type: ignore[arg-type]

    def values(self, path: Paths) -> Array:
        """Return the observables at the last load, (targets,)."""
        return np.array([each.observable.last(path)[0] for each in self.targets])

    def advance(self, fraction: float) -> str:
        """Find the loads that go a fraction of the way; return why there are none, or nothing.

        At intermediate fractions a failure has no consequence: the branch may end there, and
        another be reached by a jump.
        """
        goal = self.initial + fraction * (self.goal - self.initial)
        last, whole = self.found[-1], fraction == 1.0
        best, best_error = last, np.inf
        for limit in (self.upper, self.lower) if whole else (last,):
            for part in _RESTARTS if whole else (0.0,):
                load = self._solve(goal, last + part * (limit - last))
                error = self._error(load, goal)
                if error <= TOLERANCE:
                    self.found.append(load)
                    return ""
                if error < best_error:
                    best, best_error = load, error
                # At the limit of the range, and on the branch: nothing lies between that is nearer.
                at_limit = (self.free & (load == limit)).any()
                if at_limit and not self.follow(load).event_count.any():
                    break
        for guess in self._crossings(goal) if whole else ():
            load = self._solve(goal, guess)
            if self._error(load, goal) <= TOLERANCE:
                self.found.append(load)
                return ""
        if whole:
            # Where nothing changes with the loads, as below what first bends, the last is named.
            if self._error(self.upper, goal) <= best_error:
                best = self.upper
            self.found.append(best)
        return self._reason(best)

    def _crossings(self, goal: Array) -> list[Array]:
        """Return loads on the way to each limit where a target is passed, or is nearest.

        An observable may not change with the loads at first, or pass its target and come back.
        """
        found, last = [], self.found[-1]
        for limit in (self.upper, self.lower):
            way = last + np.linspace(0.0, 1.0, _SAMPLES + 1)[1:, None] * (limit - last)
            loads = np.stack([*self.found, *way])
            design = self.model.own_design
            path = self.model.evaluate(design, loads, 1, start=self.start, **self.options)  # type: ignore[arg-type]
            table = [each.observable.values(path)[0, -_SAMPLES:] for each in self.targets]
            off = (np.stack(table, axis=1) - goal) / self.scale
            there = np.isfinite(off).all(axis=1) & path.converged[0, -_SAMPLES:]
            error = np.where(there, np.abs(off).max(axis=1), np.inf)
            passed = there[1:] & there[:-1] & (off[1:] * off[:-1] <= 0.0).any(axis=1)
            rows = [*(np.flatnonzero(passed) + 1), int(error.argmin())]
            found += [way[row] for row in rows[:_CROSSINGS]]
        return found

    def _solve(self, goal: Array, guess: Array) -> Array:
        span = (self.upper - self.lower)[self.free]

        def load(x: Array) -> Array:
            full: Array = self.lower.copy()
            full[self.free] += x * span
            return full

        def residual(x: Array) -> Array:
            path = self.follow(load(x))
            off: Array = (self.values(path) - goal) / self.scale
            # Where there is no equilibrium: far off, so that the step is shortened.
            there = np.isfinite(off) & path.converged[0, -1]
            return np.asarray(np.where(there, off, 1e3), dtype=np.float64)

        first = np.clip((guess - self.lower)[self.free] / span, 0.0, 1.0)
        solved = least_squares(
            residual,
            first,
            jac="3-point",
            bounds=(0.0, 1.0),
            method="dogbox",
            xtol=1e-14,
            ftol=1e-14,
            gtol=1e-14,
            max_nfev=30,
        )
        return load(np.asarray(solved.x))

    def _error(self, load: Array, goal: Array) -> float:
        path = self.follow(load)
        if not path.converged[0, -1]:
            return np.inf
        return float(np.max(np.abs(self.values(path) - goal) / self.scale))

    def _at_limit(self, load: Array) -> NDArray[np.bool_]:
        return np.asarray(self.free & ((load <= self.lower) | (load >= self.upper)))

    def _reason(self, load: Array) -> str:
        """Say why the targets are not reached from the last loads."""
        at_limit = self._at_limit(load)
        if at_limit.any():
            shown = " and ".join(
                f"{name} at {self.model.show_load(load[index], '.4g', index)}"
                for index, name in enumerate(self.model.inputs)
                if at_limit[index]
            )
            return f"the loads reach their limits ({shown}): give --load a larger range"
        for limit in (self.upper, self.lower):
            for event in self.follow(limit)[0].events:
                if event.kind == "snap" and event.step == len(self.found):
                    at = self.model.show_loads(event.loads, ".4g")
                    return f"the branch ends in a snap at {at}, which passes these values"
        return "no loads within their range give these values"


def _table(model: Model, loads: Force | None, count: int) -> Array:
    if not model.inputs:
        raise InputError(f'the model "{model.name}" has no actuator: no load can reach a target.')
    table = model.evaluation_loads if loads is None else parse_loads(loads, model.input_dimensions)
    if len(table) == 1:
        table = np.concatenate([np.zeros_like(table), table])
    free = int((table.max(axis=0) > table.min(axis=0)).sum())
    if free < count:
        what = "load changes" if free == 1 else "loads change"
        raise InputError(
            f"reach has {count} targets, but only {free} {what}: give as many loads as targets, "
            f"each a range such as --load {model.inputs[0]}=0:5:1."
        )
    return table


def _result(search: _Search, reason: str) -> Reach:
    path = search.follow(search.found.pop())
    return Reach(path[0], search.targets, search.values(path), not reason, reason)
