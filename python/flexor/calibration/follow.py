"""Paths of equilibria that one or more targets look at, for many sets of constants at once."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from flexor._engine import STATUS
from flexor.calibration.observable import Followed, Observable
from flexor.calibration.system import System
from flexor.design import Geometry, ParameterSet
from flexor.errors import InputError
from flexor.model import Model

Array = NDArray[np.float64]
# Newton iterations for one load step of the global search. Good models need some ten; the others,
# curled up or thrown about, would take most of the time to be found far off.
_HASTE = 200


@dataclass(frozen=True, eq=False)
class _Start:
    """What the engine follows: parameters (n, P), of which some columns differ between rows."""

    model: Model
    parameters: Array
    columns: NDArray[np.intp]
    values: Array


@dataclass(frozen=True, eq=False)
class PathRun:
    """The path of one system with one design through one list of loads.

    Attributes
    ----------
    system : System
        The model.
    design : (k,) array or None
        Parameters of the design, SI; None for the model's own.
    parameters : ParameterSet or None
        Their set.
    loads : (s, inputs) array
        Loads [N], the first of which is reached from no load.
    observed : tuple of (Observable, tuple of int)
        What is looked at, and at which loads.
    place : str
        File and target, for messages.
    """

    system: System
    design: Array | None
    parameters: ParameterSet | None
    loads: Array
    observed: tuple[tuple[Observable, tuple[int, ...]], ...]
    place: str

    @property
    def size(self) -> int:
        """How many values come out."""
        return sum(len(steps) for _, steps in self.observed)

    @property
    def cost(self) -> float:
        """About how much work it is, to begin with what is cheap."""
        return float(len(self.loads))

    def evaluate(self, x: Array, haste: bool = False, threads: int = 1) -> Array:
        """Observe n sets of constants.

        Parameters
        ----------
        x : (n, c) array
            Constants, SI.
        haste : bool
            Give up early where equilibria are hard to find.
        threads : int
            Of the engine.

        Returns
        -------
        (n, size) array
            SI values; NaN where the path failed.
        """
        if self.system.rates is None:
            rows = [self._follow(self._rebuilt(row), haste, 1) for row in x]
            return np.concatenate(rows) if rows else np.empty((0, self.size))
        return self._follow(self._moved(x), haste, threads)

    @cached_property
    def _base(self) -> tuple[Array, NDArray[np.intp]]:
        """Parameters at the middle constants with the design, and which of them constants move."""
        model, rates = self.system.reference, self.system.rates
        assert rates is not None
        base = model.parameters.copy()
        if self._geometry is not None:
            indices, values = model.geometry_slots(self._geometry)
            base[indices] = values[0]
        return base, np.flatnonzero(np.any(rates != 0.0, axis=1))

    @property
    def _geometry(self) -> Geometry | None:
        if self.parameters is None or self.design is None:
            return None
        points = self.system.reference.design.points
        return self.parameters.geometry(self.design[None, :], points)

    def _moved(self, x: Array) -> _Start:
        rates = self.system.rates
        assert rates is not None
        base, columns = self._base
        parameters = base + (x - self.system.middle) @ rates.T
        values = np.ascontiguousarray(parameters[:, columns])
        return _Start(self.system.reference, parameters, columns, values)

    def _rebuilt(self, x: Array) -> _Start:
        model = self.system.model(x)
        parameters = model.parameters.copy()
        if self._geometry is not None:
            indices, values = model.geometry_slots(self._geometry)
            parameters[indices] = values[0]
        none = np.zeros(0, dtype=np.intp)
        return _Start(model, parameters[None, :], none, np.zeros((1, 0)))

    def _follow(self, at: _Start, haste: bool, threads: int) -> Array:
        loaded = int(bool(self.loads[0].any())) if self.loads.size else 0
        steps = np.concatenate([np.zeros((loaded, self.loads.shape[1])), self.loads])
        options = {"max_iterations": _HASTE} if haste else {}
        found = at.model.engine.path(
            at.columns, at.values, steps, threads, base=at.parameters[0], **options
        )
        paths = Followed(
            at.model,
            at.parameters,
            found["q"][:, loaded:],
            found["tip_force"][:, loaded:],
            found["touching"][:, loaded:],
        )
        good = (found["status"] == STATUS.index("converged"))[:, loaded:]
        parts: list[Array] = []
        for observable, judged in self.observed:
            last = max(judged)
            reached = np.all(good[:, : last + 1], axis=1)
            seen = observable.values(paths)[:, list(judged)]
            parts.append(np.where(reached[:, None], seen, np.nan))
        return np.concatenate(parts, axis=1)


def merged(runs: Sequence[PathRun]) -> PathRun:
    """Join runs of one system, design and loads into one that observes what all of them do."""
    first = runs[0]
    observed = tuple(entry for run in runs for entry in run.observed)
    return PathRun(first.system, first.design, first.parameters, first.loads, observed, first.place)


def check_design(parameters: ParameterSet, system: System, place: str) -> None:
    """Refuse a constant that moves what a design sets.

    Raises
    ------
    InputError
        Naming both.
    """
    rod = system.reference.design.rod
    taken = ["length"] if parameters.length_column is not None else []
    taken += ["radius"] if parameters.profile is not None else []
    for part in taken:
        if (name := system.mover(f"{rod}.{part}")) is not None:
            raise InputError(
                f'{place}: a design of {parameters.name} sets the {part} of "{rod}", which the '
                f'constant "{name}" sets as well: one of them must leave it.'
            )
