"""Full-factorial grid, for landscapes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexor.errors import InputError
from flexor.optimizers.interface import FloatArray
from flexor.optimizers.method import Method, Run
from flexor.optimizers.options import at_least, option

MAX_DESIGNS = 4_000_000
# Designs in each call of a function that does not stream; one that does chooses for itself.
UNSTREAMED_BATCH = 256


@dataclass(frozen=True)
class Grid(Method):
    """Evaluate a grid over some of the parameters, with the others fixed at the start.

    Attributes
    ----------
    points : int
        Number of points per parameter, both bounds included.
    columns : tuple of int
        Indices of the parameters to vary; all by default.
    """

    name = "grid"
    title = "grid"
    description = "full-factorial grid"

    points: int = option(81, at_least(2))
    columns: tuple[int, ...] = ()

    def run(self, run: Run) -> str:
        """Evaluate every point; the last column varies fastest."""
        start = run.designs(run.starts(1)[:1])[0]
        designs = grid_designs(run.lower, run.upper, start, self.points, self.columns)
        for done in run.function.stream(designs, UNSTREAMED_BATCH):
            run.step("grid", len(designs) - done)
        return f"{len(designs)} designs"


def grid_axes(
    lower: FloatArray, upper: FloatArray, points: int, columns: tuple[int, ...]
) -> list[FloatArray]:
    """Return the grid values of each column, bounds included, (points,) each."""
    return [np.linspace(lower[i], upper[i], points) for i in columns or range(lower.size)]


def grid_designs(
    lower: FloatArray,
    upper: FloatArray,
    start: FloatArray,
    points: int,
    columns: tuple[int, ...],
) -> FloatArray:
    """Return the designs of a grid; the last column varies fastest.

    The parameters of ``columns``, or all if it is empty, take ``points`` values each; the others
    are those of the ``start`` (k,). Of shape (points ** len(columns), k); InputError if that is too
    large.
    """
    dimensions = len(columns) or lower.size
    count = points**dimensions
    if count > MAX_DESIGNS:
        raise InputError(
            f"a grid of {points} points along {dimensions} parameters has {count:.3g} designs: "
            f"at most {MAX_DESIGNS:,} are allowed."
        )
    axes = grid_axes(lower, upper, points, columns)
    designs = np.tile(start, (count, 1))
    for i, values in zip(
        columns or range(lower.size), np.meshgrid(*axes, indexing="ij"), strict=True
    ):
        designs[:, i] = values.ravel()
    return designs
