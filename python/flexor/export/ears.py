"""Ears beside the body, with slots through which straps are threaded."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexor.arrays import Array
from flexor.errors import InputError
from flexor.export.device import MM, Device
from flexor.export.options import BodyOptions
from flexor.export.outlines import Segment
from flexor.export.solids import Solid, loft, rectangle, united


@dataclass(frozen=True, eq=False)
class Ear:
    """The ears of one strap, on both sides of the body [mm].

    Attributes
    ----------
    strap : str
        Its name.
    x, y : pair of float
        From where to where along the body, and across (all of the width).
    slot_x, slot_y : pair of float
        The slot at positive y.
    z : float
        Height of its underside in the middle.
    solid, slots : Manifold
        The ears, with the body between them, and the slots, which are to be cut out.
    """

    strap: str
    x: tuple[float, float]
    y: tuple[float, float]
    slot_x: tuple[float, float]
    slot_y: tuple[float, float]
    z: float
    solid: Solid
    slots: Solid


def ears(
    device: Device,
    options: BodyOptions,
    parts: list[Segment],
    heights: list[Array],
    scale: float,
) -> list[Ear]:
    """Return the ears of all straps of a device; they stand on the parting surface."""
    unit, size = MM * scale, float(parts[-1].x[-1])
    margin, thickness = unit * options.margin, unit * options.ear
    found = []
    for name, strap in device.file.straps.items():
        if strap.rod != device.name:
            continue
        width = unit * (options.strap if strap.width is None else float(strap.width)) + 1.0
        reach = 0.5 * width + margin
        if 2.0 * reach > size:
            raise InputError(
                f'the strap "{name}" is {width:.3g} mm wide, more than the rod is long enough for.'
            )
        centre = float(np.clip(strap.at * size, reach, size - reach))
        low, high = centre - reach, centre + reach
        stations = _stations(parts, low, high)
        z = np.interp(stations, *_line(parts, heights))
        half = np.array([_half_width(parts, x) for x in stations]).max()
        slot = (half + margin, half + margin + unit * options.strap_thickness + 0.5)
        y = slot[1] + margin
        slot_x = (centre - 0.5 * width, centre + 0.5 * width)
        solid = loft(
            stations, np.array([rectangle((-y, y), (each, each + thickness)) for each in z])
        )
        between = _stations(parts, *slot_x)
        floor = np.interp(between, *_line(parts, heights))
        slots = [
            loft(
                between,
                np.array([rectangle(side, (each - 1.0, each + thickness + 1.0)) for each in floor]),
            )
            for side in (slot, (-slot[1], -slot[0]))
        ]
        middle = float(np.interp(centre, *_line(parts, heights)))
        found.append(Ear(name, (low, high), (-y, y), slot_x, slot, middle, solid, united(slots)))
    return found


def _line(parts: list[Segment], heights: list[Array]) -> tuple[Array, Array]:
    return np.concatenate([part.x for part in parts]), np.concatenate(heights)


def _stations(parts: list[Segment], low: float, high: float) -> Array:
    """Return where the surface may have corners from `low` to `high`, with both."""
    every = np.concatenate([part.x for part in parts])
    return np.unique([low, *every[(every > low + 1e-6) & (every < high - 1e-6)], high])


def _half_width(parts: list[Segment], x: float) -> float:
    widths = [
        np.abs(part.at(part.outer, np.array([x]))[0][:, 0]).max()
        for part in parts
        if part.x[0] - 1e-9 <= x <= part.x[-1] + 1e-9
    ]
    return float(max(widths))
