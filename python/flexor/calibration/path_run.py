"""Paths of equilibria that targets observe, for many sets of constants at once."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from flexor._engine import STATUS
from flexor.arrays import Array
from flexor.calibration.observable import Observable, ObservedPaths
from flexor.calibration.system import System
from flexor.design import ParameterSet
from flexor.errors import InputError
from flexor.model import Model

# Newton iterations for one load step while screening. Good models need about ten; the others would
# take most of the time only to be dropped.
_SCREENING_ITERATIONS = 200


@dataclass(frozen=True, eq=False)
class PathRun:
    """The path of one system with one design through one list of loads."""

    system: System
    design: Array | None  # (k,), SI; None for the model's own
    parameters: ParameterSet | None  # those of the design
    loads: Array  # (s, inputs) [N], the first of which is reached from no load
    observed: tuple[tuple[Observable, tuple[int, ...]], ...]  # what, at which loads

    @property
    def size(self) -> int:
        """Number of values."""
        return sum(len(steps) for _, steps in self.observed)

    @property
    def cost(self) -> float:
        """Relative cost, for ordering."""
        return float(len(self.loads))

    def evaluate(self, x: Array, screening: bool = False, threads: int = 1) -> Array:
        """Return observed values (n, size), SI, for constants x (n, c); NaN where a path failed.

        Screening gives up early.
        """
        rates = self.system.rates
        if rates is not None:
            base, columns = self._base
            parameters = base + (x - self.system.middle) @ rates.T
            return self._follow(self.system.reference, parameters, columns, screening, threads)
        found = np.empty((len(x), self.size))
        for i, row in enumerate(x):
            model, none = self.system.model(row), np.zeros(0, dtype=np.intp)
            found[i] = self._follow(model, self._parameters(model)[None, :], none, screening, 1)[0]
        return found

    @cached_property
    def _base(self) -> tuple[Array, NDArray[np.intp]]:
        """Parameters at the middle constants with the design, and which of them constants move."""
        rates = self.system.rates
        assert rates is not None
        return self._parameters(self.system.reference), np.flatnonzero(np.any(rates != 0.0, axis=1))

    def _parameters(self, model: Model) -> Array:
        """Parameters of a model with the design."""
        parameters = model.parameters.copy()
        if self.parameters is not None and self.design is not None:
            points = self.system.reference.design.points
            geometry = self.parameters.geometry(self.design[None, :], points)
            indices, values = model.geometry_slots(geometry)
            parameters[indices] = values[0]
        return parameters

    def _follow(
        self,
        model: Model,
        parameters: Array,
        columns: NDArray[np.intp],
        screening: bool,
        threads: int,
    ) -> Array:
        """Observe parameters (n, P) of the engine, which differ in some columns."""
        loaded = int(bool(self.loads[0].any())) if self.loads.size else 0
        steps = np.concatenate([np.zeros((loaded, self.loads.shape[1])), self.loads])
        options = {"max_iterations": _SCREENING_ITERATIONS} if screening else {}
        values = np.ascontiguousarray(parameters[:, columns])
        found = model.engine.path(columns, values, steps, threads, base=parameters[0], **options)
        paths = ObservedPaths(
            model,
            parameters,
            found["q"][:, loaded:],
            found["tip_force"][:, loaded:],
            found["touching"][:, loaded:],
            found["obstacle_force"][:, loaded:],
        )
        good = (found["status"] == STATUS.index("converged"))[:, loaded:]
        parts: list[Array] = []
        for observable, steps_seen in self.observed:
            last = max(steps_seen)
            reached = np.all(good[:, : last + 1], axis=1)
            seen = observable.values(paths)[:, list(steps_seen)]
            parts.append(np.where(reached[:, None], seen, np.nan))
        return np.concatenate(parts, axis=1)


def check_design(parameters: ParameterSet, system: System, place: str) -> None:
    """Raise InputError if a constant sets a field that a design of the set sets as well."""
    rod = system.reference.design.rod
    taken = ["length"] if parameters.length_column is not None else []
    taken += ["radius"] if parameters.profile is not None else []
    for part in taken:
        if (name := system.mover(f"{rod}.{part}")) is not None:
            raise InputError(
                f'{place}: a design of {parameters.name} sets the {part} of "{rod}", which the '
                f'constant "{name}" sets as well: one of them must leave it.'
            )
