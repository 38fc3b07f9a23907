"""Colour scales of the fields on surfaces."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from flexor.arrays import Array

COLOURS = 255


@dataclass(frozen=True, eq=False)
class Scale:
    """From the values of a field to colours.

    Attributes
    ----------
    name, label : str
        The field, and what it is.
    unit : tuple of float and str
        The unit for display, in SI and by name.
    low, high : float
        Values of the first and the last colour, SI.
    colours : (255, 3) uint8 array
        Readable with colour vision deficiency: viridis, or PuOr around zero.
    """

    name: str
    label: str
    unit: tuple[float, str]
    low: float
    high: float
    colours: NDArray[np.uint8]

    @classmethod
    def of(
        cls, name: str, label: str, unit: tuple[float, str], values: Iterable[Array], signed: bool
    ) -> Scale:
        """Make the scale of a field, from zero, or around zero if it is signed."""
        largest = max((float(np.nanmax(np.abs(v), initial=0.0)) for v in values), default=0.0)
        high = largest or unit[0]
        return cls(name, label, unit, -high if signed else 0.0, high, _table(signed))

    def codes(self, values: Array) -> NDArray[np.uint8]:
        """Return the index of the colour of each value; 255 where there is no value."""
        share = (values - self.low) / (self.high - self.low)
        index = np.clip(np.rint(share * (COLOURS - 1)), 0, COLOURS - 1)
        return np.where(np.isfinite(values), np.nan_to_num(index), COLOURS).astype(np.uint8)


def _table(signed: bool) -> NDArray[np.uint8]:
    import matplotlib  # deferred: slow to import

    name, ends = ("PuOr_r", (0.05, 0.95)) if signed else ("viridis", (0.0, 1.0))
    shades = matplotlib.colormaps[name](np.linspace(*ends, COLOURS))[:, :3]
    return np.asarray(np.rint(255.0 * shades), dtype=np.uint8)
