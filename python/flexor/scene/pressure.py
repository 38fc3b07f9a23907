"""Pressure of contact through skins, on the surfaces that touch.

Contact is integrated across the rod in closed form, for a foundation whose indentation is a
parabola (docs/method.md). The same parabola gives the pressure beside the line where it is largest.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from flexor.arrays import Array
from flexor.scene.objects import Attached
from flexor.scene.rods import Swept

if TYPE_CHECKING:
    from flexor.model import ContactForces, Path

FIELD = "contact-pressure"


@dataclass(frozen=True, eq=False)
class Footprint:
    """What a rod's p sample points do to one link, over s steps; zero where they do not touch.

    Attributes
    ----------
    pressure, depth : (s, p) arrays
        Largest pressure across [Pa], and depth of contact there [m].
    curvature : (s, p) array
        Relative curvature across [1/m].
    half_width : (p,) array
        Half of the rod's width [m].
    points : (s, p, 3) array
        The middle of the rod's underside in the frame of the link [m].
    """

    pressure: Array
    depth: Array
    curvature: Array
    half_width: Array
    points: Array

    def at(self, distance: Array, pressure: Array, depth: Array, curvature: Array) -> Array:
        """Return the pressure at a distance from the line where it is `pressure`."""
        share = 1.0 - 0.5 * curvature * distance**2 / np.maximum(depth, 1e-12)
        return np.where(depth > 0.0, pressure * np.maximum(share, 0.0), 0.0)


def footprints(
    path: Path, rods: Mapping[str, Swept], frames: Mapping[str, Array]
) -> dict[tuple[str, str], Footprint]:
    """Return what each rod with a skin does to each link that it touches at any step.

    Parameters
    ----------
    path
        Equilibria of one design.
    rods
        The rods, by name.
    frames : dict of (s, m, 4, 4) arrays
        Frames of all bodies.

    Returns
    -------
    dict
        By the names of rod and link.
    """
    model, found = path.model, dict[tuple[str, str], Footprint]()
    described = {_rod_of(each["name"]): each for each in model.foundations}
    starts = {name: start for name, (start, _) in model.engine.sphere_groups.items()}
    for step in np.flatnonzero(np.isfinite(path.q).all(axis=1)):
        contacts = path.contact_forces(int(step))
        for index in _once(contacts):
            first, second = int(contacts.first[index]), int(contacts.second[index])
            rod, link = model.sphere_places[first][0], model.sphere_places[second][0]
            if rod not in described or link in rods:
                continue
            key = (rod, link)
            if key not in found:
                found[key] = _empty(path, rods[rod], frames[rod], frames[link])
            place = first - starts[f"{rod}.skin"]
            if contacts.pressure[index] > found[key].pressure[step, place]:
                found[key].pressure[step, place] = contacts.pressure[index]
                found[key].depth[step, place] = contacts.depth[index]
    for (rod, link), each in found.items():
        chord = frames[link][0, -1, :3, 3] - frames[link][0, 0, :3, 3]
        length = float(np.linalg.norm(chord))
        each.curvature[:] = _curvature(path, rod, link, each, described[rod], length)
    return found


def on_link(link: Attached, prints: Iterable[Footprint]) -> Array:
    """Return the pressure at the vertices of a link, (s, v); NaN where nothing touches."""
    steps = len(link.frames)
    found = np.zeros((steps, link.size))
    x, radial = link.local[:, 0], link.local[:, 1:]
    radius = np.linalg.norm(radial, axis=1)
    angle = np.arctan2(radial[:, 1], radial[:, 0])
    for each in prints:
        for step in np.flatnonzero(each.pressure.any(axis=1)):
            order = np.argsort(each.points[step, :, 0])
            along = each.points[step, order, 0]
            values = [
                np.interp(x, along, column[step, order])
                for column in (each.pressure, each.depth, each.curvature)
            ]
            across = each.points[step, order, 1:]
            y, z = (np.interp(x, along, column) for column in across.T)
            width = np.interp(x, along, each.half_width[order])
            turned = np.angle(np.exp(1j * (angle - np.arctan2(z, y))))
            distance = radius * np.sin(np.clip(turned, -0.5 * np.pi, 0.5 * np.pi))
            here = each.at(distance, *values)
            outside = (np.abs(distance) > width) | (np.abs(turned) > 0.5 * np.pi)
            outside |= (x < along[0]) | (x > along[-1])
            found[step] = np.maximum(found[step], np.where(outside, 0.0, here))
    return _touched(found)


def on_rod(part: Attached, rod: Swept, prints: Iterable[Footprint]) -> Array:
    """Return the pressure at the vertices of one of a rod's parts, (s, v).

    It is on the underside, where z < -S/2; NaN where nothing touches.
    """
    found = np.zeros((len(part.frames), part.size))
    x, y, z = rod.x[part.frame], part.local[:, 1], part.local[:, 2]
    points = rod.rod.sample_points
    lower = z < -0.5 * rod.surface[part.frame]
    for each in prints:
        for step in np.flatnonzero(each.pressure.any(axis=1)):
            values = [
                np.interp(x, points, column[step])
                for column in (each.pressure, each.depth, each.curvature)
            ]
            here = each.at(y, *values)
            found[step] = np.maximum(found[step], np.where(lower, here, 0.0))
    return _touched(found)


def _once(contacts: ContactForces) -> NDArray[np.intp]:
    """Return the contacts through skins, those at a sphere that two round cones share only once."""
    found = np.flatnonzero(np.isfinite(contacts.pressure))
    pairs = np.stack([contacts.first[found].astype(float), contacts.pressure[found]], axis=1)
    return found[np.sort(np.unique(pairs, axis=0, return_index=True)[1])]


def _touched(pressure: Array) -> Array:
    return np.where(pressure > 0.0, pressure, np.nan)


def _empty(path: Path, rod: Swept, axis: Array, link: Array) -> Footprint:
    steps, count = len(path), len(rod.rod.sample_points)
    base = link[:, 0]
    s = path.model.slot(f"{rod.name}.radius", path.parameters)[:, None]
    under = axis[:, :, :3, 3] - s * axis[:, :, :3, 2]
    points = np.einsum("sji,spj->spi", base[:, :3, :3], under - base[:, None, :3, 3])
    width = np.interp(rod.rod.sample_points, rod.x, rod.half_width)
    pressure, depth, curvature = np.zeros((3, steps, count))
    return Footprint(pressure, depth, curvature, width, points)


def _curvature(
    path: Path,
    rod: str,
    link: str,
    each: Footprint,
    described: Mapping[str, Any],
    length: float,
) -> Array:
    """Return 1/R = 1/R_rod + cos² φ / R_link, and the crown of a flat underside, (s, p)."""
    model, parameters = path.model, path.parameters
    ends = [float(model.slot(f"{link}.radius_{end}", parameters)[0]) for end in ("base", "tip")]
    s = model.slot(f"{rod}.radius", parameters)
    share = np.clip(each.points[..., 0] / length, 0.0, 1.0)
    radius = ends[0] + share * (ends[1] - ends[0])
    roundness, alignment = described["roundness"], described["alignment"]
    flat = 0.0 if roundness > 0.0 else 2.0 * described["crown"] / each.half_width**2
    return np.asarray(roundness / s + alignment / radius + flat)


def _rod_of(foundation: str) -> str:
    return foundation.removesuffix(".skin")
