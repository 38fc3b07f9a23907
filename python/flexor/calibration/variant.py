"""One way to make all choices: its models, the runs that observe them, and what should come out."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from flexor.calibration.constants import Constant
from flexor.calibration.follow import PathRun
from flexor.calibration.goal import Goal
from flexor.calibration.optimum import OptimumRun
from flexor.calibration.system import System

Array = NDArray[np.float64]
Run = PathRun | OptimumRun


@dataclass(frozen=True, eq=False)
class Variant:
    """Models under one combination of options, and what is observed of them.

    Attributes
    ----------
    options : dict
        Name of the option by the name of the choice.
    constants : tuple of Constant
        All c constants.
    held : dict
        SI values of those that the options hold, by name.
    systems : dict of System
        By the model's name; the model that is calibrated first.
    runs : tuple of PathRun or OptimumRun
        Cheap ones first.
    goals : tuple of Goal
        In the order of the file.
    places : tuple of (int, slice)
        For each goal its run, and where in the run's values it is.
    """

    options: Mapping[str, str]
    constants: tuple[Constant, ...]
    held: Mapping[str, float]
    systems: Mapping[str, System]
    runs: tuple[Run, ...]
    goals: tuple[Goal, ...]
    places: tuple[tuple[int, slice], ...]

    @property
    def name(self) -> str:
        """Its options in words; empty if there was nothing to choose."""
        return ", ".join(f"{choice}: {option}" for choice, option in self.options.items())

    @cached_property
    def free(self) -> tuple[Constant, ...]:
        """The f constants that are to be found."""
        return tuple(c for c in self.constants if c.name not in self.held)

    @cached_property
    def fitted_runs(self) -> tuple[int, ...]:
        """Runs that the fit needs, cheap ones first."""
        needed = {self.places[i][0] for i, goal in enumerate(self.goals) if goal.fitted}
        return tuple(sorted(needed))

    @cached_property
    def path_runs(self) -> tuple[int, ...]:
        """Those of the fitted runs that need no search."""
        return tuple(run for run in self.fitted_runs if isinstance(self.runs[run], PathRun))

    @property
    def dear(self) -> bool:
        """Whether the fit needs searches for optima."""
        return self.path_runs != self.fitted_runs

    def x(self, u: Array) -> Array:
        """Return constants (n, c), SI, of points (n, f) of the unit cube of the free ones."""
        columns, column = [], 0
        for constant in self.constants:
            if constant.name in self.held:
                columns.append(np.full(len(u), self.held[constant.name]))
            else:
                columns.append(constant.value(u[:, column]))
                column += 1
        return np.stack(columns, axis=1)

    def of_run(self, run: int) -> list[tuple[Goal, slice]]:
        """Return the fitted goals that a run serves, and where in its values."""
        return [
            (goal, part)
            for goal, (index, part) in zip(self.goals, self.places, strict=True)
            if index == run and goal.fitted
        ]
