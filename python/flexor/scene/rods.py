"""Rods: their sections, swept along the deformed axis, with the strain on their surface."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from flexor.arrays import Array
from flexor.model.schema import ModelFile
from flexor.model.schema.pressure import Pressure
from flexor.model.schema.section_geometry import Materials, along, half_width, is_made_of_fibres
from flexor.scene.frames import reference_frames, refined, twists
from flexor.scene.objects import Attached, Kind
from flexor.sections import Geometry, Linear, Part, Sector
from flexor.sections.kinds import solid
from flexor.sections.linear import ZERO
from flexor.sections.outline import Outline, outline
from flexor.sections.shapes import Shape

if TYPE_CHECKING:
    from flexor.model import Path
    from flexor.model.schema import Rod

# Frames along a rod: at least so many.
STATIONS = 48
THREAD = 7e-4  # radius of lines that stand for chambers and cables [m]
# Sections with the stations where they are.
Groups = list[tuple[NDArray[np.intp], Geometry | None]]


@dataclass(frozen=True, eq=False)
class Swept:
    """A rod at m stations over s steps.

    Attributes
    ----------
    name, rod, materials : str, Rod and dict
        The rod as its file has it, and the materials there.
    x : (m,) array
        Stations, X in [0, 1].
    surface, half_width : (m,) arrays
        S, and half of the width along y [m].
    frames : (s, m, 4, 4) array
        Frames at the stations.
    strain : (s, m, 3) array
        Change of stretch of the axis and of the curvatures about y and z [1, 1/m, 1/m].
    """

    name: str
    rod: Rod
    materials: Materials
    x: Array
    surface: Array
    half_width: Array
    frames: Array
    strain: Array

    @classmethod
    def of(cls, path: Path, name: str, frames: Array, file: ModelFile) -> Swept:
        """Read a rod of a path, given its frames at its sample points."""
        rod = file.rod(name)
        points, parameters = rod.sample_points, path.parameters
        between = max(1, -(-STATIONS // (len(points) - 1)))
        length = float(path.model.slot(f"{name}.length", parameters)[0])
        reference = twists(reference_frames(path)[name], length * points)
        strain = (twists(frames, length * points) - reference)[..., [3, 1, 2]]
        index = np.arange(len(points))
        fine = np.linspace(0.0, len(points) - 1.0, between * (len(points) - 1) + 1)
        x = np.interp(fine, index, points)
        surface = np.interp(fine, index, path.model.slot(f"{name}.radius", parameters))
        columns = strain.transpose(0, 2, 1).reshape(-1, len(points))
        finer = np.array([np.interp(fine, index, column) for column in columns])
        return cls(
            name=name,
            rod=rod,
            materials=file.materials,
            x=x,
            surface=surface,
            half_width=half_width(rod, file.materials, surface, x),
            frames=refined(frames, between),
            strain=finer.reshape(*strain.shape[::2], -1).transpose(0, 2, 1),
        )

    @cached_property
    def length(self) -> float:
        """Its length in the first step [m]."""
        axis = self.frames[0, :, :3, 3]
        return float(np.linalg.norm(np.diff(axis, axis=0), axis=1).sum())

    def sweep(
        self, kind: Kind, part: str, rows: NDArray[np.intp], shape: Outline, name: str = ""
    ) -> Attached:
        """Sweep an outline (len(rows), n, 2) along these stations, closed at both ends."""
        m, n = shape.points.shape[:2]
        places = np.concatenate([np.arange(m * n), np.arange(n), (m - 1) * n + np.arange(n)])
        across = shape.points.reshape(-1, 2)[places]
        first, second = shape.edges.T
        a = n * np.arange(m - 1)[:, None] + first
        b = n * np.arange(m - 1)[:, None] + second
        sides = np.stack([a, b, b + n, a, b + n, a + n], axis=2).reshape(-1, 3)
        ends = [m * n + shape.triangles[:, ::-1], (m + 1) * n + shape.triangles]
        return Attached(
            name=name or self.name,
            kind=kind,
            part=part,
            faces=np.concatenate([sides, *ends]),
            local=np.concatenate([np.zeros((len(across), 1)), across], axis=1),
            frame=rows[places // n],
            frames=self.frames,
        )

    def around(self, station: int) -> Array:
        """Return points around the section at a station, y and z, (n, 2) [m]."""
        (place,) = self.rod.pieces_at(self.x[[station]]).tolist()
        rows, points = self._outlines[place]
        return np.asarray(points[int(np.searchsorted(rows, station))])

    @cached_property
    def _outlines(self) -> dict[int, tuple[NDArray[np.intp], Array]]:
        """Return stations (m,) of each piece and the points (m, n, 2) around the sections there."""
        found = {}
        for place, rows, groups in self.pieces:
            parts = [_material_parts(geometry) for _, geometry in groups]
            shapes = [[each[i].shape for each in parts] for i in range(len(parts[0]))]
            outlines = [_along(self, rows, groups, each) for each in shapes]
            found[place] = rows, np.concatenate([each.points for each in outlines], axis=1)
        return found

    @cached_property
    def pieces(self) -> list[tuple[int, NDArray[np.intp], Groups]]:
        """Each piece's index, its stations, both ends included, and its sections there."""
        return list(_pieces(self))

    def strained(self, swept: Attached, stretch: float) -> Array:
        """Return the strain λ - 1 along x at the vertices, (s, v), given the reference stretch."""
        axial, bend_y, bend_z = self.strain[:, swept.frame].transpose(2, 0, 1)
        y, z = swept.local[:, 1], swept.local[:, 2]
        return np.asarray(stretch * (1.0 + axial + z * bend_y - y * bend_z) - 1.0)


