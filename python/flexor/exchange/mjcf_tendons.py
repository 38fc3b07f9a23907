"""Spatial tendons of MJCF, and the actuators that pull on them."""

from __future__ import annotations

from dataclasses import replace

from flexor.exchange.limb import Limb, Muscle, Over, Tendon
from flexor.exchange.mjcf_settings import Settings
from flexor.exchange.xml import Element

# Numbers of a muscle in order, with their defaults.
_MUSCLE = {
    "range": "0.75 1.05",
    "force": "-1",
    "lmin": "0.5",
    "lmax": "1.6",
    "fpmax": "1.3",
    "lengthrange": "0 0",
}


def add_tendons(limb: Limb, root: Element, settings: Settings) -> None:
    """Add the tendons of a file to a limb."""
    found: dict[str, Tendon] = {}
    for section in root.children_of("tendon"):
        for element in section.children:
            if element.tag != "spatial":
                limb.left_out[f"tendons of the kind <{element.tag}>"] += 1
                continue
            each = replace(element, attributes=settings.merged(element, "tendon", None))
            name = element.attributes.get("name", f"tendon_{len(found) + 1}")
            stages = _stages(limb, element)
            found[name] = Tendon(name, stages, stiffness=each.number("stiffness", 0.0))
            spring = each.numbers("springlength", None, "-1")
            if len(spring) and spring[-1] >= 0.0:
                found[name].slack_length = float(spring[-1])
            if settings.limited(each):
                limb.left_out["limits of tendons"] += 1
            for key in ("damping", "frictionloss", "armature"):
                if any(each.numbers(key, None, "0")):
                    limb.left_out[f"{key} of tendons"] += 1
    for section in root.children_of("actuator"):
        for element in section.children:
            _actuator(limb, element, settings, found)
    limb.tendons = list(found.values())


def _stages(limb: Limb, tendon: Element) -> list[str | Over | float]:
    stages: list[str | Over | float] = []
    for element in tendon.children:
        if element.tag == "site":
            stages.append(_site(limb, element, "site"))
        elif element.tag == "geom":
            name = element.text("geom")
            shape = limb.shape(name)
            if shape is None or shape[1].kind not in ("sphere", "cylinder"):
                problem = "there is none" if shape is None else f"it is a {shape[1].kind}"
                raise element.error(f'wraps around the sphere or cylinder "{name}": {problem}')
            side = _site(limb, element, "sidesite") if "sidesite" in element.attributes else None
            stages.append(Over(name, side))
        elif element.tag == "pulley":
            stages.append(element.number("divisor"))
        else:
            raise element.error("is not an element of a tendon that is known here")
    return stages


def _site(limb: Limb, element: Element, key: str) -> str:
    name = element.text(key)
    if name not in limb.points:
        raise element.error(f'passes the {key} "{name}", which no body has')
    return name


def _leave_out(limb: Limb, element: Element, attributes: dict[str, str]) -> None:
    """List what a tension in place of an actuator does not have."""
    if element.tag != "motor":
        limb.left_out[f"laws of <{element.tag}> on tendons, now tensions"] += 1
    else:
        gears = replace(element, attributes=attributes).numbers("gear", default="1")
        if not gears.size:
            raise element.error("has a gear without numbers")
        ratio = float(gears[0])
        # A force of MuJoCo that is positive lengthens a tendon; a load here is a tension.
        if ratio > 0.0:
            limb.left_out["the sign of <motor> that lengthens its tendon, now a tension"] += 1
        if abs(ratio) != 1.0:
            limb.left_out["gears of <motor> on tendons"] += 1
    for key in ("ctrlrange", "forcerange"):
        if key in attributes:
            limb.left_out[f"{key} of actuators"] += 1


def _actuator(limb: Limb, element: Element, settings: Settings, tendons: dict[str, Tendon]) -> None:
    name = element.attributes.get("tendon")
    if name is None:
        limb.left_out[f"actuators <{element.tag}> on what is no tendon"] += 1
        return
    if name not in tendons:
        raise element.error(f'pulls on the tendon "{name}", which there is not')
    tendon = tendons[name]
    tendon.pulled = True
    attributes = settings.merged(element, element.tag, None)
    if element.tag != "muscle":
        _leave_out(limb, element, attributes)
        return
    each = replace(element, attributes={**_MUSCLE, **attributes})
    shortest, longest = each.numbers("lengthrange", 2).tolist()
    low, high = each.numbers("range", 2).tolist()
    force = each.number("force")
    if not shortest < longest or not low < high or force < 0.0:
        limb.left_out["muscles without a force or a lengthrange, now tensions"] += 1
        return
    optimal = (longest - shortest) / (high - low)
    lower, upper = each.number("lmin"), each.number("lmax")
    if not lower < 1.0 < upper:
        raise element.error("has lmin and lmax not on both sides of 1")
    # At lmax the passive force of MuJoCo's curve is three halves of fpmax.
    passive = each.number("fpmax")
    tendon.muscle = Muscle(
        force, optimal, shortest - low * optimal, max(lower, 1e-6), upper, passive
    )
