"""A model in three dimensions at every step of a path."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from flexor.arrays import Array
from flexor.model.schema import ModelFile
from flexor.scene import pressure
from flexor.scene.connections import connection_objects
from flexor.scene.frames import frames_of
from flexor.scene.friction import friction_objects
from flexor.scene.links import link_objects
from flexor.scene.objects import Attached, Free, Object
from flexor.scene.obstacles import obstacle_objects
from flexor.scene.rods import Swept, chambers, lines, rod_objects
from flexor.scene.scale import Scale
from flexor.scene.shared_spheres import borrowed
from flexor.scene.springs import spring_objects
from flexor.scene.straps import strap_objects
from flexor.scene.tendons import tendon_objects
from flexor.scene.ties import tie_objects

if TYPE_CHECKING:
    from flexor.model import Path

STRAIN, PRESSURE = "strain", pressure.FIELD
_FIELDS = {
    STRAIN: ("strain along the axis, λ - 1", (0.01, "%"), True),
    PRESSURE: ("pressure of contact", (1e3, "kPa"), False),
}


@dataclass(frozen=True, eq=False)
class Scene:
    """What there is to see of a path; made by `scene`.

    Attributes
    ----------
    path : Path
        The equilibria.
    objects : list of Object
        Meshes of rods, links, chambers, straps, springs, tendons, wraps, obstacles, ties and points
        with friction, each at every step.
    scales : dict of Scale
        Colour scale of each field that there is, the same at every step.
    """

    path: Path
    objects: list[Object]
    scales: dict[str, Scale]

    def extent(self) -> tuple[Array, Array]:
        """Return the corners of a box with bodies and cords over all steps, each (3,) [m].

        It is that of some vertices, for looking at.
        """
        solid = [each for each in self.objects if isinstance(each, Attached)]
        points = [each.sampled(31).reshape(-1, 3) for each in solid if each.kind in ("rod", "link")]
        cords = [each for each in self.objects if isinstance(each, Free)]
        cords = [each for each in cords if each.kind in ("spring", "tendon")]
        points += [each.positions.reshape(-1, 3) for each in cords]
        every = np.concatenate(points) if points else np.zeros((1, 3))
        return every.min(axis=0), every.max(axis=0)


def scene(path: Path, file: ModelFile | None = None) -> Scene:
    """Return the meshes of a model along a path, with the fields on their surfaces.

    Parameters
    ----------
    path
        Equilibria of one design.
    file
        The model file of the design, whose sections are drawn; that of the model unless given.
        Lengths and radii are those of the path.

    Returns
    -------
    Scene
        A step without equilibrium looks as the last one that has.

    Examples
    --------
    >>> import flexor
    >>> from flexor.scene import scene
    >>> model = flexor.load("pneumatic-finger")
    >>> found = scene(model.equilibrium())
    >>> sorted({each.kind for each in found.objects})
    ['chamber', 'link', 'rod', 'strap']
    """
    shown = file or path.model.file
    frames = frames_of(path)
    rods = {name: Swept.of(path, name, frames[name], shown) for name in path.model.rods}
    prints = pressure.footprints(path, rods, frames)
    objects: list[Object] = []
    for name in shown.bodies:
        if name in rods:
            objects += _rod(name, rods[name], prints)
            objects += [*chambers(rods[name], shown), *lines(rods[name], path, shown)]
        else:
            objects += _link(path, name, frames, prints, shown)
    objects += connection_objects(path, frames, shown)
    objects += strap_objects(path, rods, frames, shown)
    objects += spring_objects(path, frames, shown)
    objects += tendon_objects(path, frames, shown)
    objects += obstacle_objects(path, frames, objects, shown)
    objects += tie_objects(path, frames, shown)
    objects += friction_objects(path, frames)
    scales = {}
    for name, (label, unit, signed) in _FIELDS.items():
        values = [each.fields[name] for each in objects if name in each.fields]
        if values:
            scales[name] = Scale.of(name, label, unit, values, signed)
    return Scene(path, objects, scales)


Prints = dict[tuple[str, str], pressure.Footprint]


def _rod(name: str, rod: Swept, prints: Prints) -> Iterator[Object]:
    mine = [each for (first, _), each in prints.items() if first == name]
    for part in rod_objects(rod):
        if rod.rod.skin is not None:
            part.fields[PRESSURE] = pressure.on_rod(part, rod, mine)
        yield part


def _link(
    path: Path, name: str, frames: Mapping[str, Array], prints: Prints, file: ModelFile
) -> Iterator[Object]:
    base, tip = (
        float(path.model.slot(f"{name}.radius_{end}", path.parameters)[0])
        for end in ("base", "tip")
    )
    mine = [each for (_, second), each in prints.items() if second == name]
    for part in link_objects(name, frames[name], (base, tip), file):
        if part.part == "skin":
            others = borrowed(path, part, frames, prints)
            part.fields[PRESSURE] = pressure.on_link(part, mine, others)
        yield part
