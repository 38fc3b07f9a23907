"""MJCF, the format of the simulator MuJoCo: bodies, joints, sites, shapes and spatial tendons."""

from __future__ import annotations

import pathlib
from collections.abc import Iterator, Mapping
from dataclasses import replace

import numpy as np

from flexor.exchange.limb import Body, Joint, JointKind, Limb, Point, Pose, Shape, ShapeKind
from flexor.exchange.mjcf_settings import Settings, settings_of
from flexor.exchange.mjcf_tendons import add_tendons
from flexor.exchange.rotations import from_z
from flexor.exchange.xml import Element, read_xml

MAX_FILES = 100
# Sections that say nothing about a limb at rest.
_IGNORED = {
    *("asset", "visual", "statistic", "size", "custom", "sensor", "keyframe", "extension"),
    *("contact", "deformable"),
}
_SHAPES: dict[str, ShapeKind] = {"sphere": "sphere", "capsule": "capsule", "cylinder": "cylinder"}
_JOINTS: dict[str, JointKind] = {"hinge": "hinge", "slide": "slide", "ball": "ball", "free": "free"}


def read_mjcf(path: pathlib.Path, root: Element, skip_meshes: bool) -> Limb:
    """Read a limb from MJCF.

    Parameters
    ----------
    path
        The file, from whose folder others are included.
    root
        What it contains.
    skip_meshes
        Whether meshes that would touch are left out; otherwise they are refused.
    """
    _include(root, path.parent, [path.resolve()])
    reader = _Reader(Limb(name=root.attributes.get("model", path.stem)), root, skip_meshes)
    reader.read(root)
    return reader.limb


def _include(element: Element, folder: pathlib.Path, files: list[pathlib.Path]) -> None:
    """Replace elements that include a file by what that contains."""
    children: list[Element] = []
    for child in element.children:
        if child.tag != "include":
            _include(child, folder, files)
            children.append(child)
            continue
        name = pathlib.PurePosixPath(child.text("file").replace("\\", "/"))
        here = pathlib.Path(child.where.rpartition(", line ")[0]).parent
        found = next((f for f in (folder / name, here / name) if f.is_file()), folder / name)
        if name.is_absolute() or name.drive:
            raise child.error(f'includes "{name}": a path within the file\'s folder is expected')
        if found.resolve() in files:
            raise child.error(f'includes "{name}" once more: a file is included once')
        if len(files) >= MAX_FILES:
            raise child.error(f"is one of more than {MAX_FILES} included files")
        files.append(found.resolve())
        included = read_xml(found)
        _include(included, folder, files)
        children += included.children
    element.children = children