def rod_objects(swept: Swept) -> Iterator[Attached]:
    """Yield the parts of a rod, one mesh for each shape of each of its sections."""
    strained = is_made_of_fibres(swept.rod)
    for _, rows, groups in swept.pieces:
        parts = [_material_parts(geometry) for _, geometry in groups]
        for i, part in enumerate(parts[0]):
            shapes = [each[i].shape for each in parts]
            found = swept.sweep("rod", part.material, rows, _along(swept, rows, groups, shapes))
            if strained and groups[0][1] is not None:
                found.fields["strain"] = swept.strained(found, part.stretch)
            yield found


def chambers(swept: Swept, file: ModelFile) -> Iterator[Attached]:
    """Yield the cavities of a rod that are under pressure, over the span of each pressure."""
    for name, pressure in file.actuators.items():
        if not isinstance(pressure, Pressure) or pressure.rod != swept.name:
            continue
        low, high = pressure.span
        for _, rows, groups in _pieces(swept, low, high):
            hollow = [_cavity(geometry, pressure.cavity) for _, geometry in groups]
            for i in range(len(hollow[0])):
                shape = _along(swept, rows, groups, [each[i] for each in hollow])
                yield swept.sweep("chamber", "", rows, shape, name)


def lines(swept: Swept, path: Path, file: ModelFile) -> Iterator[Attached]:
    """Yield chambers and cables that act along a line on a rod, as thin tubes.

    A line outside of the section is only a lever arm: it is drawn on the surface.
    """
    for name, actuator in file.actuators.items():
        if isinstance(actuator, Pressure) or actuator.rod != swept.name:
            continue
        lever = path.model.slot(f"{name}.lever", path.parameters)
        offset = actuator.path.sampled(swept.x)[0] + swept.surface[:, None] * lever
        outside = np.hypot(offset[:, 0] / swept.half_width, offset[:, 1] / swept.surface)
        offset = offset / np.maximum(outside, 1.0)[:, None]
        around = outline(Sector(ZERO, ZERO, ZERO, Linear(THREAD)), swept.surface)
        shape = Outline(around.points + offset[:, None, :], around.edges, around.triangles)
        yield swept.sweep("line", actuator.kind, np.arange(len(swept.x)), shape, name)


def _pieces(
    swept: Swept, low: float = 0.0, high: float = 1.0
) -> Iterator[tuple[int, NDArray[np.intp], Groups]]:
    """Yield each piece of a rod as `Swept.pieces` does, between two places."""
    for place, piece in enumerate(swept.rod.pieces):
        first, last = piece.span or (0.0, 1.0)
        inside = (swept.x >= max(first, low) - 1e-9) & (swept.x <= min(last, high) + 1e-9)
        rows = np.flatnonzero(inside)
        if len(rows) > 1:
            yield place, rows, list(along(swept.rod, swept.materials, place, swept.x[rows]))


def _material_parts(geometry: Geometry | None) -> list[Part]:
    # A section that is given by its stiffness has no shape: a disc stands for it.
    shown = solid("circular", 1.0, "") if geometry is None else geometry
    return [part for part in shown.parts if not part.stiffening]


def _cavity(geometry: Geometry | None, name: str | None) -> tuple[Shape, ...]:
    cavities = {} if geometry is None else geometry.cavities
    chosen = next(iter(cavities), "") if name is None else name
    return cavities[chosen].shapes if chosen in cavities else ()


def _along(
    swept: Swept, rows: NDArray[np.intp], groups: Groups, shapes: Sequence[Shape]
) -> Outline:
    """Return the outline along stations of a shape whose sizes may vary from one to the next."""
    each = [
        outline(shape, swept.surface[rows[group]])
        for (group, _), shape in zip(groups, shapes, strict=True)
    ]
    return Outline(np.concatenate([o.points for o in each]), each[0].edges, each[0].triangles)
