"""Model files of the paper's finger with each thing that its discussion leaves out."""

from __future__ import annotations

import copy
import sys
from typing import Any

from flexor.model.reading import locate
from flexor.scenarios.population import SURVEYS
from reproduction.study import FINGER, SURFACE

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

Document = dict[str, Any]

# Where the exosuit's tip is with Table I, seen from the fingertip [m]: the end of a bracket on it.
REACH = 0.10 - (0.045 + 0.0253 + 0.0236 + 0.001)
BASE_HEIGHT = 0.0216  # of the back of the finger at the base of the exosuit [m]
AXIS_HEIGHT = BASE_HEIGHT + 0.0116  # of the exosuit's axis, with Table I [m]
FRICTION = 0.5
# Webbing of 15 mm around each phalanx, as of the example `pneumatic-finger`.
WEBBING = {"width": "15 mm", "stiffness_per_width": "20 N/cm^2"}
# From the mean to the 5th and the 95th percentile of a normal distribution, in deviations.
PERCENTILE = 1.6449
TONE = 0.005


def finger() -> Document:
    """Return the paper's finger with the constants `surface`."""
    document = tomllib.loads(locate(FINGER).read_text(encoding="utf-8"))
    constants = document.pop("variants")[SURFACE]
    del document["use"]
    for table, bodies in constants.items():
        for name, values in bodies.items():
            document[table][name] |= values
    return document


def tied(kind: str) -> Document:
    """Return it with the exosuit's tip tied to a bracket on the fingertip."""
    document = finger()
    document["bodies"]["bracket"] = {
        "kind": "link",
        "parent": "tip",
        "length": "1 mm",
        "radius": "1 mm",
        "placement": {"x": f"{REACH:.9g} m", "z": f"{AXIS_HEIGHT:.9g} m"},
    }
    document["ties"] = {
        "tips": {
            "kind": kind,
            "first": {"body": "bracket", "at": "base"},
            "second": {"body": "exosuit", "at": "tip"},
        }
    }
    return document


def with_friction() -> Document:
    """Return it with friction between exosuit and finger."""
    document = finger()
    document["contacts"]["skin"]["friction"] = FRICTION
    return document


def wrapped() -> Document:
    """Return it with webbing around each phalanx, which slides along it."""
    document = finger()
    document["straps"] = {
        f"wrap_{i}": {"rod": "exosuit", "at": at, "to": {"body": body, "loop": True}, **WEBBING}
        for i, (at, body) in enumerate(((0.3, "ph_1"), (0.6, "ph_2"), (0.9, "ph_3")), start=1)
    }
    return document


def two_chambers(kind: str | None = None) -> Document:
    """Return it with an exosuit of two halves, each with a chamber and a force of its own.

    With a ``kind`` its tip is tied to the finger; a slider lets it move along the last phalanx.
    """
    document = tied(kind) if kind else finger()
    bodies = document["bodies"]
    near = bodies.pop("exosuit")
    near |= {"length": "5 cm", "elements": 5, "radius": {"base": "1.16 cm", "tip": "0.98 cm"}}
    far = copy.deepcopy(near) | {"parent": "exosuit", "radius": {"base": "0.98 cm", "tip": "8 mm"}}
    del far["placement"]
    document["bodies"] = {"exosuit": near, "far": far, **bodies}
    document["spheres"]["exosuit"]["bodies"] = ["exosuit", "far"]
    chamber = document["actuators"].pop("chamber")
    document["actuators"] = {"first": chamber, "second": {**chamber, "rod": "far"}}
    document["evaluation"] = {"loads": {"first": "0:5:1 N", "second": "0:5:1 N"}}
    if kind:
        document["ties"]["tips"]["second"]["body"] = "far"
    return document


def of_size(deviations: float) -> Document:
    """Return it with the finger of a hand so many deviations from the mean; the exosuit stays."""
    hands, document = SURVEYS["ansur2-men"], finger()
    length = 1.0 + deviations * hands.length_deviation / hands.length
    breadth = 1.0 + deviations * hands.breadth_deviation / hands.breadth
    for name, body in document["bodies"].items():
        if name != "exosuit":
            body["length"] = _times(body["length"], length)
            for end in ("base", "tip"):
                body["radius"][end] = _times(body["radius"][end], breadth)
    placement = document["bodies"]["exosuit"]["placement"]
    placement["z"] = _times(placement["z"], breadth)
    return document


def with_muscles(activation: float) -> Document:
    """Return it with the muscles of the example `muscle-finger`, all held at one activation."""
    document = finger()
    other = tomllib.loads(locate("muscle-finger").read_text(encoding="utf-8"))
    document |= {key: other[key] for key in ("wraps", "tendons")}
    steps = ", ".join([repr(activation)] * 6)
    loads = dict.fromkeys(other["tendons"], steps)
    document["evaluation"] = {"loads": {"chamber": "0:5:1 N", **loads}}
    return document


def _times(length: str, factor: float) -> str:
    value, unit = length.split()
    return f"{float(value) * factor:.9g} {unit}"