class _Reader:
    """Reads the sections of a file, and remembers what it does not carry over."""

    def __init__(self, limb: Limb, root: Element, skip_meshes: bool) -> None:
        self.limb, self.skip_meshes = limb, skip_meshes
        self.settings: Settings = settings_of(root)
        self.unnamed = 0

    def read(self, root: Element) -> None:
        world = Body("", None, Pose(np.zeros(3), np.eye(3)))
        for section in root.children:
            if section.tag == "worldbody":
                for child, pose in self._placed(section, world.pose):
                    self._element(child, world, pose, None)
            elif section.tag == "option":
                self._option(section)
            elif section.tag in _IGNORED:
                self._leave_out(f"section <{section.tag}>")
            elif section.tag == "equality":
                for child in section.children:
                    self._leave_out(f"equality constraint <{child.tag}>")
            elif section.tag not in ("tendon", "actuator", "default", "compiler"):
                raise section.error("is not an element of MJCF that is known here")
        self.limb.world_shapes = world.shapes
        add_tendons(self.limb, root, self.settings)
        self._leave_out_unused()

    def _leave_out(self, what: str) -> None:
        self.limb.left_out[what] += 1

    def _option(self, section: Element) -> None:
        if "gravity" in section.attributes:
            self.limb.gravity = section.numbers("gravity", 3)

    def _placed(self, parent: Element, pose: Pose) -> Iterator[tuple[Element, Pose]]:
        """Yield elements of a body, those in frames with the pose of the frame."""
        for child in parent.children:
            if child.tag == "frame":
                if "childclass" in child.attributes:
                    for each in child.children:
                        each.attributes.setdefault("class", child.attributes["childclass"])
                yield from self._placed(child, pose.of(self._pose(child, child.attributes)))
            else:
                yield child, pose

    def _element(self, element: Element, body: Body, frame: Pose, kind: str | None) -> None:
        """Read an element of a body; ``kind`` is the class of what names none."""
        if element.tag == "body":
            self._body(element, body, frame, kind)
        elif element.tag in ("joint", "freejoint"):
            self._joint(element, body, frame, kind)
        elif element.tag == "geom":
            self._geom(element, body, frame, kind)
        elif element.tag == "site":
            self._site(element, body, frame, kind)
        elif element.tag in ("inertial", "camera", "light"):
            self._leave_out(f"<{element.tag}>")
        else:
            raise element.error("is not an element of a body that is known here")

    def _body(self, element: Element, parent: Body, frame: Pose, kind: str | None) -> None:
        name = element.attributes.get("name") or self._name("body")
        if name in self.limb.bodies:
            raise element.error("has the name of another body")
        pose = frame.of(self._pose(element, element.attributes))
        body = Body(name, parent.name or None, pose)
        self.limb.bodies[name] = body
        kind = element.attributes.get("childclass", kind)
        for child, inner in self._placed(element, Pose(np.zeros(3), np.eye(3))):
            self._element(child, body, inner, kind)

    def _joint(self, element: Element, body: Body, frame: Pose, kind: str | None) -> None:
        free = element.tag == "freejoint"
        attributes = {"type": "free"} if free else self.settings.merged(element, "joint", kind)
        each = replace(element, attributes=attributes)
        name = element.attributes.get("name") or self._name("joint")
        made = attributes.get("type", "hinge")
        if made not in _JOINTS:
            allowed = ", ".join(f'"{one}"' for one in _JOINTS)
            raise element.error(f'has type="{made}": expected one of {allowed}')
        if not body.name:
            raise element.error("is in the world, which does not move")
        place, axis = each.numbers("pos", 3, "0 0 0"), each.numbers("axis", 3, "0 0 1")
        if not np.linalg.norm(axis) > 0.0:
            raise element.error("has an axis of length zero")
        angular = made in ("hinge", "ball")
        size = self.settings.angle if angular else 1.0
        zero = size * each.number("ref", 0.0) if made in ("hinge", "slide") else 0.0
        lower = upper = None
        if self.settings.limited(each) and made in ("hinge", "slide"):
            low, high = (size * each.numbers("range", 2) - zero).tolist()
            # What cannot move has no room between its limits.
            lower, upper = (low, high) if low < high else (None, None)
            if lower is None:
                raise element.error("has an empty range")
        elif self.settings.limited(each):
            self._leave_out(f"limits of {made} joints")
        if made == "free" or (made == "ball" and "springref" in attributes):
            attributes.pop("springref", None)
        found = Joint(
            name,
            _JOINTS[made],
            frame.place + frame.turn @ place,
            frame.turn @ axis,
            lower,
            upper,
            each.number("stiffness", 0.0),
            size * each.number("springref", 0.0) - zero if made in ("hinge", "slide") else 0.0,
        )
        for key in ("damping", "armature", "frictionloss"):
            if any(each.numbers(key, None, "0")):
                self._leave_out(f"{key} of joints")
        body.joints.append(found)

    def _geom(self, element: Element, body: Body, frame: Pose, kind: str | None) -> None:
        attributes = self.settings.merged(element, "geom", kind)
        each = replace(element, attributes=attributes)
        name = element.attributes.get("name") or self._name("geom")
        made = attributes.get("type", "sphere")
        touches = each.number("contype", 1.0) != 0.0 or each.number("conaffinity", 1.0) != 0.0
        if "mesh" in attributes and touches:
            if not self.skip_meshes:
                raise element.error(
                    f'is the mesh "{attributes["mesh"]}", with which contact is not computed: '
                    "replace it by capsules or spheres, or leave meshes out with --skip-meshes"
                )
            self._leave_out("meshes that touch")
            return
        if "mesh" in attributes or made not in _SHAPES:
            self._leave_out(f"shapes of the kind {made if 'mesh' not in attributes else 'mesh'}")
            return
        size = each.numbers("size", None, "0")
        if not len(size) or not size[0] > 0.0:
            raise element.error("has no positive size")
        if "fromto" in attributes:
            ends = each.numbers("fromto", 6).reshape(2, 3)
            span = ends[1] - ends[0]
            # MuJoCo's z axis leads from the second end to the first.
            turn = from_z(-span)
            if turn is None:
                raise element.error("has fromto with two equal ends")
            pose, length = Pose(ends.mean(axis=0), turn), float(np.linalg.norm(span))
        else:
            pose = self._pose(element, attributes)
            length = 0.0 if made == "sphere" else 2.0 * float(each.numbers("size")[1:2].sum())
        pose = frame.of(pose)
        radius = float(size[0])
        body.shapes.append(Shape(name, _SHAPES[made], pose, radius, length, touches))

    def _site(self, element: Element, body: Body, frame: Pose, kind: str | None) -> None:
        attributes = self.settings.merged(element, "site", kind)
        name = element.attributes.get("name")
        if name is None:
            return
        place = frame.of(self._pose(element, attributes)).place
        if "fromto" in attributes:
            ends = replace(element, attributes=attributes).numbers("fromto", 6).reshape(2, 3)
            place = frame.place + frame.turn @ ends.mean(axis=0)
        self.limb.points[name] = Point(body.name or None, place)

    def _pose(self, element: Element, attributes: Mapping[str, str]) -> Pose:
        each = replace(element, attributes=dict(attributes))
        return Pose(each.numbers("pos", 3, "0 0 0"), self.settings.turn(each))

    def _name(self, what: str) -> str:
        self.unnamed += 1
        return f"{what}_{self.unnamed}"

    def _leave_out_unused(self) -> None:
        """Count shapes that neither touch nor guide a tendon."""
        wrapped = {
            stage.shape
            for tendon in self.limb.tendons
            for stage in tendon.stages
            if not isinstance(stage, (str, float))
        }
        for body in [*self.limb.bodies.values(), None]:
            shapes = self.limb.world_shapes if body is None else body.shapes
            for shape in shapes:
                if shape.name in wrapped:
                    continue
                if shape.touches and shape.kind == "cylinder":
                    self._leave_out("cylinders that touch")
                elif not shape.touches:
                    self._leave_out("shapes that neither touch nor guide a tendon")
