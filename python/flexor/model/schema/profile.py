"""Radius of a body along its length."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

import numpy as np
from pydantic import BeforeValidator, Discriminator, Field, Tag

from flexor.arrays import Array
from flexor.model.schema.table import Table
from flexor.model.units import PositiveLength
from flexor.model.validation import describe, field_error


class Taper(Table):
    """A radius that is linear from base to tip, such as ``{ base = "2 cm", tip = "1 cm" }``."""

    base: PositiveLength
    tip: PositiveLength


Samples = Annotated[tuple[PositiveLength, ...], Field(min_length=2)]


def _expand(value: object) -> object:
    """Expand a single value to a constant radius."""
    if isinstance(value, str):
        return {"base": value, "tip": value}
    if isinstance(value, (int, float)):
        raise field_error(
            f'is {describe(value)}: write "1 cm" or {{ base = "1.2 cm", tip = "0.8 cm" }}'
        )
    return value


def _form(value: object) -> str:
    return "samples" if isinstance(value, (list, tuple)) else "taper"


LinkRadius = Annotated[Taper, BeforeValidator(_expand)]
RodRadius = Annotated[
    Annotated[Taper, Tag("taper")] | Annotated[Samples, Tag("samples")],
    Discriminator(_form),
    BeforeValidator(_expand),
]


def interpolated(samples: tuple[float, ...], points: Array) -> tuple[Array, Array]:
    """Interpolate equally spaced samples by a monotone cubic, which stays within their range.

    Returns the value and its derivative with respect to X at the points X in [0, 1], each (P,).

    Notes
    -----
    Fritsch and Carlson's monotone cubic interpolation; linear for two samples.
    """
    from scipy.interpolate import PchipInterpolator  # deferred: slow to import

    curve = PchipInterpolator(np.linspace(0.0, 1.0, len(samples)), np.array(samples, dtype=float))
    return np.asarray(curve(points)), np.asarray(curve.derivative()(points))


@dataclass(frozen=True, eq=False)
class SampledSurface:
    """The surface of a rod at P points along it.

    Attributes
    ----------
    radius, slope : (P,) arrays
        S(X) and dS/dX [m].
    """

    radius: Array
    slope: Array

    def __post_init__(self) -> None:
        self.radius.setflags(write=False)
        self.slope.setflags(write=False)


def surface(radius: Taper | tuple[float, ...], points: Array) -> tuple[Array, Array]:
    """Return S(X) and dS/dX [m] of a rod at the points X in [0, 1], each (P,)."""
    if isinstance(radius, Taper):
        rise = float(radius.tip) - float(radius.base)
        return float(radius.base) + rise * points, np.full_like(points, rise)
    return interpolated(radius, points)
