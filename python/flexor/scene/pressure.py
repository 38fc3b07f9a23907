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
            if second < 0:
                continue  # an obstacle
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


def on_link(
    link: Attached,
    prints: Iterable[Footprint],
    borrowed: Iterable[tuple[Footprint, Array]] = (),
) -> Array:
    """Return the pressure at the vertices of a link, (s, v); NaN where nothing touches.

    Parameters
    ----------
    link
        The surface of the link.
    prints
        What touches it.
    borrowed
        What touches others where their surfaces are the same, and at which vertices (v,).
    """
    found = np.zeros((len(link.frames), link.size))
    for each in prints:
        np.maximum(found, _painted(link, each), out=found)
    for each, same in borrowed:
        np.maximum(found, np.where(same, _painted(link, each), 0.0), out=found)
    return _touched(found)


def _painted(link: Attached, each: Footprint) -> Array:
    """Return the pressure of one footprint at the vertices of a link, (s, v)."""
    found = np.zeros((len(link.frames), link.size))
    for step in np.flatnonzero(each.pressure.any(axis=1)):
        order = np.argsort(each.points[step, :, 0])
        along = each.points[step, order, 0]
        # From the last point before to the first after those that touch.
        touched = np.flatnonzero(each.pressure[step, order])
        ends = np.clip([touched[0] - 1, touched[-1] + 1], 0, len(along) - 1)
        x = link.local[:, 0]
        near = np.flatnonzero((x >= along[ends[0]]) & (x <= along[ends[1]]))
        x, radial = x[near], link.local[near, 1:]
        values = [
            np.interp(x, along, column[step, order])
            for column in (each.pressure, each.depth, each.curvature)
        ]
        across = each.points[step, order, 1:]
        y, z = (np.interp(x, along, column) for column in across.T)
        width = np.interp(x, along, each.half_width[order])
        turned = np.arctan2(radial[:, 1], radial[:, 0]) - np.arctan2(z, y)
        distance = np.linalg.norm(radial, axis=1) * np.sin(turned)
        here = each.at(distance, *values)
        outside = (np.abs(distance) > width) | (np.cos(turned) < 0.0)
        found[step, near] = np.where(outside, 0.0, here)
    return found


def on_rod(part: Attached, rod: Swept, prints: Iterable[Footprint]) -> Array:
    """Return the pressure at the vertices of one of a rod's parts, (s, v).

    It is on the underside, where z < -S/2; NaN where nothing touches.
    """
    found = np.zeros((len(part.frames), part.size))
    lower = np.flatnonzero(part.local[:, 2] < -0.5 * rod.surface[part.frame])
    x, y = rod.x[part.frame[lower]], part.local[lower, 1]
    points = rod.rod.sample_points
    for each in prints if len(lower) else ():
        for step in np.flatnonzero(each.pressure.any(axis=1)):
            values = [
                np.interp(x, points, column[step])
                for column in (each.pressure, each.depth, each.curvature)
            ]
            found[step, lower] = np.maximum(found[step, lower], each.at(y, *values))
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
