"""The result of a calibration."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np

from flexor.arrays import Array
from flexor.calibration.identifiability import Identifiability
from flexor.calibration.local_fit import Minimum
from flexor.calibration.problem import Problem
from flexor.model import Model


@dataclass(frozen=True, eq=False)
class Fit:
    """Fitted constants."""

    problem: Problem
    minimum: Minimum  # where the local fit ended
    values: tuple[Array, ...]  # of each target, SI; NaN for held-out ones not evaluated

    @cached_property
    def x(self) -> Array:
        """The constants, (c,), SI."""
        return np.asarray(self.problem.x(self.minimum.u[None, :])[0])

    @property
    def constants(self) -> dict[str, float]:
        """The constants by name, SI."""
        names = (constant.name for constant in self.problem.constants)
        return dict(zip(names, self.x.tolist(), strict=True))

    @property
    def misfit(self) -> float:
        """Sum of the squared residuals of the fitted targets, in standard deviations."""
        return self.minimum.misfit

    @cached_property
    def met(self) -> bool:
        """Whether every hard target is met within its tolerance."""
        return all(
            bool(np.all(np.abs(value - target.value) <= target.tolerance))
            for target, value in zip(self.problem.targets, self.values, strict=True)
            if target.hard
        )

    def models(self) -> dict[str, Model]:
        """Build the models with these constants, by name."""
        return {name: system.model(self.x) for name, system in self.problem.systems.items()}


@dataclass(frozen=True, eq=False)
class Calibration:
    """The result of a calibration."""

    title: str  # of the targets file
    source: str  # name of the targets file
    fits: tuple[Fit, ...]  # the best first: those that meet every hard target before the others
    identifiability: Identifiability  # of the constants of the best fit
    seed: int
    evaluations: int  # of paths and optima
    folder: Path | None

    @property
    def best(self) -> Fit:
        """The best fit."""
        return self.fits[0]

    @property
    def degrees_of_freedom(self) -> int:
        """Number of fitted values minus number of constants."""
        return len(self.best.minimum.residuals) - len(self.best.problem.constants)
