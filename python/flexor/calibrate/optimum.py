"""Optima of a design search as observables: where the best design lies, and how far it bends."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from flexor.calibrate.system import System
from flexor.search import Search
from flexor.study import optimize

Array = NDArray[np.float64]
_FORCE_COST = 1000.0


@dataclass(frozen=True, eq=False)
class OptimumRun:
    """The best design of a parameter set on one system, searched for each set of constants.

    Attributes
    ----------
    system : System
        The model.
    parameters : str
        Name of the parameter set.
    objective : str
        Name of the objective.
    force : (s,) array or None
        Forces [N], judged at the last; the model's own unless given.
    method : Search
        How to search.
    observed : tuple of str
        Labels of the set, or ``"bending"``, in the order in which they come out.
    place : str
        File and target, for messages.
    """

    system: System
    parameters: str
    objective: str
    force: Array | None
    method: Search
    observed: tuple[str, ...]
    place: str

    @property
    def size(self) -> int:
        """How many values come out."""
        return len(self.observed)

    @property
    def cost(self) -> float:
        """About how much work it is, to begin with what is cheap."""
        return _FORCE_COST * len(self.parameters)

    def evaluate(self, x: Array, haste: bool = False, threads: int = 1) -> Array:
        """Observe n sets of constants (n, c); see `PathRun.evaluate`."""
        del haste
        from flexor.study import Threads

        rows = []
        for constants in x:
            study = optimize(
                self.system.model(constants),
                self.parameters,
                self.objective,
                self.method,
                force=self.force,
                executor=Threads(threads),
            )
            found = dict.fromkeys(self.observed, np.nan)
            if study.record.best() is not None:
                found = {**study.best.parameters, "bending": study.best.bending}
            rows.append([found[label] for label in self.observed])
        return np.array(rows).reshape(len(x), self.size)
