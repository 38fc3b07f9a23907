"""MJCF of the links, joints and tendons of a model."""

from __future__ import annotations

from collections import Counter
from xml.etree import ElementTree

import numpy as np

from flexor.arrays import Array
from flexor.errors import InputError
from flexor.model.lowering import parents_first
from flexor.model.schema import ModelFile, Rod
from flexor.model.schema.body import Link
from flexor.model.schema.joint import Joint, PrismaticJoint, RevoluteJoint
from flexor.model.schema.points import Attachment, Ground
from flexor.model.schema.tendon import Branch, MuscleTendon, Over, Parabolic, SpringTendon, Tendon
from flexor.model.schema.vector import Offset, direction
from flexor.model.schema.wrap import Wrap

# Part of the optimal length over which MuJoCo states the range of a muscle.
RANGE = (0.75, 1.05)
# Of links without one: MuJoCo moves nothing that has no mass [kg/m³].
DENSITY = 1000.0
_CYLINDER = 1.0  # half the length of a wrap by its radius; to tendons it is endless


def mjcf_of(file: ModelFile) -> tuple[str, Counter[str]]:
    """Return a model as MJCF, and what was left out, in words, with how often.

    Links become bodies with a capsule of their mean radius, tendons spatial tendons. What is
    elastic or presses is left out, but the springs and limits of joints.

    Raises
    ------
    InputError
        If a link hangs from a rod, or a tendon passes one.
    """
    writer = _Writer(file)
    writer.write()
    ElementTree.indent(writer.root)
    return ElementTree.tostring(writer.root, encoding="unicode") + "\n", writer.left_out


class _Writer:
    def __init__(self, file: ModelFile) -> None:
        self.file = file
        self.root = ElementTree.Element("mujoco", {"model": file.name})
        ElementTree.SubElement(self.root, "compiler", {"angle": "radian", "autolimits": "true"})
        gravity = {"gravity": _numbers(file.gravity.components)}
        ElementTree.SubElement(self.root, "option", gravity)
        self.world = ElementTree.SubElement(self.root, "worldbody")
        self.bodies: dict[str, ElementTree.Element] = {}
        self.sites = 0
        self.left_out: Counter[str] = Counter()

    def write(self) -> None:
        """Write everything."""
        for name in parents_first(self.file.bodies):
            self._body(name)
        for name, wrap in self.file.wraps.items():
            self._wrap(name, wrap)
        if self.file.tendons:
            tendons = ElementTree.SubElement(self.root, "tendon")
            actuators = ElementTree.SubElement(self.root, "actuator")
            for name, tendon in self.file.tendons.items():
                self._tendon(tendons, actuators, name, tendon)
        for table in (
            "contacts",
            "obstacles",
            "actuators",
            "springs",
            "straps",
            "wrenches",
            "ties",
        ):
            if found := getattr(self.file, table):
                self.left_out[table] += len(found)

    def _body(self, name: str) -> None:
        body = self.file.bodies[name]
        if isinstance(body, Rod):
            self.left_out["rods"] += 1
            return
        parent = self.world
        place = np.array([body.placement.x, body.placement.y, body.placement.z], dtype=float)
        if body.parent is not None:
            above = self.file.bodies[body.parent]
            if isinstance(above, Rod):
                raise InputError(
                    f'{self.file.name}: bodies.{name}.parent is the rod "{body.parent}": MJCF is '
                    "written of links only."
                )
            parent = self.bodies[body.parent]
            place = place + np.array([float(above.length), 0.0, 0.0])
        vector = np.array(body.placement.rotation.components, dtype=float)
        attributes = {"name": name, "pos": _numbers(place)}
        if vector.any():
            attributes["quat"] = _numbers(_quaternion(vector))
        element = ElementTree.SubElement(parent, "body", attributes)
        self.bodies[name] = element
        _joint(element, name, body.joint)
        self._geom(element, name, body)

    def _geom(self, element: ElementTree.Element, name: str, body: Link) -> None:
        radius = 0.5 * (float(body.radius.base) + float(body.radius.tip))
        if body.radius.base != body.radius.tip:
            self.left_out["taper of links"] += 1
        density = float(body.density)
        if density == 0.0:
            self.left_out["masses of zero, now of the density of water"] += 1
        ElementTree.SubElement(
            element,
            "geom",
            {
                "name": f"{name}_geom",
                "type": "capsule",
                "fromto": _numbers([0.0, 0.0, 0.0, float(body.length), 0.0, 0.0]),
                "size": _numbers([radius]),
                "density": _numbers([density or DENSITY]),
            },
        )

    def _place(self, point: Attachment | Ground | Offset) -> tuple[ElementTree.Element, Array]:
        """Return the element that carries a point, and where in it the point is."""
        if isinstance(point, Ground):
            point = point.world
        if isinstance(point, Offset):
            return self.world, np.array(point.components, dtype=float)
        body = self.file.bodies[point.body]
        if isinstance(body, Rod):
            raise InputError(
                f'{self.file.name}: a tendon passes the rod "{point.body}": MJCF is written of '
                "links only."
            )
        share = {"base": 0.0, "tip": 1.0}.get(str(point.at), point.at)
        if share == "centroid":
            a, b = float(body.radius.base), float(body.radius.tip)
            share = (a * a + 2.0 * a * b + 3.0 * b * b) / (4.0 * (a * a + a * b + b * b))
        offset = np.array(point.offset.components, dtype=float)
        along = np.array([float(share or 0.0) * body.length, 0.0, 0.0])
        return self.bodies[point.body], offset + along

    def _site(self, point: Attachment | Ground) -> str:
        element, place = self._place(point)
        self.sites += 1
        name = f"site_{self.sites}"
        ElementTree.SubElement(element, "site", {"name": name, "pos": _numbers(place)})
        return name

    def _wrap(self, name: str, wrap: Wrap) -> None:
        element, place = self._place(wrap.point)
        radius = float(wrap.radius)
        attributes = {"name": name, "type": wrap.kind, "contype": "0", "conaffinity": "0"}
        attributes |= {"pos": _numbers(place), "mass": "0"}
        if wrap.direction is None:
            attributes["size"] = _numbers([radius])
        else:
            attributes["size"] = _numbers([radius, _CYLINDER * radius])
            attributes["zaxis"] = _numbers(wrap.direction)
        ElementTree.SubElement(element, "geom", attributes)

    def _tendon(
        self,
        tendons: ElementTree.Element,
        actuators: ElementTree.Element,
        name: str,
        tendon: Tendon,
    ) -> None:
        attributes = {"name": name}
        if isinstance(tendon, SpringTendon):
            attributes["stiffness"] = _numbers([float(tendon.stiffness)])
            attributes["springlength"] = _numbers([0.0, float(tendon.slack_length)])
            self.left_out["toes of springs"] += 1
        element = ElementTree.SubElement(tendons, "spatial", attributes)
        for stage in tendon.path:
            if isinstance(stage, Branch):
                ElementTree.SubElement(element, "pulley", {"divisor": _numbers([stage.branch])})
            elif isinstance(stage, Over):
                side = {} if stage.side is None else {"sidesite": self._site(stage.side)}
                ElementTree.SubElement(element, "geom", {"geom": stage.wrap, **side})
            else:
                ElementTree.SubElement(element, "site", {"site": self._site(stage)})
        if isinstance(tendon, MuscleTendon):
            optimal, slack = float(tendon.optimal_length), float(tendon.tendon_slack_length)
            muscle = {"name": name, "tendon": name, "force": _numbers([float(tendon.max_force)])}
            muscle["range"] = _numbers(RANGE)
            muscle["lengthrange"] = _numbers([slack + part * optimal for part in RANGE])
            if isinstance(tendon.curve, Parabolic):
                muscle["lmin"] = _numbers([tendon.curve.lower_length])
                muscle["lmax"] = _numbers([tendon.curve.upper_length])
                muscle["fpmax"] = _numbers([tendon.curve.passive])
            else:
                self.left_out["curves of muscles other than MuJoCo's"] += 1
            ElementTree.SubElement(actuators, "muscle", muscle)
        elif not isinstance(tendon, SpringTendon):
            # A positive load pulls, and so shortens the tendon.
            motor = {"name": name, "tendon": name, "gear": "-1"}
            ElementTree.SubElement(actuators, "motor", motor)


