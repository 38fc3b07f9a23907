"""Lids: cups in which the ends of the body are closed by caps."""

from __future__ import annotations

from flexor.arrays import Array
from flexor.export.body import Body
from flexor.export.device import MM
from flexor.export.options import MouldOptions
from flexor.export.solids import Solid, box, cone, extruded, grown, united


def lid(body: Body, end: str, options: MouldOptions) -> Solid:
    """Return the cup of one end, where it is when the body is put into it.

    It is filled to the depth of the cap, takes the end of the body to the depth of its grip, and
    has a hole for each tube.
    """
    wall, clearance = MM * options.wall, MM * options.clearance
    outline, _ = body.end(end)
    cap, grip = MM * body.options.cap * body.scale, MM * options.grip
    around = _bounds(outline, wall)
    size = body.length
    face, outward = (0.0, -1.0) if end == "base" else (size, 1.0)

    def along(begin: float, finish: float) -> tuple[float, float]:
        """Distances from the face, outwards, to places along the body."""
        ends = (face + outward * begin, face + outward * finish)
        return min(ends), max(ends)

    cup = box(along(-grip, cap + 0.5 * wall), *around)
    hollow = [
        extruded(outline, *along(0.0, cap)),
        _mouth(body, end, along(-grip - 1.0, 0.0), grip, clearance),
    ]
    radius = 0.5 * MM * body.options.inlet * body.scale + clearance
    for inlet in body.inlets:
        if inlet.end == end:
            x, y, z = inlet.place
            axis = "-x" if end == "base" else "x"
            hollow.append(cone((x, y, z), axis, cap + wall, (radius, radius)))
    return cup - united(hollow)


def _mouth(body: Body, end: str, x: tuple[float, float], grip: float, clearance: float) -> Solid:
    """Return the room that the end of the body takes, ears included, with its way in."""
    part = body.parts[0] if end == "base" else body.parts[-1]
    size = body.length
    face = 0.0 if end == "base" else size
    near = (0.0, min(grip, part.x[-1])) if end == "base" else (max(size - grip, part.x[0]), size)
    outlines = part.between(part.outer, *near)[1]
    room = [extruded(grown(list(outlines), clearance), *x)]
    for ear in body.ears:
        y = (ear.y[0] - clearance, ear.y[1] + clearance)
        low, high = ear.solid.bounding_box()[2], ear.solid.bounding_box()[5]
        if end == "base":
            reach = (max(ear.x[0] - clearance, face), x[1])
        else:
            reach = (x[0], min(ear.x[1] + clearance, face))
        if reach[1] > reach[0]:
            room.append(box(reach, y, (low - clearance, high + clearance)))
    return united(room)


def _bounds(outline: Array, wall: float) -> tuple[tuple[float, float], tuple[float, float]]:
    low, high = outline.min(axis=0) - wall, outline.max(axis=0) + wall
    return (float(low[0]), float(high[0])), (float(low[1]), float(high[1]))
