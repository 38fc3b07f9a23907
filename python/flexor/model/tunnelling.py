"""Contact spheres so far apart that another body or an obstacle may pass between them."""

from __future__ import annotations

import math
import warnings
from collections.abc import Iterator, Mapping

import numpy as np
from numpy.typing import NDArray

from flexor.arrays import Array
from flexor.errors import ModelWarning
from flexor.model.schema import ModelFile, Rod
from flexor.model.schema.body import Body
from flexor.model.schema.touched import group_name
from flexor.model.structure import Structure


def warn_about_gaps(model: Structure) -> None:
    """Warn, in one sentence for each contact and obstacle, where it may be missed.

    That is, if in the reference state the gap between neighbouring spheres of a rod exceeds their
    diameter, or a sphere of the other group, or an obstacle, fits between those of a body.
    """
    if not (model.file.contacts or model.file.obstacles):
        return
    spheres = model.engine.spheres(model.parameters, np.zeros(model.engine.dof))
    groups = {
        name: spheres[start:stop] for name, (start, stop) in model.engine.sphere_groups.items()
    }
    for sentence in (*_contact_gaps(model, groups), *_obstacle_gaps(model, groups)):
        warnings.warn(sentence, ModelWarning, stacklevel=4)


def _contact_gaps(model: Structure, groups: Mapping[str, Array]) -> Iterator[str]:
    for name, contact in model.file.contacts.items():
        # Round cones, the second group of their contacts, have no gaps.
        sides = [(contact.first, contact.second)]
        if contact.shape == "spheres" and contact.first != contact.second:
            sides.append((contact.second, contact.first))
        found = [
            sentence
            for group, other in sides
            for sentence in _gaps_of(model.file, group, groups[group], groups[other][:, 3].min())
        ]
        if found:
            yield f'contact "{name}" may be missed: {"; ".join(found)}.'


def _gaps_of(file: ModelFile, group: str, spheres: Array, other: float) -> Iterator[str]:
    """Describe the widest gap of each body of a group that has one."""
    for name, own in _by_body(file, group, spheres):
        body = file.bodies[name]
        apart, width = _widest(own)
        gap = _gap(body, name, apart, width)
        if isinstance(body, Rod) and apart / width > 1.0 + 1e-9:
            yield f"{gap}: {_closed(body, apart / width)}"
        elif apart > width + 2.0 * other:
            yield (
                f"{gap}, so that one of the other group fits between them: "
                'give the link more points, or use shape = "round-cones"'
            )


def _obstacle_gaps(model: Structure, groups: Mapping[str, Array]) -> Iterator[str]:
    file = model.file
    for name, obstacle in file.obstacles.items():
        if not math.isfinite(obstacle.half_width):
            continue
        bodies = [
            each
            for group in obstacle.spheres or ()
            for each in _by_body(file, group, groups[group])
        ]
        for body in obstacle.skins(name, file):
            bodies.append((body, groups[group_name(body)][_pressing(file.bodies[body])]))
        found = [
            sentence
            for body, own in bodies
            if (sentence := _passage(file.bodies[body], body, own, 2.0 * obstacle.half_width))
        ]
        if found:
            yield f'obstacle "{name}" may be missed: {"; ".join(found)}.'


def _passage(body: Body, name: str, spheres: Array, thickness: float) -> str:
    """Describe the widest gap between spheres of a body through which something so thick fits."""
    apart, width = _widest(spheres)
    if apart <= (width + thickness) * (1.0 + 1e-9):
        return ""
    gap = f"{_gap(body, name, apart, width)}, and it is {1e3 * thickness:.3g} mm thick"
    if isinstance(body, Rod):
        return f"{gap}: {_closed(body, apart / (width + thickness))}"
    return f"{gap}: give spheres at points that are closer together"


def _by_body(file: ModelFile, group: str, spheres: Array) -> Iterator[tuple[str, Array]]:
    """Yield the bodies whose whole length a group covers, with their spheres."""
    begin = 0
    for name in file.spheres[group].bodies:
        body = file.bodies[name]
        count = body.sample_count + 1 if isinstance(body, Rod) else 2
        yield name, spheres[begin : begin + count]
        begin += count


def _pressing(body: Body) -> NDArray[np.intp] | slice:
    """Which of the points of a body's outside press on obstacles all along it."""
    return body.gauss_rule[0] if isinstance(body, Rod) else slice(1, -1)


def _widest(spheres: Array) -> tuple[float, float]:
    """Return distance and sum of radii of the neighbours with the widest gap for their size."""
    apart = np.linalg.norm(np.diff(spheres[:, :3], axis=0), axis=1)
    width = spheres[1:, 3] + spheres[:-1, 3]
    widest = int(np.argmax(apart / width))
    return float(apart[widest]), float(width[widest])


def _gap(body: Body, name: str, apart: float, width: float) -> str:
    return (
        f'spheres of the {body.kind} "{name}" have a spacing of {1e3 * apart:.3g} mm '
        f"and a diameter of {1e3 * width:.3g} mm"
    )


def _closed(rod: Rod, ratio: float) -> str:
    needed = math.ceil(rod.elements * ratio - 1e-9)
    return f"{needed} elements close the gaps (it has {rod.elements})"
