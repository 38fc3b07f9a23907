"""Radius of a body, and sizes of sections, along its length."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
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


class Spline(Table):
    """A size that is a cubic B-spline along the rod, such as ``{ spline = ["8 mm", "6 mm"] }``.

    Its control values are equally spaced on a clamped uniform knot vector; with fewer than four
    the degree is one less than their number. The size is linear in them, has the first and the
    last at the ends, and stays between the smallest and the largest (de Boor 1978, chapter XI).
    """

    spline: Annotated[tuple[PositiveLength, ...], Field(min_length=1, max_length=100)]


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


def is_spline(value: object) -> bool:
    """Return whether a value of a file, read or not, is a `Spline`."""
    return isinstance(value, Spline) or (isinstance(value, dict) and "spline" in value)


def _form(value: object) -> str:
    if is_spline(value):
        return "spline"
    return "samples" if isinstance(value, (list, tuple)) else "taper"


LinkRadius = Annotated[Taper, BeforeValidator(_expand)]
RodRadius = Annotated[
    Annotated[Taper, Tag("taper")]
    | Annotated[Samples, Tag("samples")]
    | Annotated[Spline, Tag("spline")],
    Discriminator(_form),
    BeforeValidator(_expand),
]


def interpolated(size: Spline | tuple[float, ...], points: Array) -> tuple[Array, Array]:
    """Interpolate a size that is given along a rod.

    Equally spaced samples by a monotone cubic, which stays within their range; see also `Spline`.

    Returns the value and its derivative with respect to X at the points X in [0, 1], each (P,).

    Notes
    -----
    Fritsch and Carlson's monotone cubic interpolation; linear for two samples.
    """
    if isinstance(size, Spline):
        values, slopes = spline_basis(len(size.spline), points)
        control = np.array(size.spline, dtype=float)
        return values @ control, slopes @ control
    curve = _monotone(tuple(map(float, size)))
    return np.asarray(curve(points)), np.asarray(curve.derivative()(points))


@lru_cache(maxsize=64)
def _monotone(samples: tuple[float, ...]):  # type: ignore[no-untyped-def]
    from scipy.interpolate import PchipInterpolator  # deferred: slow to import

    return PchipInterpolator(np.linspace(0.0, 1.0, len(samples)), np.array(samples))


def spline_basis(count: int, points: Array) -> tuple[Array, Array]:
    """Return how a `Spline` depends on its control values.

    Parameters
    ----------
    count
        Number k of control values.
    points : (P,) array
        X in [0, 1].

    Returns
    -------
    values, slopes : (P, k) arrays
        Derivatives of the size, and of its slope by X, with respect to each control value.
    """
    points = np.ascontiguousarray(points, dtype=float)
    return _basis(count, points.tobytes())


@lru_cache(maxsize=512)
def _basis(count: int, points: bytes) -> tuple[Array, Array]:
    from scipy.interpolate import BSpline  # deferred: slow to import

    curve = BSpline(_knots(count), np.eye(count), _degree(count))
    at = np.frombuffer(points)
    slopes = curve.derivative()(at) if count > 1 else np.zeros((len(at), 1))
    return np.asarray(curve(at)), np.asarray(slopes)


def _degree(count: int) -> int:
    return min(3, count - 1)


def _knots(count: int) -> Array:
    degree = _degree(count)
    inner = np.linspace(0.0, 1.0, count - degree + 1)
    return np.concatenate([np.zeros(degree), inner, np.ones(degree)])


def spline_points(count: int) -> Array:
    """Return the points X at which control values act (Greville abscissae), (k,)."""
    degree, knots = _degree(count), _knots(count)
    if not degree:
        return np.array([0.5])
    return np.array([knots[i + 1 : i + degree + 1].mean() for i in range(count)])


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


def surface(radius: Taper | Spline | tuple[float, ...], points: Array) -> tuple[Array, Array]:
    """Return S(X) and dS/dX [m] of a rod at the points X in [0, 1], each (P,)."""
    if isinstance(radius, Taper):
        rise = float(radius.tip) - float(radius.base)
        return float(radius.base) + rise * points, np.full_like(points, rise)
    return interpolated(radius, points)
