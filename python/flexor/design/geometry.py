"""Geometry of a batch of designs in the engine's format, and its derivative."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]


@dataclass(frozen=True)
class Geometry:
    """Length and surface S(X) of the exosuit for n designs at m points X in [0, 1].

    Attributes
    ----------
    length : (n,) array
        Length L [m].
    radius : (n, m) array
        Surface S(X) [m], the distance from the rod's axis.
    slope : (n, m) array
        dS/dX [m]; X is the fraction of the length, so the slope per metre is this over L.
    """

    length: FloatArray
    radius: FloatArray
    slope: FloatArray


@dataclass(frozen=True)
class GeometryJacobian:
    """Exact derivative of a `Geometry` with respect to the k parameters of its set.

    Attributes
    ----------
    length : (n, k) array
        dL/dp.
    radius : (n, m, k) array
        dS/dp.
    slope : (n, m, k) array
        d(dS/dX)/dp.
    """

    length: FloatArray
    radius: FloatArray
    slope: FloatArray
