"""What a set of measurements reports: predictions beside measured values."""

from __future__ import annotations

import csv
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

Array = NDArray[np.float64]
Row = dict[str, str]

DATA = Path(__file__).with_name("data")


@dataclass(frozen=True)
class Group:
    """Values of one kind, predicted or fitted together.

    Attributes
    ----------
    name
        For example ``"predicted: 52 g"``.
    measured, found : (n,) array
        Measured and computed values.
    unit
        Of both.
    fitted
        Whether a constant was fitted to them.
    """

    name: str
    measured: Array
    found: Array
    unit: str = "mm"
    fitted: bool = False

    @property
    def off(self) -> Array:
        """Computed minus measured."""
        return self.found - self.measured

    @property
    def mean(self) -> float:
        """Mean of the absolute deviations over the mean of the absolute measured values."""
        return float(np.mean(np.abs(self.off)) / np.mean(np.abs(self.measured)))

    @property
    def rms(self) -> float:
        """Root mean square deviation."""
        return float(np.sqrt(np.mean(self.off**2)))

    @property
    def largest(self) -> float:
        """Largest absolute deviation."""
        return float(np.max(np.abs(self.off)))


@dataclass(frozen=True)
class Measurement:
    """A set of measurements and what Flexor says.

    Attributes
    ----------
    name, title
        File name of the figure, and heading.
    about
        Apparatus, model and source, in Markdown.
    groups
        The deviations.
    verdict
        What follows, and what the model lacks where it fails, in Markdown.
    headings, rows
        The table of all values.
    draw, caption
        The figure.
    panels
        Its number of panels.
    """

    name: str
    title: str
    about: str
    groups: Sequence[Group]
    verdict: str
    headings: Sequence[str]
    rows: Sequence[Sequence[str]]
    draw: Callable[[Figure], None]
    caption: str
    panels: int = 1


def read(folder: str, name: str) -> list[Row]:
    """Read a CSV file of a set of measurements."""
    with (DATA / folder / name).open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def beside(found: float, measured: float | None, decimals: int = 1) -> str:
    """Return the cells of a measured and a computed value."""
    left = "" if measured is None else f"{measured:.{decimals}f}"
    return f"{left} / {found:.{decimals}f}"
