"""The body of an exosuit as a solid."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from flexor.arrays import Array
from flexor.errors import InputError
from flexor.export.chambers import Chamber, chambers, closed_ends, widest_place
from flexor.export.device import MM, Device
from flexor.export.ears import Ear, ears
from flexor.export.options import BodyOptions
from flexor.export.outlines import Segment, segments
from flexor.export.parting import parting_heights
from flexor.export.solids import Solid, cleaned, cone, extruded, loft, united


@dataclass(frozen=True)
class Inlet:
    """The hole for a tube.

    Attributes
    ----------
    pressure : str
        Its pressure.
    end : str
        ``"base"``, ``"tip"`` or ``"top"``.
    place : (3,) tuple
        Where its axis enters the chamber [mm].
    """

    pressure: str
    end: str
    place: tuple[float, float, float]


@dataclass(frozen=True, eq=False)
class Body:
    """The exosuit as a solid, and what it is made of; lengths in mm.

    The rod's base is in the y-z plane, with x along its axis and z dorsal.

    Attributes
    ----------
    scale : float
        By which it is enlarged.
    solid : Manifold
        All of it.
    cast : Manifold
        What the mould is filled with: between base and tip, without caps and inlets.
    full : Manifold
        The same without its cavities.
    caps : dict of Manifold
        Those at the ``"base"`` and at the ``"tip"``, without inlets.
    parts, heights
        Outlines of its segments, and the height of the parting surface at their stations.
    chambers, inlets, ears
        What else it has.
    """

    device: Device
    options: BodyOptions
    scale: float
    solid: Solid
    cast: Solid
    full: Solid
    caps: dict[str, Solid]
    parts: list[Segment]
    heights: list[Array]
    chambers: list[Chamber]
    inlets: list[Inlet]
    ears: list[Ear] = field(default_factory=list)

    @property
    def length(self) -> float:
        """Length of the rod, without caps [mm]."""
        return float(self.parts[-1].x[-1])

    def end(self, which: str) -> tuple[Array, dict[str, Array]]:
        """Return the outline at the ``"base"`` or the ``"tip"``, and those of cavities there."""
        part, row = (self.parts[0], 0) if which == "base" else (self.parts[-1], -1)
        return part.outer[row], {name: points[row] for name, points in part.cavities.items()}


def body(device: Device, options: BodyOptions | None = None, scale: float = 1.0) -> Body:
    """Make the body of a device.

    Parameters
    ----------
    device
        The device.
    options
        What the model leaves open.
    scale
        By which it is enlarged, for the shrinkage of the material.

    Raises
    ------
    InputError
        If it cannot be made.
    """
    options = options or BodyOptions()
    parts = segments(device, scale)
    return body_of(device, options, parts, scale)


def body_of(device: Device, options: BodyOptions, parts: list[Segment], scale: float) -> Body:
    """Make the body of given outlines; see `body`."""
    size, cap = float(parts[-1].x[-1]), MM * scale * options.cap
    heights = [parting_heights(part) for part in parts]
    hollows = chambers(device, parts, cap)
    beside = ears(device, options, parts, heights, scale)
    envelope = united(
        [
            *(loft(part.x, part.outer) for part in parts),
            *(ear.solid for ear in beside),
        ]
    )
    full = envelope - united([ear.slots for ear in beside]) if beside else envelope
    voids = [piece for each in hollows for piece in void(each, parts)]
    cast = full - united(voids + _open_ends(hollows, parts, size)) if voids else full
    closed = closed_ends(device, hollows, size, cap)
    ends = {"base": (parts[0].outer[0], -cap, 0.0), "tip": (parts[-1].outer[-1], size, size + cap)}
    caps = {
        name: extruded(*ends[name])
        for name, needed in zip(("base", "tip"), closed, strict=True)
        if needed
    }
    inlets = [_inlet(each, parts, size, options, scale) for each in hollows if each.pressure]
    solid = united([full, *caps.values()]) if caps else full
    if voids:
        outside = [] if len(caps) == 2 else _open_ends(hollows, parts, size, set(caps))
        solid = solid - united(
            [*voids, *outside, *(_drill(i, size, cap, options, scale, parts) for i in inlets)]
        )
    solid = cleaned(solid, f'the rod "{device.name}"')
    return Body(
        device, options, scale, solid, cast, full, caps, parts, heights, hollows, inlets, beside
    )


def void(chamber: Chamber, parts: list[Segment]) -> list[Solid]:
    """Return the hollow of a chamber, a solid for each segment that it passes."""
    found = []
    for part in parts:
        low, high = max(chamber.low, part.x[0]), min(chamber.high, part.x[-1])
        if high > low + 1e-9 and chamber.cavity in part.cavities:
            found.append(loft(*part.between(part.cavities[chamber.cavity], low, high)))
    return found


def _open_ends(
    hollows: list[Chamber], parts: list[Segment], size: float, closed: set[str] | None = None
) -> list[Solid]:
    """Continue hollows that reach an end beyond it, so that it is cut open."""
    found = []
    for each in hollows:
        if each.low <= 1e-9 and "base" not in (closed or ()):
            found.append(extruded(parts[0].cavities[each.cavity][0], -1.0, 0.0))
        if each.high >= size - 1e-9 and "tip" not in (closed or ()):
            found.append(extruded(parts[-1].cavities[each.cavity][-1], size, size + 1.0))
    return found


def _inlet(
    chamber: Chamber, parts: list[Segment], size: float, options: BodyOptions, scale: float
) -> Inlet:
    """Place the hole for a tube: through a cap if there is one, or through the top."""
    assert chamber.pressure is not None
    radius = 0.5 * MM * scale * options.inlet
    if chamber.low <= 1e-9:
        end, x = "base", chamber.low
    elif chamber.high >= size - 1e-9:
        end, x = "tip", chamber.high
    else:
        end, x = "top", min(chamber.low + 2.0 * radius, 0.5 * (chamber.low + chamber.high))
    part = next(
        p for p in parts if p.x[0] - 1e-9 <= x <= p.x[-1] + 1e-9 and chamber.cavity in p.cavities
    )
    outline = part.at(part.cavities[chamber.cavity], np.array([x]))[0]
    centre, room = widest_place(outline)
    if room < radius:
        raise InputError(
            f'the inlet of "{chamber.pressure}", {2.0 * radius:.3g} mm wide, does not fit its '
            f"chamber, in which {2.0 * room:.3g} mm are free there: give a smaller one by --inlet."
        )
    return Inlet(chamber.pressure, end, (float(x), float(centre[0]), float(centre[1])))


def drills(body: Body, end: str | None = None) -> list[Solid]:
    """Return the holes of all inlets, or of those at one end."""
    cap = MM * body.scale * body.options.cap
    return [
        _drill(each, body.length, cap, body.options, body.scale, body.parts)
        for each in body.inlets
        if end in (None, each.end)
    ]


def _drill(
    inlet: Inlet, size: float, cap: float, options: BodyOptions, scale: float, parts: list[Segment]
) -> Solid:
    """Return the hole of an inlet, from within the chamber to beyond the surface."""
    radius = 0.5 * MM * scale * options.inlet
    x, y, z = inlet.place
    if inlet.end == "top":
        top = max(float(part.outer[:, :, 1].max()) for part in parts)
        return cone((x, y, z), "z", top - z + 1.0, (radius, radius))
    inside = min(radius, 0.2 * size)
    begin = x + inside if inlet.end == "base" else x - inside
    axis = "-x" if inlet.end == "base" else "x"
    return cone((begin, y, z), axis, inside + cap + 1.0, (radius, radius))