def _joint(body: ElementTree.Element, name: str, joint: Joint) -> None:
    """Write the joints that move a body."""
    if isinstance(joint, (RevoluteJoint, PrismaticJoint)):
        kind = "hinge" if isinstance(joint, RevoluteJoint) else "slide"
        attributes = {"name": f"{name}_joint", "type": kind}
        attributes["axis"] = _numbers(direction(joint.axis))
        if joint.stiffness > 0.0:
            attributes["stiffness"] = _numbers([float(joint.stiffness)])
            attributes["springref"] = _numbers([float(joint.rest)])
        if joint.lower is not None or joint.upper is not None:
            lower = -1e3 if joint.lower is None else float(joint.lower)
            upper = 1e3 if joint.upper is None else float(joint.upper)
            attributes["range"] = _numbers([lower, upper])
        ElementTree.SubElement(body, "joint", attributes)
    elif joint.kind == "universal":
        for letter, axis, stiffness in zip("yz", ("0 1 0", "0 0 1"), joint.stiffness, strict=True):
            attributes = {"name": f"{name}_joint_{letter}", "type": "hinge", "axis": axis}
            attributes["stiffness"] = _numbers([float(stiffness)])
            ElementTree.SubElement(body, "joint", attributes)
    elif joint.kind == "spherical":
        attributes = {"name": f"{name}_joint", "type": "ball"}
        attributes["stiffness"] = _numbers([float(joint.stiffness[0])])
        ElementTree.SubElement(body, "joint", attributes)
    elif joint.kind == "free":
        ElementTree.SubElement(body, "freejoint", {"name": f"{name}_joint"})


def _quaternion(vector: Array) -> Array:
    angle = float(np.linalg.norm(vector))
    return np.concatenate([[np.cos(0.5 * angle)], np.sin(0.5 * angle) * vector / angle])


def _numbers(values: object) -> str:
    return " ".join(repr(float(x) + 0.0) for x in np.asarray(values, dtype=float).tolist())
