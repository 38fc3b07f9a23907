"""The mould of a body: two halves, end plates that hold the cores, cores, and lids for the caps."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import tan

import numpy as np

from flexor.errors import InputError
from flexor.export.body import Body, body_of
from flexor.export.cores import Core, cores
from flexor.export.device import MM, Device
from flexor.export.lids import lid
from flexor.export.options import BodyOptions, MouldOptions
from flexor.export.outlines import Segment, segments
from flexor.export.parting import check_undercuts, half_outlines, parting_heights
from flexor.export.solids import Solid, box, cleaned, cone, extruded, grown, loft, rectangle, united
from flexor.export.walls import check_walls

Extent = tuple[float, float]


@dataclass(frozen=True, eq=False)
class Mould:
    """The parts of a mould as they are put together, in mm.

    Attributes
    ----------
    body : Body
        The body as it is cast, enlarged by the shrinkage and with draft.
    lower, upper : Manifold
        Its halves.
    plates : dict of Manifold
        Plates at the ``"base"`` and at the ``"tip"``, which hold the cores.
    cores : list of Core
        The cores.
    lids : dict of Manifold
        Cups in which the caps are cast, in the place of the plates.
    holes : Manifold
        The hole through which silicone goes in, and those through which air goes out.
    """

    body: Body
    options: MouldOptions
    scale: float
    lower: Solid
    upper: Solid
    plates: dict[str, Solid]
    cores: list[Core]
    lids: dict[str, Solid]
    holes: Solid

    def parts(self) -> dict[str, Solid]:
        """Return all parts by the name of their file, where they are in the mould."""
        return {
            "lower": self.lower,
            "upper": self.upper,
            **{f"end-{end}": plate for end, plate in self.plates.items()},
            **{core.name: core.solid for core in self.cores},
            **{f"lid-{end}": each for end, each in self.lids.items()},
        }

    def printed(self) -> dict[str, Solid]:
        """Return all parts as they are to be printed, lying on z = 0."""
        turns = {
            "upper": (180.0, 0.0, 0.0),
            "end-base": (0.0, 90.0, 0.0),
            "end-tip": (0.0, -90.0, 0.0),
            "lid-base": (0.0, 90.0, 0.0),
            "lid-tip": (0.0, -90.0, 0.0),
        }
        found = {}
        for name, solid in self.parts().items():
            turned = solid.rotate(turns.get(name, (0.0, 0.0, 0.0)))
            low = turned.bounding_box()[:3]
            found[name] = turned.translate((-low[0], -low[1], -low[2]))
        return found


def mould(
    device: Device, options: MouldOptions | None = None, chosen: BodyOptions | None = None
) -> Mould:
    """Make the mould of a device.

    Parameters
    ----------
    device
        The device.
    options
        Of the mould.
    chosen
        Of the body.

    Raises
    ------
    InputError
        If a wall is too thin, or there is an undercut, naming which and where.
    """
    options, chosen = options or MouldOptions(), chosen or BodyOptions()
    scale = 1.0 / (1.0 - options.shrinkage)
    parts = segments(device, scale)
    several = len(parts) > 1
    for index, part in enumerate(parts):
        place = f"{device.name}.section" + (f"[{index}]" if several else "")
        check_undercuts(part, parting_heights(part), place)
    if options.draft > 0.0:
        parts = [_drafted(part, options.draft) for part in parts]
    made = body_of(device, chosen, parts, scale)
    check_walls(made, options.least_wall)
    if options.wall < 2.0 * options.least_wall:
        raise InputError(
            f"the walls of the mould, {MM * options.wall:.3g} mm by --wall, must be at least twice "
            f"the {MM * options.least_wall:.3g} mm of --least-wall."
        )
    wall = MM * options.wall
    inside = cores(made, 2.0 * wall, options.stretch)
    y, z = _around(made, wall)
    lower, upper = _halves(made, y, z)
    pours, vents = _holes(made, options)
    holes = united(
        [
            *_drilled(made, pours, options.pour, z[1], funnel=True),
            *_drilled(made, vents, options.vent, z[1]),
        ]
    )
    pins, sockets = _pins(made, y, wall, MM * options.clearance)
    lower = united([lower, *pins])
    upper = upper - united([holes, *sockets])
    plates = {}
    for end in ("base", "tip"):
        plates[end], bores = _plate(made, inside, end, (y, z), options)
        lower, upper = lower - bores, upper - bores
    lids = {end: lid(made, end, options) for end in made.caps}
    return Mould(
        made,
        options,
        scale,
        cleaned(lower, "the lower half of the mould"),
        cleaned(upper, "the upper half of the mould"),
        {end: cleaned(plate, f"the plate at the {end}") for end, plate in plates.items()},
        inside,
        {end: cleaned(each, f"the lid at the {end}") for end, each in lids.items()},
        holes,
    )


def _drafted(part: Segment, angle: float) -> Segment:
    """Widen outlines towards the parting surface, so that the halves come off."""
    outer = part.outer.copy()
    for row, height in enumerate(parting_heights(part)):
        y, z = part.outer[row].T
        top = z.max() - height
        wider = tan(angle) * np.where(z >= height, z.max() - z, top - (height - z))
        half = 0.5 * np.ptp(y)
        middle = 0.5 * (y.max() + y.min())
        outer[row, :, 0] = y + (y - middle) / half * wider
    return replace(part, outer=outer)


def _around(body: Body, wall: float) -> tuple[Extent, Extent]:
    """Return the extent of the mould across [mm]."""
    low = np.min([part.outer.min(axis=(0, 1)) for part in body.parts], axis=0)
    high = np.max([part.outer.max(axis=(0, 1)) for part in body.parts], axis=0)
    for ear in body.ears:
        low[0], high[0] = min(low[0], ear.y[0]), max(high[0], ear.y[1])
    lowest = min(float(each.min()) for each in body.heights)
    bottom = min(float(low[1]), lowest) - wall
    top = max(
        float(high[1]), max(ear.solid.bounding_box()[5] for ear in body.ears) if body.ears else -1e9
    )
    return (float(low[0]) - wall, float(high[0]) + wall), (bottom, top + wall)


def _halves(body: Body, y: Extent, z: Extent) -> tuple[Solid, Solid]:
    """Return what is below and above the parting surface, around the body."""
    lower: list[Solid] = []
    upper: list[Solid] = []
    below: list[Solid] = []
    above: list[Solid] = []
    for part, height in zip(body.parts, body.heights, strict=True):
        lower.append(loft(part.x, np.array([rectangle(y, (z[0], each)) for each in height])))
        upper.append(loft(part.x, np.array([rectangle(y, (each, z[1])) for each in height])))
        # Through the ends, which the plates close.
        first, last = part is body.parts[0], part is body.parts[-1]
        x = np.concatenate([[-1.0] * first, part.x, [body.length + 1.0] * last])
        rows = [0] * first + list(range(len(part.x))) + [-1] * last
        for sign, cutters in ((1.0, above), (-1.0, below)):
            outlines = half_outlines(part, height, sign)
            if outlines is not None:
                cutters.append(loft(x, outlines[rows]))
    if body.ears:
        slots = united([ear.slots for ear in body.ears])
        above.append(united([ear.solid + ear.solid.translate((0, 0, -1)) for ear in body.ears]))
        return _cut(united(lower), below), united(upper) - (united(above) - slots)
    return _cut(united(lower), below), _cut(united(upper), above)


def _cut(solid: Solid, cutters: list[Solid]) -> Solid:
    return solid - united(cutters) if cutters else solid


def _holes(
    body: Body, options: MouldOptions
) -> tuple[list[tuple[float, float]], list[tuple[float, float]]]:
    """Place the hole for silicone near the base, and those for air at the tip and between."""
    size = body.length
    pour, vent = MM * options.pour, MM * options.vent
    narrowest = min(float(np.ptp(part.outer[:, :, 0], axis=1).min()) for part in body.parts)
    if pour > 0.8 * narrowest or pour + 2.0 * vent > 0.5 * size:
        raise InputError(
            f"the holes of the mould, {pour:.3g} and {vent:.3g} mm, are too wide for a body of "
            f"{narrowest:.3g} mm by {size:.3g} mm: give smaller ones by --pour and --vent."
        )
    vents = (0.5 * size, size - 0.5 * vent - 1.0)
    return [(pour + 2.0, _middle(body, pour + 2.0))], [(x, _middle(body, x)) for x in vents]


def _middle(body: Body, x: float) -> float:
    """Return y in the middle of the outline at a place along the body [mm]."""
    part = next(part for part in body.parts if x <= part.x[-1] + 1e-9)
    y = part.at(part.outer, np.array([x]))[0][:, 0]
    return float(0.5 * (y.min() + y.max()))


def _drilled(
    body: Body, places: list[tuple[float, float]], width: float, top: float, funnel: bool = False
) -> list[Solid]:
    """Return holes to the top; below they end within the body."""
    radius, found = 0.5 * MM * width, []
    for x, y in places:
        index = next(i for i, part in enumerate(body.parts) if x <= part.x[-1] + 1e-9)
        part = body.parts[index]
        height = float(np.interp(x, part.x, body.heights[index]))
        found.append(cone((x, y, height), "z", top - height + 1.0, (radius, radius)))
        if funnel:
            wide = 2.0 * radius + 1.0
            found.append(cone((x, y, top - radius), "z", radius + 1.0, (radius, wide)))
    return found


def _pins(body: Body, y: Extent, wall: float, clearance: float) -> tuple[list[Solid], list[Solid]]:
    """Return the pins on the lower half, and their sockets in the upper one."""
    pins, sockets = [], []
    height, radii = 0.6 * wall, (0.3 * wall, 0.18 * wall)
    for x in (2.0 * wall, body.length - 2.0 * wall):
        at = float(np.clip(x, 0.75 * wall, body.length - 0.75 * wall))
        index = next(i for i, part in enumerate(body.parts) if at <= part.x[-1] + 1e-9)
        base = float(np.interp(at, body.parts[index].x, body.heights[index]))
        for side in (y[0] + 0.5 * wall, y[1] - 0.5 * wall):
            pins.append(cone((at, side, base - 0.5), "z", height + 0.5, radii))
            wider = (radii[0] + clearance, radii[1] + clearance)
            sockets.append(cone((at, side, base - 0.5), "z", height + 0.5 + 2.0 * clearance, wider))
    return pins, sockets


def _plate(
    body: Body,
    inside: list[Core],
    end: str,
    around: tuple[Extent, Extent],
    options: MouldOptions,
) -> tuple[Solid, Solid]:
    """Return the plate of one end, with windows for the cores, and the bores for its pins."""
    wall, clearance = MM * options.wall, MM * options.clearance
    (y, z), size = around, body.length
    face, outward = (0.0, -1.0) if end == "base" else (size, 1.0)
    x = (-wall, 0.0) if end == "base" else (size, size + wall)
    plate = box(x, y, z)
    windows = [
        extruded(grown([core.ends[end]], clearance), x[0] - 1.0, x[1] + 1.0)
        for core in inside
        if end in core.ends
    ]
    height = float(body.heights[0][0] if end == "base" else body.heights[-1][-1])
    pins, bores = [], []
    axis = "x" if end == "base" else "-x"
    for side in (y[0] + 0.5 * wall, y[1] - 0.5 * wall):
        for level in (0.5 * (z[0] + height), 0.5 * (height + z[1])):
            radii = (0.25 * wall, 0.15 * wall)
            long, back = 0.4 * wall, face + 0.5 * outward
            pins.append(cone((back, side, level), axis, long + 0.5, radii))
            wider = (radii[0] + clearance, radii[1] + clearance)
            bores.append(cone((back, side, level), axis, long + 0.5 + 2.0 * clearance, wider))
    made = united([plate, *pins])
    return (made - united(windows) if windows else made), united(bores)
