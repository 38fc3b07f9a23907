"""Geometry of the designed rod, and the space in which it is designed."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from flexor.arrays import Array
from flexor.errors import InputError
from flexor.model.schema import ModelFile
from flexor.model.schema.profile import surface
from flexor.model.validation import describe


@dataclass(frozen=True)
class Geometry:
    """Length and surface S(X) of the exosuit for n designs at m points X in [0, 1]."""

    length: Array  # (n,), L [m]
    radius: Array  # (n, m), surface S(X) [m], the distance from the rod's axis
    # (n, m), dS/dX [m]; X is the fraction of the length, so the slope per metre is this over L
    slope: Array

    def __len__(self) -> int:
        return len(self.length)

    def __getitem__(self, which: slice) -> Geometry:
        return Geometry(self.length[which], self.radius[which], self.slope[which])


@dataclass(frozen=True)
class SlotValues:
    """Values of some of the engine's parameters for n designs; the others are the model's own."""

    indices: NDArray[np.intp]  # (m,), which parameters
    values: Array  # (n, m), SI

    def __len__(self) -> int:
        return len(self.values)

    def __getitem__(self, which: slice) -> SlotValues:
        return SlotValues(self.indices, self.values[which])


@dataclass(frozen=True)
class GeometryJacobian:
    """Exact derivative of a `Geometry` with respect to the k parameters of its set."""

    length: Array  # (n, k), dL/dp
    radius: Array  # (n, m, k), dS/dp
    slope: Array  # (n, m, k), d(dS/dX)/dp


@dataclass(frozen=True)
class DesignSpace:
    """The rod that is designed, as the model has it, and the bounds of the search.

    The defaults are the paper's: length and radii from Table I, the minimum radius of 0.5 cm from
    section II-B and the radius bounds from Fig. 4. The paper states no bounds of the length; 6-14
    cm includes the default (10), all published optima (7.97-10.8) and the length of the finger
    (9.5).
    """

    length: float = 0.10  # L [m]
    radius_base: float = 0.0116  # R_0 = S(0) [m]
    radius_tip: float = 0.008  # R_1 = S(1) [m]
    length_bounds: tuple[float, float] = (0.06, 0.14)  # of the search [m]
    radius_bounds: tuple[float, float] = (0.004, 0.012)  # of the search [m]
    minimum_radius: float = 0.005  # lower limit of S(X) [m]
    rod: str = ""  # its name
    # (P,), sample points X in [0, 1] at which geometries are given
    points: Array = field(default_factory=lambda: np.zeros(0), compare=False)

    @classmethod
    def of(cls, file: ModelFile) -> DesignSpace:
        """Read the design space of a model file; InputError if it has no ``[design]``."""
        if file.design is None:
            raise InputError(
                f'the model "{file.name}" has no [design] table, which parameter sets need: say '
                'what varies, such as --vary "exosuit.length=8 cm:12 cm", and what is sought, such '
                "as --maximise bending."
            )
        design = file.design
        if design.rod is None or design.length_bounds is None or design.radius_bounds is None:
            raise InputError(
                f'the [design] of the model "{file.name}" has variables and no rod: parameter sets '
                "need rod, length_bounds, radius_bounds and minimum_radius there."
            )
        assert design.minimum_radius is not None
        rod = file.rod(design.rod)
        ends, _ = surface(rod.radius, np.array([0.0, 1.0]))
        shortest, longest = design.length_bounds
        thinnest, thickest = design.radius_bounds
        return cls(
            length=float(rod.length),
            radius_base=float(ends[0]),
            radius_tip=float(ends[1]),
            length_bounds=(float(shortest), float(longest)),
            radius_bounds=(float(thinnest), float(thickest)),
            minimum_radius=float(design.minimum_radius),
            rod=design.rod,
            points=rod.sample_points,
        )

    def checked(self, geometry: Geometry) -> Geometry:
        """Return a geometry, any object with its three arrays, as arrays of numbers.

        InputError if it is not given at the rod's sample points.
        """
        if not all(hasattr(geometry, name) for name in ("length", "radius", "slope")):
            raise InputError(
                f"the geometry is {describe(geometry)}: expected one with length, radius and "
                "slope, as ParameterSet.geometry returns."
            )
        length = np.atleast_1d(np.asarray(geometry.length, dtype=float))
        radius = np.atleast_2d(np.asarray(geometry.radius, dtype=float))
        slope = np.atleast_2d(np.asarray(geometry.slope, dtype=float))
        expected = (len(length), len(self.points))
        if radius.shape != expected or slope.shape != expected:
            raise InputError(
                f'the geometry of "{self.rod}" has radius {radius.shape} and slope {slope.shape}: '
                f"with {expected[0]} lengths and {expected[1]} sample points both must be "
                f"{expected}."
            )
        return Geometry(length, radius, slope)


PAPER = DesignSpace()
