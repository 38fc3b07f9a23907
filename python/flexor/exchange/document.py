"""From a limb to the tables of a model file."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from flexor.arrays import Array
from flexor.exchange.limb import Body, Joint, Limb, Over, Point, Shape, Tendon
from flexor.exchange.rotations import rotation_vector

Document = dict[str, Any]
# Of a link that stands for a body's frame, whose shapes are links of their own [m].
LENGTH, RADIUS = 1e-3, 1e-4
# Strain over which the stiffness of a tendon builds up, where it jumps in the file that is read.
TOE = 1e-3


@dataclass(eq=False)
class Names:
    """Names as model files have them, each used once."""

    taken: set[str] = field(default_factory=set)
    given: dict[tuple[str, str], str] = field(default_factory=dict)

    def of(self, kind: str, name: str) -> str:
        """Return the name of something of a kind that is called so in the file."""
        if (kind, name) not in self.given:
            plain = re.sub(r"[^A-Za-z0-9_]+", "_", name).strip("_") or kind
            plain = plain if plain[0].isalpha() else f"{kind}_{plain}"
            found, count = plain, 1
            while found in self.taken:
                found = f"{plain}_{kind}" if count == 1 else f"{plain}_{kind}_{count}"
                count += 1
            self.taken.add(found)
            self.given[kind, name] = found
        return self.given[kind, name]


@dataclass(frozen=True, eq=False)
class Converted:
    """A limb as a model file.

    Attributes
    ----------
    tables : dict
        The tables of the model file.
    joints : dict
        By the name of each joint: the body of the model file that it carries.
    bodies : dict
        By the name of each body: the body of the model file, and where the body's own origin is in
        that one's frame [m], (3,).
    tendons : dict
        By the name of each tendon: that of the model file.
    """

    tables: Document
    joints: Mapping[str, str]
    bodies: Mapping[str, tuple[str, Array]]
    tendons: Mapping[str, str]


def document_of(limb: Limb) -> Converted:
    """Return the tables of the model file of a limb.

    A body is a short link at the place of its last joint; joints before that move links of their
    own, and so do capsules and spheres that touch. A tendon that a muscle pulls on is a muscle, one
    with a stiffness a spring, and any other one a cable; one that is two of these is two tendons.
    """
    maker = _Maker(limb)
    for body in limb.bodies.values():
        maker.add_body(body)
    for shape in limb.world_shapes:
        maker.add_shape(None, np.zeros(3), shape)
    for tendon in limb.tendons:
        maker.add_tendon(tendon)
    tables: Document = {"name": Names().of("limb", limb.name), "bodies": maker.links}
    if limb.gravity.any():
        tables["gravity"] = _vector(limb.gravity, "m/s^2")
    if maker.touching:
        tables["spheres"] = {"limb": {"bodies": maker.touching}}
    for key, made in (("wraps", maker.wraps), ("tendons", maker.tendons)):
        if made:
            tables[key] = made
    named = maker.names.given
    tendons = {name: new for (kind, name), new in named.items() if kind == "tendon"}
    return Converted(tables, maker.joints, maker.places, tendons)


class _Maker:
    def __init__(self, limb: Limb) -> None:
        self.limb, self.names = limb, Names()
        self.links: Document = {}
        self.wraps: Document = {}
        self.tendons: Document = {}
        self.touching: list[str] = []
        self.joints: dict[str, str] = {}
        # Name of the link of each body, and where the body's origin is in its frame.
        self.places: dict[str, tuple[str, Array]] = {}

    def add_body(self, body: Body) -> None:
        """Add the links of a body: one for each joint, the last of which is the body."""
        above, origin = (None, np.zeros(3)) if body.parent is None else self.places[body.parent]
        # Where the next link is, in the frame of the one above, which is at its joint.
        place, turn = origin + body.pose.place, body.pose.turn
        at = np.zeros(3)  # of the link above, in the body's frame, once there is one
        for index, joint in enumerate(body.joints or [None]):
            last = index + 1 >= len(body.joints)
            name = self.names.of("body", body.name if last else f"{body.name}_{index + 1}")
            anchor = np.zeros(3) if joint is None else joint.place
            if index == 0:
                moved, rotation = place + turn @ anchor, turn
            else:
                moved, rotation = anchor - at, np.eye(3)
            link: Document = {"kind": "link"}
            if above is not None:
                link["parent"] = above
                moved = moved - [LENGTH, 0.0, 0.0]
            link |= {"placement": _placement(moved, rotation), **_size(LENGTH, RADIUS)}
            if joint is not None:
                link["joint"] = _joint(joint)
                self.joints[joint.name] = name
            self.links[name] = link
            above, at = name, anchor
        assert above is not None
        self.places[body.name] = (above, -at)
        for shape in body.shapes:
            self.add_shape(above, -at, shape)

    def add_shape(self, body: str | None, origin: Array, shape: Shape) -> None:
        """Add the link of a capsule or a sphere that touches."""
        if not shape.touches or shape.kind not in ("capsule", "sphere"):
            return
        name = self.names.of("shape", shape.name)
        length = max(shape.length, LENGTH)
        # Links lie along x, capsules along z.
        turn = shape.pose.turn @ np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]]).T
        turn = np.column_stack([turn[:, 0], turn[:, 1], np.cross(turn[:, 0], turn[:, 1])])
        start = shape.pose.place - 0.5 * length * turn[:, 0]
        moved = origin + start - ([LENGTH, 0.0, 0.0] if body is not None else 0.0)
        parent = {} if body is None else {"parent": body}
        placement = {"placement": _placement(moved, turn)}
        self.links[name] = {"kind": "link", **parent, **placement, **_size(length, shape.radius)}
        self.touching.append(name)

    def add_tendon(self, tendon: Tendon) -> None:
        """Add a tendon, as often as it has kinds of tension."""
        path = [self._stage(stage) for stage in tendon.stages]
        name = self.names.of("tendon", tendon.name)
        kinds: list[Document] = []
        if tendon.muscle is not None:
            curve = {
                "kind": "parabolic",
                "lower_length": tendon.muscle.lower,
                "upper_length": tendon.muscle.upper,
                "passive": tendon.muscle.passive,
            }
            kinds.append(
                {
                    "kind": "muscle",
                    "max_force": _text(tendon.muscle.max_force, "N"),
                    "optimal_length": _text(tendon.muscle.optimal_length, "m"),
                    "tendon_slack_length": _text(tendon.muscle.tendon_slack_length, "m"),
                    "curve": curve,
                }
            )
        elif tendon.pulled or not (tendon.stiffness > 0.0 and tendon.slack_length):
            kinds.append({"kind": "cable"})
        if tendon.stiffness > 0.0:
            if tendon.slack_length:
                slack = _text(tendon.slack_length, "m")
                stiffness = _text(tendon.stiffness, "N/m")
                spring = {"kind": "spring", "stiffness": stiffness, "slack_length": slack}
                kinds.append({**spring, "toe": TOE})
            else:
                self.limb.left_out["stiffness of tendons without a springlength"] += 1
        for index, kind in enumerate(kinds):
            each = name if index == 0 else self.names.of("tendon", f"{tendon.name}_spring")
            self.tendons[each] = {**kind, "path": path}

    def _stage(self, stage: str | Over | float) -> Document:
        if isinstance(stage, str):
            return self._point(self.limb.points[stage])
        if isinstance(stage, float):
            return {"branch": stage}
        name = self._wrap(stage.shape)
        if stage.side is None:
            return {"wrap": name}
        return {"wrap": name, "side": self._point(self.limb.points[stage.side])}

    def _point(self, point: Point) -> Document:
        if point.body is None:
            return {"world": _vector(point.place, "m")}
        link, origin = self.places[point.body]
        return {"body": link, "at": "base", "offset": _vector(origin + point.place, "m")}

    def _wrap(self, name: str) -> str:
        """Return the name of a wrap, which is added when it is named first."""
        known = ("wrap", name) in self.names.given
        wrap = self.names.of("wrap", name)
        found = self.limb.shape(name)
        if known or found is None:
            return wrap
        body, shape = found
        if body is None:
            point = _vector(shape.pose.place, "m")
        else:
            point = self._point(Point(body, shape.pose.place))
        made: Document = {"kind": shape.kind, "point": point, "radius": _text(shape.radius, "m")}
        if shape.kind == "cylinder":
            made["axis"] = [float(x) + 0.0 for x in shape.pose.turn[:, 2]]
        self.wraps[wrap] = made
        return wrap


def _size(length: float, radius: float) -> Document:
    return {
        "length": _text(length, "m"),
        "radius": {"base": _text(radius, "m"), "tip": _text(radius, "m")},
    }


def _joint(joint: Joint) -> Document:
    if joint.kind in ("ball", "free"):
        made: Document = {"kind": "spherical" if joint.kind == "ball" else "free"}
        if joint.stiffness > 0.0:
            made["stiffness"] = _text(joint.stiffness, "N*m/rad")
        return made
    angular = joint.kind == "hinge"
    unit, per = ("rad", "N*m/rad") if angular else ("m", "N/m")
    made = {"kind": "revolute" if angular else "prismatic", "axis": joint.axis.tolist()}
    if joint.stiffness > 0.0:
        made |= {"stiffness": _text(joint.stiffness, per), "rest": _text(joint.rest, unit)}
    for key, limit in (("lower", joint.lower), ("upper", joint.upper)):
        if limit is not None:
            made[key] = _text(limit, unit)
    return made


def _placement(place: Array, turn: Array) -> Document:
    made = _vector(place, "m")
    rotation = rotation_vector(turn)
    return {**made, "rotation": _vector(rotation, "rad")} if rotation.any() else made


def _vector(values: Array, unit: str) -> Document:
    return {key: _text(value, unit) for key, value in zip("xyz", values.tolist(), strict=True)}


def _text(value: float, unit: str) -> str:
    return f"{float(value) + 0.0!r} {unit}"
