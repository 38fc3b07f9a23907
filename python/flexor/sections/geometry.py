"""A cross-section as parts of material and cavities."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from flexor.arrays import Array
from flexor.errors import InputError
from flexor.sections.linear import Linear, at
from flexor.sections.shapes import Cells, Shape, moments


@dataclass(frozen=True)
class Part:
    """A shape of one material.

    Parameters
    ----------
    shape
        The shape.
    material
        Name of the material.
    stretch
        Its stretch where the rod is in its reference state.
    winding
        Radius of the winding about the centre of the shape's arc, which keeps the section that it
        encloses while the incompressible wall moves along its radii; zero where a wound material is
        outside of its winding and free. Without, a wound material has hoop stretch 1 and stays.
    stiffening
        Whether it is no material but the resistance of some, to stretching.
    applied
        Whether it is bonded to the surface of the others, and not cast with them.
    """

    shape: Shape
    material: str
    stretch: float = 1.0
    winding: Linear | None = None
    stiffening: bool = False
    applied: bool = False

    def windings(self, cells: Cells) -> Array:
        """Return the radius of the winding and that of each cell, and their centre, (n, 8).

        As coefficients of 1 and S: of the two radii, 1 where there is no winding, and of y and z,
        those of the cell where it does not move.
        """
        none = np.array([1.0, 0.0])
        made = np.empty((len(cells.z), 8))
        made[:, :2] = none if self.winding is None else self.winding.coefficients
        made[:, 2:4], made[:, 4:6], made[:, 6:] = none, cells.y, cells.z
        if self.winding is not None and cells.radius is not None:
            made[:, 2:4] = cells.radius
            made[:, 4:6], made[:, 6:] = self.shape.y.coefficients, self.shape.z.coefficients
        return made


@dataclass(frozen=True)
class Cavity:
    """A cavity.

    Parameters
    ----------
    shapes
        Its shapes.
    enclosed
        Shapes that a pressure acts on: those of the cavity, and of the wall inside a winding.
    """

    shapes: tuple[Shape, ...]
    enclosed: tuple[Shape, ...]


@dataclass(frozen=True)
class Geometry:
    """A cross-section.

    Parameters
    ----------
    parts
        Parts of material.
    cavities
        Cavities by name.
    clearances
        Widths that must be positive, with the message of what is not, ``"wall must be …"``.
    torsion
        Torsional rigidity by Σ G A (y² + z²), given the shear moduli of the materials and S.
    """

    parts: tuple[Part, ...]
    cavities: Mapping[str, Cavity] = field(default_factory=dict)
    clearances: tuple[tuple[Linear, str], ...] = ()
    torsion: Callable[[Mapping[str, float], float], float] | None = None

    def check(self, s: float) -> None:
        """Check that the section can be made where the surface is at S = `s`.

        Raises
        ------
        InputError
            If a wall leaves no cavity, parts overlap or a cavity is outside.
        """
        for width, message in self.clearances:
            if not width.at(s) > 0.0:
                raise InputError(f"{message}, but S is {1e3 * s:.4g} mm")

    def check_parts(self, s: float, names: Mapping[int, str]) -> None:
        """Check that the shapes of a composite do not overlap and contain its cavities.

        Parameters
        ----------
        s
            S [m].
        names
            Name of each shape, materials first, for messages.

        Raises
        ------
        InputError
            If they do, or do not.
        """
        shapes: list[Shape] = [part.shape for part in self.parts]
        solid = len(shapes)
        shapes += [shape for cavity in self.cavities.values() for shape in cavity.shapes]
        for i, shape in enumerate(shapes):
            cells = shape.cells(folded=False, exact=True)
            y, z = at(cells.y, s), at(cells.z, s)
            for j, other in enumerate(shapes):
                if i != j and other.contains(y, z, s).any():
                    first, second = sorted((names[i], names[j]))
                    raise InputError(f"{first} and {second} overlap, where S is {1e3 * s:.4g} mm")
        if not solid:
            raise InputError("has no part of material")
        extents = np.array([shape.extent(s) for shape in shapes])
        low, high = extents[:solid, ::2].min(axis=0), extents[:solid, 1::2].max(axis=0)
        for i in range(solid, len(shapes)):
            if (extents[i, ::2] < low).any() or (extents[i, 1::2] > high).any():
                raise InputError(
                    f"{names[i]} is a cavity outside the section, where S is {1e3 * s:.4g} mm"
                )

    def is_symmetric(self, s: float) -> bool:
        """Whether it is symmetric in y where the surface is at S = `s`, by its first moments.

        Those of material and cavities, up to the third power of y.
        """
        sums: dict[str, Array] = {}
        hollow = [(name, shape) for name, c in self.cavities.items() for shape in c.shapes]
        for name, shape in [*((part.material, part.shape) for part in self.parts), *hollow]:
            cells = shape.cells(folded=False)
            y, z, area = at(cells.y, s) / s, at(cells.z, s) / s, at(cells.area, s) / s**2
            odd = np.stack([y, y * z, y * z * z, y**3]) @ area
            sums[name] = sums.get(name, np.zeros(4)) + odd
        return all(np.abs(each).max() < 1e-9 for each in sums.values())

    def fibres(self, materials: Mapping[str, int], folded: bool) -> list[dict[str, Any]]:
        """Describe the fibres to the engine.

        Parameters
        ----------
        materials
            Index of each material.
        folded
            Whether fibres of equal z are to be one, as in planar models.
        """
        described: dict[object, dict[str, Any]] = {}
        for part in self.parts:
            cells = part.shape.cells(folded)
            places = np.concatenate([cells.y, cells.z, part.windings(cells)], axis=1)
            if folded:
                places[:, [0, 1, 8, 9]] = 0.0
            for place, area in zip(places.tolist(), cells.area, strict=True):
                fibre = {
                    "material": materials[part.material],
                    "y": place[:2],
                    "z": place[2:4],
                    "area": np.zeros(3),
                    "stretch": part.stretch,
                    "winding": place[4:8],
                    "centre": place[8:],
                }
                key = (part.material, part.stretch, *place)
                described.setdefault(key, fibre)["area"] += area
        return [{**fibre, "area": fibre["area"].tolist()} for fibre in described.values()]

    def shear_in_series(self, moduli: Mapping[str, float], s: float) -> float:
        """Return (Σ A)²/Σ A/G [N], the stiffness of parts that shear in series; see `polar`."""
        areas = np.array([at(p.shape.cells(folded=False).area, s).sum() for p in self.parts])
        compliance = areas / np.array([moduli[part.material] for part in self.parts])
        return float(areas.sum() ** 2 / compliance.sum())

    def polar(self, moduli: Mapping[str, float], s: float) -> float:
        """Return Σ G A (y² + z²) [N m²].

        Parameters
        ----------
        moduli
            Shear modulus of each material [Pa].
        s
            S [m].
        """
        total = 0.0
        for part in self.parts:
            cells = part.shape.cells(folded=False)
            square = at(cells.y, s) ** 2 + at(cells.z, s) ** 2
            total += moduli[part.material] * float(at(cells.area, s) @ square)
        return total

    def mass(self, densities: Mapping[str, float]) -> Array:
        """Return the mass per length with its first moments, as polynomials of S.

        Parameters
        ----------
        densities
            Of each material [kg/m³].

        Returns
        -------
        (11,) array
            Coefficients of 1, S, S² of ∫ ρ dA, then those of 1, S, S², S³ of ∫ ρ y dA and ∫ ρ z dA
            [SI].
        """
        each = [
            moments((part.shape,)) * densities[part.material]
            for part in self.parts
            if not part.stiffening
        ]
        return np.asarray(np.sum(each, axis=0))
