"""URDF, the format of robots: links and joints, spheres and capsules that touch."""

from __future__ import annotations

import numpy as np

from flexor.exchange.limb import Body, Joint, JointKind, Limb, Pose, Shape, ShapeKind
from flexor.exchange.rotations import from_euler
from flexor.exchange.xml import Element

_JOINTS: dict[str, JointKind | None] = {
    "revolute": "hinge",
    "continuous": "hinge",
    "prismatic": "slide",
    "floating": "free",
    "fixed": None,
}


def read_urdf(root: Element, skip_meshes: bool) -> Limb:
    """Read a limb from URDF.

    Parameters
    ----------
    root
        What a file contains.
    skip_meshes
        Whether meshes that would touch are left out; otherwise they are refused.
    """
    limb = Limb(name=root.attributes.get("name", "limb"))
    links = {link.text("name"): link for link in root.children_of("link")}
    joints: dict[str, Element] = {}
    for element in root.children:
        if element.tag == "joint":
            child = _link(element, "child", links)
            if child in joints:
                raise element.error(f'carries the link "{child}", as another joint does')
            joints[child] = element
        elif element.tag != "link":
            limb.left_out[f"<{element.tag}>"] += 1
    parents = {child: _link(joint, "parent", links) for child, joint in joints.items()}
    for name in _in_order(links, parents):
        pose, own = Pose(np.zeros(3), np.eye(3)), []
        if name in joints:
            pose, own = _pose(joints[name]), _joints(limb, joints[name])
        body = Body(name, parents.get(name), pose, own)
        limb.bodies[name] = body
        for element in links[name].children:
            if element.tag == "collision":
                _shape(limb, body, element, skip_meshes)
            else:
                limb.left_out[f"<{element.tag}> of links"] += 1
    return limb


def _in_order(links: dict[str, Element], parents: dict[str, str]) -> list[str]:
    """Return the names of links, parents first."""
    order: dict[str, None] = {}
    for name in links:
        line: dict[str, None] = {}
        above: str | None = name
        while above is not None and above not in order:
            if above in line:
                raise links[above].error("is its own ancestor")
            line[above] = None
            above = parents.get(above)
        order |= dict.fromkeys(reversed(line))
    return list(order)


def _link(joint: Element, which: str, links: dict[str, Element]) -> str:
    found = joint.children_of(which)
    name = found[0].text("link") if found else None
    if name not in links:
        problem = "none" if name is None else f'the link "{name}", which there is not'
        raise joint.error(f"has as {which} {problem}")
    return name


def _pose(element: Element) -> Pose:
    for origin in element.children_of("origin"):
        turn = from_euler(origin.numbers("rpy", 3, "0 0 0"), "XYZ")
        return Pose(origin.numbers("xyz", 3, "0 0 0"), turn)
    return Pose(np.zeros(3), np.eye(3))


def _joints(limb: Limb, element: Element) -> list[Joint]:
    kind = element.text("type")
    if kind not in _JOINTS:
        allowed = ", ".join(f'"{one}"' for one in _JOINTS)
        raise element.error(f'has type="{kind}": expected one of {allowed}')
    for tag in ("mimic", "dynamics", "calibration", "safety_controller"):
        if element.children_of(tag):
            limb.left_out[f"<{tag}> of joints"] += 1
    made = _JOINTS[kind]
    if made is None:
        return []
    axis = np.array([1.0, 0.0, 0.0])
    for each in element.children_of("axis"):
        axis = each.numbers("xyz", 3)
    if not np.linalg.norm(axis) > 0.0:
        raise element.error("has an axis of length zero")
    lower = upper = None
    for limit in element.children_of("limit"):
        if kind in ("revolute", "prismatic"):
            lower, upper = limit.number("lower", 0.0), limit.number("upper", 0.0)
            if not lower < upper:
                raise element.error("has limits without room between them")
    return [Joint(element.text("name"), made, np.zeros(3), axis, lower, upper)]


def _shape(limb: Limb, body: Body, collision: Element, skip_meshes: bool) -> None:
    pose = _pose(collision)
    name = collision.attributes.get("name", f"{body.name}_shape_{len(body.shapes) + 1}")
    for geometry in collision.children_of("geometry"):
        for each in geometry.children:
            if each.tag == "mesh":
                if not skip_meshes:
                    raise each.error(
                        f'is "{each.attributes.get("filename", "")}", a shape of the link '
                        f'"{body.name}" with which contact is not computed: replace it by '
                        "capsules or spheres, or leave meshes out with --skip-meshes"
                    )
                limb.left_out["meshes that touch"] += 1
            elif each.tag in ("sphere", "capsule"):
                length = 0.0 if each.tag == "sphere" else each.number("length")
                shape: ShapeKind = "sphere" if each.tag == "sphere" else "capsule"
                body.shapes.append(Shape(name, shape, pose, each.number("radius"), length, True))
            elif each.tag in ("box", "cylinder"):
                limb.left_out[f"shapes of the kind {each.tag}"] += 1
            else:
                raise each.error("is not a shape that is known here")
