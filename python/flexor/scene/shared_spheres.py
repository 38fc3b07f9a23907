"""Links that end in the same sphere, such as two phalanges at their joint.

Their surfaces coincide there, so that what touches one has to be seen on both.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from flexor.arrays import Array
from flexor.scene.objects import Attached
from flexor.scene.pressure import Footprint

if TYPE_CHECKING:
    from flexor.model import Path

_SAME = 1e-6  # distance below which two surfaces are one [m]
Prints = Mapping[tuple[str, str], Footprint]


def borrowed(
    path: Path, link: Attached, frames: Mapping[str, Array], prints: Prints
) -> Iterator[tuple[Footprint, Array]]:
    """Yield what touches other links at a sphere that they share with one.

    Parameters
    ----------
    path
        Equilibria of one design.
    link
        The surface of the link.
    frames : dict of (s, m, 4, 4) arrays
        Frames of all bodies.
    prints
        By the names of rod and link.

    Yields
    ------
    Footprint
        In the frame of the link.
    (v,) array
        Which vertices of the link are on the sphere.
    """
    for (_, other), each in prints.items():
        for here, there in (("base", "tip"), ("tip", "base")) if other != link.name else ():
            radius = _radius(path, link.name, here)
            centre, beside = _end(frames[link.name], here), _end(frames[other], there)
            apart = np.abs(centre - beside).max()
            if max(apart, abs(radius - _radius(path, other, there))) > _SAME:
                continue
            own, base = frames[link.name][:, 0], frames[other][:, 0]
            world = each.points @ base[:, :3, :3].transpose(0, 2, 1) + base[:, None, :3, 3]
            points = (world - own[:, None, :3, 3]) @ own[:, :3, :3]
            middle = own[0, :3, :3].T @ (centre[0] - own[0, :3, 3])
            distance = np.linalg.norm(link.local - middle, axis=1)
            yield replace(each, points=points), np.abs(distance - radius) < _SAME


def _end(frames: Array, which: str) -> Array:
    return np.asarray(frames[:, 0 if which == "base" else -1, :3, 3])


def _radius(path: Path, link: str, which: str) -> float:
    return float(path.model.slot(f"{link}.radius_{which}", path.parameters)[0])
