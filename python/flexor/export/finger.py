"""A finger to print: links with hinges that take springs, and dots for markers."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexor.errors import InputError
from flexor.export.device import MM
from flexor.export.hinges import Hinge
from flexor.export.options import FingerOptions
from flexor.export.solids import Solid, box, cleaned, cone, united
from flexor.export.springs import Spring, spring_for
from flexor.model.schema import FixedJoint, Link, ModelFile, RevoluteJoint, Rod

_FREE = np.radians(100.0)  # range of a joint without limits
_DOT = (2.0, 0.8)  # radius and height of a dot [mm]
_SLOT = 2.0  # height of the slot for a strap [mm]


@dataclass(frozen=True, eq=False)
class Finger:
    """The parts of a finger.

    Attributes
    ----------
    parts : dict of Manifold
        Each with the centre of the hinge at its base as origin, x along it [mm]; ``"ground"`` is
        what the first link turns on.
    springs : list of Spring
        Those of the joints that have a stiffness, in the order of the links.
    markers : dict of (n, 3) lists
        Centres of the dots of each part [mm], on its right side.
    """

    parts: dict[str, Solid]
    springs: list[Spring]
    markers: dict[str, list[tuple[float, float, float]]]

    def laid_out(self) -> Solid:
        """Return all parts beside one another, on z = 0."""
        found, y = [], 0.0
        for solid in self.parts.values():
            low = solid.bounding_box()
            found.append(solid.translate((-low[0], y - low[1], -low[2])))
            y += low[4] - low[1] + 10.0
        return united(found)


def finger(file: ModelFile, options: FingerOptions | None = None) -> Finger:
    """Make the links of a model to print.

    Links are the round cones that the model's contact sees. Joints have to be hinges about y
    between links that follow one another; fixed joints join links to one part.

    Parameters
    ----------
    file
        The model file.
    options
        What the model leaves open.

    Raises
    ------
    InputError
        If it has no links, or they cannot be made.
    """
    options = options or FingerOptions()
    links = {name: body for name, body in file.bodies.items() if isinstance(body, Link)}
    if not links:
        raise InputError(f'the model "{file.name}" has no links that could be printed.')
    _check(file, links)
    hinges, springs = {}, []
    for name, link in links.items():
        if isinstance(link.joint, RevoluteJoint):
            hinges[name], spring = _hinge(name, link, link.joint, options)
            springs += [spring] if spring is not None else []
    parts: dict[str, Solid] = {}
    markers: dict[str, list[tuple[float, float, float]]] = {}
    for name, link in links.items():
        solid = _cone(link)
        after = next((other for other, body in links.items() if body.parent == name), None)
        dots = _dots(link, hinges.get(name), hinges.get(after or ""))
        solid = united([solid, *(_raised(*dot) for dot in dots)])
        tip = (MM * float(link.length), 0.0, 0.0)
        if after in hinges:
            back = solid.translate((-tip[0], 0.0, 0.0))
            solid = hinges[after].parent(back).translate(tip)
        if name in hinges:
            solid = hinges[name].child(solid)
            if link.parent is None:
                ground = "ground" if "ground" not in parts else f"ground-{name}"
                parts[ground] = cleaned(_ground(file, hinges[name], options), "the ground")
        parts[name], markers[name] = cleaned(solid, f'the link "{name}"'), dots
    return Finger(_joined(links, parts), springs, markers)


def _check(file: ModelFile, links: dict[str, Link]) -> None:
    parents = [link.parent for link in links.values()]
    for name, link in links.items():
        joint = link.joint
        if isinstance(joint, RevoluteJoint):
            if not np.allclose(np.abs(joint.axis) / np.linalg.norm(joint.axis), (0.0, 1.0, 0.0)):
                raise InputError(f"{name}.joint.axis is not y: only hinges about y are printed.")
        elif not isinstance(joint, FixedJoint):
            raise InputError(f'{name}.joint is "{joint.kind}": only hinges are printed.')
        if link.parent is not None:
            place = link.placement
            moved = (place.x, place.y, place.z, *place.rotation.components)
            if any(float(each) for each in moved) or link.parent not in links:
                raise InputError(
                    f'"{name}" is not placed at the tip of a link: only links that follow one '
                    "another are printed."
                )
            if parents.count(link.parent) > 1:
                raise InputError(f'"{link.parent}" carries several links, which is not printed.')


def _hinge(
    name: str, link: Link, joint: RevoluteJoint, options: FingerOptions
) -> tuple[Hinge, Spring | None]:
    sign = 1.0 if joint.axis[1] > 0.0 else -1.0
    lower = -_FREE if joint.lower is None else float(joint.lower)
    upper = _FREE if joint.upper is None else float(joint.upper)
    lower, upper = sorted((sign * lower, sign * upper))
    rest, radius = sign * float(joint.rest), MM * float(link.radius.base)
    pin, gap = MM * options.pin, MM * options.gap
    bare = Hinge(radius, lower, upper, rest, pin, gap, None, 0.0, 0.0)
    if 2.5 * pin > 2.0 * bare.knuckle - 2.0:
        raise InputError(
            f'the hinge of "{name}" is too small for a pin of {pin:.3g} mm: its radius is '
            f"{radius:.3g} mm; give a thinner one by --pin."
        )
    if not float(joint.stiffness) > 0.0:
        return bare, None
    largest = max(abs(lower - rest), abs(upper - rest))
    room = (bare.room[0] / MM - 5e-4, bare.room[1] / MM - 5e-4)
    spring = spring_for(name, float(joint.stiffness), largest, pin / MM, room)
    if spring is None:
        raise InputError(
            f"no torsion spring of {float(joint.stiffness):.3g} N m/rad fits into the hinge of "
            f'"{name}", in which {MM * room[0]:.3g} mm by {MM * room[1]:.3g} mm are free.'
        )
    wire, coil, length = (MM * x for x in (spring.wire, spring.diameter, spring.body))
    return Hinge(radius, lower, upper, rest, pin, gap, wire, coil, length), spring


def _cone(link: Link) -> Solid:
    """Return the round cone of a link: the hull of the spheres at its ends."""
    from flexor.export.extra import required

    manifold = required("manifold3d").Manifold
    base, tip = MM * float(link.radius.base), MM * float(link.radius.tip)
    ends = [
        manifold.sphere(base, 96),
        manifold.sphere(tip, 96).translate((MM * float(link.length), 0.0, 0.0)),
    ]
    return manifold.batch_hull(ends)


def _ground(file: ModelFile, hinge: Hinge, options: FingerOptions) -> Solid:
    """Return the block that the first link turns on, with a top on which the exosuit begins."""
    radius, wall = hinge.radius, 6.0
    top = radius
    for body in file.bodies.values():
        if (
            isinstance(body, Rod)
            and body.parent is None
            and body.placement.reference == "underside"
        ):
            top = max(top, MM * float(body.placement.z))
    back = -2.0 * radius - MM * options.seat
    block = united(
        [
            _ball(radius),
            box((back, 0.0), (-radius, radius), (-radius - wall, top)),
            box((back, -radius), (-radius - 12.0, radius + 12.0), (-radius - wall, -radius)),
        ]
    )
    screws = [
        cone((x, side * (radius + 6.0), -radius - wall - 1.0), "z", wall + 2.0, (2.2, 2.2))
        for x in (back + 6.0, -radius - 6.0)
        for side in (-1.0, 1.0)
    ]
    # A slot across, above the tongue, for the strap that holds the base of the exosuit.
    low = max(hinge.knuckle + hinge.gap + 0.8, top - 6.0)
    cut = screws
    if top - low - _SLOT >= 1.2:
        width = MM * options.strap + 1.0
        across = (-radius - 1.0, radius + 1.0)
        cut = [*screws, box((-width - 2.5, -2.5), across, (low, low + _SLOT))]
    return hinge.parent(block - united(cut))


def _ball(radius: float) -> Solid:
    from flexor.export.extra import required

    return required("manifold3d").Manifold.sphere(radius, 96)


def _dots(link: Link, base: Hinge | None, tip: Hinge | None) -> list[tuple[float, float, float]]:
    """Return the centres of two dots on the right side of a link [mm], far from one another.

    One is in front of the fork around its base, one behind the pin at its tip, or at its end.
    """
    length = MM * float(link.length)
    beside = _DOT[0] + 1.0
    first = beside if base is None else base.knuckle + base.gap + beside
    second = length if tip is None else length + 0.5 * tip.pin + beside
    return [(x, -_across(link, x), 0.0) for x in (min(first, 0.5 * length), second)]


def _across(link: Link, x: float) -> float:
    """Return the distance of the surface of a link from its axis [mm]."""
    length, base, tip = (
        MM * float(each) for each in (link.length, link.radius.base, link.radius.tip)
    )
    if x > length:
        return float(np.sqrt(max(tip**2 - (x - length) ** 2, 0.0)))
    return base + x / length * (tip - base)


def _raised(x: float, y: float, z: float) -> Solid:
    return cone((x, y + 2.0, z), "-y", 2.0 + _DOT[1], (_DOT[0], _DOT[0]))


def _joined(links: dict[str, Link], parts: dict[str, Solid]) -> dict[str, Solid]:
    """Join links that are fixed to their parents to these."""
    found = dict(parts)
    for name in reversed(list(links)):
        link = links[name]
        if isinstance(link.joint, FixedJoint) and link.parent is not None:
            moved = found.pop(name).translate((MM * float(links[link.parent].length), 0.0, 0.0))
            found[link.parent] = found[link.parent] + moved
    return found
