"""How results of the components of a model become those of the whole."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from flexor.arrays import Array

Indices = NDArray[np.intp]
NAN = float("nan")


@dataclass(frozen=True)
class Joining:
    """How an array (n, s, ...) of the whole follows from those of its components.

    Attributes
    ----------
    how : str
        ``"sum"``; ``"largest"`` of what is not NaN; ``"extremes"``, the least and the greatest of
        pairs; ``"deciding"``, that of the component which decides the status; ``"rows"``, each
        component having some of the rows (n, s, m, ...); ``"shares"``, adding its share to some of
        these.
    of : str
        What the rows are: coordinates, inputs, or a list of the description.
    without : float, optional
        What it is where the whole has no equilibrium; else it is joined there, too.
    """

    how: Literal["sum", "largest", "extremes", "deciding", "rows", "shares"]
    of: str = ""
    without: float | None = None

    def joined(
        self,
        arrays: Sequence[NDArray[Any]],
        places: Sequence[Indices],
        size: int,
        deciding: Indices,
    ) -> NDArray[Any]:
        """Join the arrays of components.

        Parameters
        ----------
        arrays
            Those of the components.
        places
            Which of the whole's rows each has, of ``"rows"`` and ``"shares"``.
        size
            How many rows the whole has.
        deciding : (n, s) array
            The component that decides the status.
        """
        if self.how == "sum":
            return np.asarray(np.sum(arrays, axis=0, dtype=arrays[0].dtype))
        if self.how == "largest":
            return np.asarray(np.fmax.reduce(arrays))
        if self.how == "extremes":
            stacked: Array = np.stack(arrays)
            least, greatest = np.fmin.reduce(stacked[..., 0]), np.fmax.reduce(stacked[..., 1])
            return np.stack([least, greatest], axis=-1)
        if self.how == "deciding":
            return np.asarray(np.take_along_axis(np.stack(arrays), deciding[None], axis=0)[0])
        first = arrays[0]
        made = np.zeros((*first.shape[:2], size, *first.shape[3:]), first.dtype)
        for array, rows in zip(arrays, places, strict=True):
            made[:, :, rows] = array if self.how == "rows" else made[:, :, rows] + array
        return made


SUM = Joining("sum")
LARGEST = Joining("largest", without=0.0)
GREATEST = Joining("largest", without=NAN)
EXTREMES = Joining("extremes", without=NAN)
DECIDING = Joining("deciding")


def total(without: float) -> Joining:
    """Return the sum, which is something else where the whole has no equilibrium."""
    return Joining("sum", without=without)


def rows(of: str, without: float | None = None) -> Joining:
    """Return the rows that components have of coordinates, inputs or forces."""
    return Joining("rows", of, without)


def shares(of: str, without: float | None = None) -> Joining:
    """Return the sums, row by row, of what several components may add to."""
    return Joining("shares", of, without)
