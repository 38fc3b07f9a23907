"""The outcome of a calibration."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from flexor.calibration.knowledge import Knowledge
from flexor.calibration.refine import Minimum
from flexor.calibration.variant import Variant
from flexor.model import Model

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Fit:
    """Constants that a local fit ended at.

    Attributes
    ----------
    variant : Variant
        Under which options.
    minimum : Minimum
        Where.
    values : tuple of (m,) arrays
        What comes out for each goal, SI; NaN for held-out ones that were not asked for.
    """

    variant: Variant
    minimum: Minimum
    values: tuple[Array, ...]

    @cached_property
    def x(self) -> Array:
        """All constants, (c,), SI."""
        return np.asarray(self.variant.x(self.minimum.u[None, :])[0])

    @property
    def constants(self) -> dict[str, float]:
        """Constants by name, SI."""
        names = (constant.name for constant in self.variant.constants)
        return dict(zip(names, self.x.tolist(), strict=True))

    @property
    def misfit(self) -> float:
        """Sum of the squared residuals of the fitted targets, in standard deviations."""
        return self.minimum.misfit

    @cached_property
    def met(self) -> bool:
        """Whether every hard target is met within its tolerance."""
        return all(
            bool(np.all(np.abs(value - goal.value) <= goal.tolerance))
            for goal, value in zip(self.variant.goals, self.values, strict=True)
            if goal.hard
        )

    def models(self) -> dict[str, Model]:
        """Build the models with these constants, by name."""
        return {name: system.model(self.x) for name, system in self.variant.systems.items()}


@dataclass(frozen=True, eq=False)
class Calibration:
    """What a calibration found.

    Attributes
    ----------
    title : str
        The targets file's.
    source : str
        That file's name.
    fits : tuple of Fit
        The best first: those that meet every hard target before the others, then by misfit.
        Fits that are nearly as good, and the best of every variant.
    knowledge : Knowledge
        What the targets say about the constants of the best fit.
    seed, evaluations : int
        Of everything drawn at random; how many paths and optima were evaluated.
    folder : Path or None
        Where it is kept.
    """

    title: str
    source: str
    fits: tuple[Fit, ...]
    knowledge: Knowledge
    seed: int
    evaluations: int
    folder: Path | None

    @property
    def best(self) -> Fit:
        """The best fit."""
        return self.fits[0]

    @property
    def spare(self) -> int:
        """How many more values were fitted than constants were free."""
        return len(self.best.minimum.residuals) - len(self.best.variant.free)


def ranked(fits: Sequence[Fit]) -> list[Fit]:
    """Sort fits, the best first; see `Calibration`."""
    return sorted(fits, key=lambda fit: (not fit.met, fit.misfit))
