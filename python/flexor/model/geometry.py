"""The rod that may be designed, and how a designed geometry enters the engine's parameters."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from flexor.errors import InputError
from flexor.model.lowering import dorsal, points
from flexor.model.schema import ModelFile, Rod
from flexor.model.schema.profile import surface

Array = NDArray[np.float64]
Slots = Mapping[str, tuple[int, int]]


class Geometry(Protocol):
    """Geometry of a rod for n designs, S at the rod's m sample points X in [0, 1]."""

    @property
    def length(self) -> Array:
        """Length L [m], (n,)."""
        ...

    @property
    def radius(self) -> Array:
        """Surface S(X) [m], (n, m)."""
        ...

    @property
    def slope(self) -> Array:
        """Its derivative dS/dX [m], (n, m)."""
        ...


class GeometryJacobian(Protocol):
    """Derivative of a `Geometry` with respect to k parameters of each design."""

    @property
    def length(self) -> Array:
        """dL/dp, (n, k)."""
        ...

    @property
    def radius(self) -> Array:
        """dS/dp, (n, m, k)."""
        ...

    @property
    def slope(self) -> Array:
        """d(dS/dX)/dp, (n, m, k)."""
        ...


@dataclass(frozen=True)
class DesignSpace:
    """The rod of a model that is designed, as the file has it, and the bounds of the search.

    Attributes
    ----------
    rod : str
        Its name.
    length : float
        Length L [m].
    radius_base, radius_tip : float
        R_0 = S(0) and R_1 = S(1) [m].
    length_bounds, radius_bounds : tuple of float
        Lower and upper bound of the search [m].
    minimum_radius : float
        Below this no part of S may be [m].
    points : (P,) array
        Sample points X in [0, 1], at which geometries are to be given.
    """

    rod: str
    length: float
    radius_base: float
    radius_tip: float
    length_bounds: tuple[float, float]
    radius_bounds: tuple[float, float]
    minimum_radius: float
    points: Array

    @classmethod
    def of(cls, file: ModelFile) -> DesignSpace:
        """Read the design space of a model file.

        Parameters
        ----------
        file
            A checked model file.

        Raises
        ------
        InputError
            If it has no ``[design]``.
        """
        if file.design is None:
            raise InputError(f'the model "{file.name}" has no [design], so nothing to be designed.')
        rod = file.rod(file.design.rod)
        ends, _ = surface(rod.radius, np.array([0.0, 1.0]))
        return cls(
            rod=file.design.rod,
            length=float(rod.length),
            radius_base=float(ends[0]),
            radius_tip=float(ends[1]),
            length_bounds=_pair(file.design.length_bounds),
            radius_bounds=_pair(file.design.radius_bounds),
            minimum_radius=float(file.design.minimum_radius),
            points=points(rod),
        )


def _pair(bounds: tuple[float, float]) -> tuple[float, float]:
    return (float(bounds[0]), float(bounds[1]))


@dataclass(frozen=True, eq=False)
class GeometryBatch:
    """Geometry of n designs as checked arrays, which can be sliced.

    Attributes
    ----------
    length : (n,) array
        Length L [m].
    radius, slope : (n, m) arrays
        Surface S(X) and its derivative dS/dX [m].
    """

    length: Array
    radius: Array
    slope: Array

    @classmethod
    def of(cls, file: ModelFile, name: str, geometry: Geometry) -> GeometryBatch:
        """Read a geometry of a rod.

        Parameters
        ----------
        file
            The model file.
        name
            The rod.
        geometry
            Geometry of n designs.

        Raises
        ------
        InputError
            If it is not given at the rod's sample points.
        """
        length = np.atleast_1d(np.asarray(geometry.length, dtype=float))
        radius = np.atleast_2d(np.asarray(geometry.radius, dtype=float))
        slope = np.atleast_2d(np.asarray(geometry.slope, dtype=float))
        expected = (len(length), file.rod(name).sample_count)
        if radius.shape != expected or slope.shape != expected:
            raise InputError(
                f'the geometry of "{name}" has radius {radius.shape} and slope {slope.shape}: with '
                f"{len(length)} lengths and {expected[1]} sample points both must be {expected}."
            )
        return cls(length, radius, slope)

    def __len__(self) -> int:
        return len(self.length)

    def __getitem__(self, which: slice) -> GeometryBatch:
        return GeometryBatch(self.length[which], self.radius[which], self.slope[which])


def slot_values(
    file: ModelFile, name: str, slots: Slots, geometry: Geometry
) -> tuple[NDArray[np.intp], Array]:
    """Place the geometry of a rod among the engine's parameters.

    The base of a rod that is placed by its underside follows S(0): see `schema.Placement`.

    Parameters
    ----------
    file
        The model file.
    name
        The rod.
    slots
        Where the engine has its parameters.
    geometry
        Geometry of n designs.

    Returns
    -------
    indices : (k,) array
        Which parameters change.
    values : (n, k) array
        Their values.

    Raises
    ------
    InputError
        If the geometry is not given at the rod's sample points.
    """
    rod = file.rod(name)
    batch = GeometryBatch.of(file, name, geometry)
    columns = [batch.length[:, None], batch.radius, batch.slope]
    ranges = [slots[f"{name}.{part}"] for part in ("length", "radius", "slope")]
    if follows_surface(rod):
        place = np.array([rod.placement.x, rod.placement.y, rod.placement.z], dtype=float)
        columns.append(place + batch.radius[:, :1] * dorsal(rod))
        ranges.append(slots[f"{name}.translation"])
    indices = np.concatenate([np.arange(start, stop) for start, stop in ranges])
    return indices, np.concatenate(columns, axis=1)


def slot_jacobian(file: ModelFile, name: str, jacobian: GeometryJacobian) -> Array:
    """Return the derivative of the values of `slot_values`, which are linear in the geometry.

    Parameters
    ----------
    file
        The model file.
    name
        The rod.
    jacobian
        Derivative of the geometry of n designs with respect to k parameters.

    Returns
    -------
    (n, slots, k) array
        Rows in the order of the indices of `slot_values`.
    """
    rod = file.rod(name)
    rows = [jacobian.length[:, None, :], jacobian.radius, jacobian.slope]
    if follows_surface(rod):
        rows.append(jacobian.radius[:, :1, :] * dorsal(rod)[None, :, None])
    return np.concatenate(rows, axis=1)


def follows_surface(rod: Rod) -> bool:
    """Whether the base of a rod is placed by its underside and so moves with S(0)."""
    return rod.placement.reference == "underside"
