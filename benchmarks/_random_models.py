"""Random models of every kind that a model file can describe, at any scale of length and force."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Json = dict[str, Any]

LENGTHS, FORCES = (1e-6, 1e3), (1e-9, 1e9)
PLANAR_MODES = ("bend_y", "extend_x", "shear_z")
SPATIAL_MODES = ("twist_x", "bend_y", "bend_z", "extend_x", "shear_y", "shear_z")
BASES: tuple[str | Json, ...] = (
    *("nodal_linear", "nodal_linear", "nodal_quadratic", "hermite"),
    *({"basis": "legendre", "order": order} for order in (0, 1, 3)),
    *({"basis": basis, "order": 2} for basis in ("chebyshev", "monomial")),
)


@dataclass
class RandomModel:
    """A model file as a document, with what is needed to use and to count it.

    Attributes
    ----------
    length, force
        Its scales [m, N].
    kinds
        Kinds of its parts, such as ``"universal"``, ``"follower"`` or ``"round-cones"``.
    """

    document: Json
    length: float
    force: float
    kinds: Counter[str] = field(default_factory=Counter)


class Generator:
    """Draws models from a random number generator."""

    def __init__(self, random: np.random.Generator) -> None:
        self.random = random

    def model(self) -> RandomModel:
        """Draw a model."""
        length, force = self.between(*LENGTHS), self.between(*FORCES)
        self.planar = self.chance(0.5)
        self.made = RandomModel({"name": "random", "planar": self.planar}, length, force)
        self.made.kinds["planar" if self.planar else "spatial"] += 1
        self.document = self.made.document
        self.bodies: dict[str, Json] = {}
        self.sizes: dict[str, float] = {}  # of loads that are no forces
        self.document["bodies"] = self.bodies
        self.weight = self.chance(0.4)
        for number in range(int(self.random.integers(1, 5))):
            self.add_body(number)
        if self.weight:
            self.document["gravity"] = self.vector(self.direction() * 9.81, "m/s^2")
            self.made.kinds["gravity"] += 1
        for number in range(int(self.random.choice([0, 0, 1, 2]))):
            self.add_spring(number)
        self.add_contacts()
        for number in range(int(self.random.choice([0, 0, 1, 2]))):
            self.add_actuator(number)
        for number in range(int(self.random.choice([0, 1, 1, 2]))):
            self.add_wrench(number)
        return self.made

    def loads(self, inputs: tuple[str, ...]) -> Array:
        """Draw a path of loads, (steps, inputs): up, up and down, any, or held."""
        steps = int(self.random.integers(1, 6))
        loads = np.zeros((steps + 1, len(inputs)))
        for column, name in enumerate(inputs):
            size = self.sizes.get(name, self.made.force)
            last = size * self.between(0.05, 5.0) * (1.0 if self.chance(0.7) else -1.0)
            way = np.linspace(0.0, 1.0, steps + 1)
            shape = str(self.random.choice(["up", "up", "down", "any", "held"]))
            if shape == "down":
                way = 1.0 - np.abs(2.0 * way - 1.0)
            elif shape == "any":
                way = self.random.uniform(-1.0, 1.0, steps + 1)
            elif shape == "held":
                way = np.ones(steps + 1)
            loads[:, column] = last * way
        return loads

    def add_body(self, number: int) -> None:
        name = f"b{number}"
        parent = f"b{self.random.integers(number)}" if number and self.chance(0.8) else None
        body = self.rod() if self.chance(0.5) else self.link()
        if parent:
            body["parent"] = parent
        if parent is None or self.chance(0.4):
            body["placement"] = self.placement()
        body["joint"] = self.joint(loose=body["kind"] == "link")
        self.made.kinds[body["kind"]] += 1
        self.made.kinds[body["joint"]["kind"]] += 1
        self.bodies[name] = body

    def rod(self) -> Json:
        scale = self.made.length * self.between(0.3, 3.0)
        radius = scale * self.between(0.005, 0.15)
        stiffness = self.made.force * self.made.length**2 * self.between(0.05, 20.0)
        modes = [str(each) for each in (PLANAR_MODES if self.planar else SPATIAL_MODES)]
        chosen = [mode for mode in modes if self.chance(0.75 if "bend" in mode else 0.3)]
        taper = self.between(0.4, 1.0)
        rod: Json = {
            "kind": "rod",
            "length": si(scale, "m"),
            "radius": {"base": si(radius, "m"), "tip": si(taper * radius, "m")},
            "young_modulus": si(stiffness / (0.25 * np.pi * radius**4), "Pa"),
            "poisson_ratio": float(self.random.uniform(-0.5, 0.5)),
            "strain": {mode: self.random.choice(np.array(BASES, dtype=object)) for mode in chosen}
            or {"bend_y": "nodal_linear"},
            "elements": int(self.random.integers(1, 4)),
            "gauss_points": 4,
            "magnus_order": int(self.random.choice([2, 4])),
        }
        if self.chance(0.4):
            kind = str(self.random.choice(["elliptic", "rectangular"]))
            rod["section"] = {"kind": kind, "ratio": self.between(0.3, 3.0)}
            self.made.kinds[kind] += 1
        if self.chance(0.3):
            curvature = float(self.random.uniform(-2.0, 2.0)) / scale
            rod["reference_strain"] = {"bend_y": si(curvature, "1/m")}
        if self.weight:
            rod["density"] = self.density(np.pi * radius**2 * scale)
        return rod

    def link(self) -> Json:
        scale = self.made.length * self.between(0.3, 3.0)
        radius = scale * self.between(0.02, 0.3)
        link: Json = {"kind": "link", "length": si(scale, "m"), "radius": si(radius, "m")}
        if self.weight:
            link["density"] = self.density(np.pi * radius**2 * scale)
        return link

    def density(self, volume: float) -> str:
        return si(self.made.force * self.between(0.01, 2.0) / (9.81 * volume), "kg/m^3")

    def placement(self) -> Json:
        place = self.offset()
        angle = float(self.random.choice([0.0, self.random.uniform(-3.1, 3.1)]))
        turn = np.array([0.0, angle, 0.0]) if self.planar else angle * self.direction()
        return {**place, "rotation": self.vector(turn, "rad")}

    def joint(self, loose: bool) -> Json:
        kinds = ["fixed", "revolute", "prismatic", "free"]
        kinds += [] if self.planar else ["universal", "spherical"]
        weights = np.array([0.2 if loose else 0.6, *[1.0] * (len(kinds) - 1)])
        kind = str(self.random.choice(kinds, p=weights / weights.sum()))
        joint: Json = {"kind": kind}
        if kind == "fixed":
            return joint
        if kind in ("revolute", "prismatic"):
            joint["axis"] = [0.0, 1.0, 0.0] if self.planar else self.direction().tolist()
            if kind == "prismatic" and self.planar:
                joint["axis"] = self.direction().tolist()
            unit = "N*m/rad" if kind == "revolute" else "N/m"
            joint["stiffness"] = si(self.stiffness(kind == "revolute"), unit)
            if self.chance(0.35):
                self.add_limits(joint, kind)
        else:
            joint["stiffness"] = si(self.stiffness(True), "N*m/rad")
            if kind == "free":
                joint["linear_stiffness"] = si(self.stiffness(False), "N/m")
        return joint

    def add_limits(self, joint: Json, kind: str) -> None:
        rotation = kind == "revolute"
        natural, unit = (1.0, "rad") if rotation else (self.made.length, "m")
        low, high = self.random.uniform(-0.6, -0.05), self.random.uniform(0.05, 0.6)
        joint["lower"], joint["upper"] = si(low * natural, unit), si(high * natural, unit)
        stiffness = self.made.force * (self.made.length if rotation else 1.0 / self.made.length)
        joint["limit_stiffness"] = si(
            10.0 * stiffness * self.between(0.1, 10.0), "N*m/rad" if rotation else "N/m"
        )
        joint["limit_width"] = si(0.02 * natural, unit)
        self.made.kinds["limits"] += 1

    def stiffness(self, rotation: bool) -> float:
        """Draw a joint's stiffness; it may have none."""
        if self.chance(0.2):
            self.made.kinds["no stiffness"] += 1
            return 0.0
        natural = self.made.length if rotation else 1.0 / self.made.length
        return self.made.force * natural * self.between(0.01, 10.0)

    def add_spring(self, number: int) -> None:
        first, second = self.station(), self.station()
        if self.chance(0.4):
            second = {"world": self.offset()}
        if self.chance(0.15):  # ends that coincide
            children = [name for name, body in self.bodies.items() if "parent" in body]
            if children:
                child = str(self.random.choice(children))
                first = {"body": self.bodies[child]["parent"], "at": "tip"}
                second = {"body": child, "at": "base"}
                self.made.kinds["coincident ends"] += 1
        stiffness = self.made.force / self.made.length * self.between(0.01, 100.0)
        rest = float(self.random.choice([0.0, self.random.uniform(0.2, 2.0)]))
        self.document.setdefault("springs", {})[f"s{number}"] = {
            "first": first,
            "second": second,
            "stiffness": si(stiffness, "N/m"),
            "rest_length": si(rest * self.made.length, "m"),
            "slack": self.chance(0.3),
        }
        self.made.kinds["spring"] += 1

    def add_contacts(self) -> None:
        if not self.chance(0.45):
            return
        names = list(self.bodies)
        groups = {f"g{name}": {"bodies": [name]} for name in names}
        self.document["spheres"] = groups
        stiffness = self.made.force / self.made.length
        pairs = [(a, b) for a in names for b in names if a != b]
        if pairs and self.chance(0.7):
            first, second = pairs[int(self.random.integers(len(pairs)))]
            contact: Json = {
                "first": f"g{first}",
                "second": f"g{second}",
                "stiffness": si(stiffness * self.between(1.0, 1e4), "N/m"),
            }
            if self.chance(0.4):
                contact["shape"] = "round-cones"
                self.made.kinds["round-cones"] += 1
            self.document["contacts"] = {"c": contact}
            self.made.kinds["contact"] += 1
        if self.chance(0.5) or not pairs:
            normal = self.direction()
            self.document["obstacles"] = {
                "wall": {
                    **self.obstacle(normal),
                    "spheres": [f"g{self.random.choice(names)}"],
                    "point": self.vector(-normal * self.made.length * self.between(0.05, 1), "m"),
                    "stiffness": si(stiffness * self.between(1.0, 1e4), "N/m"),
                }
            }
            self.made.kinds["obstacle"] += 1

    def obstacle(self, normal: Array) -> Json:
        """Return the shape of an obstacle: often a plane with this normal."""
        if self.chance(0.5):
            return {"kind": "half-space", "normal": normal.tolist()}
        kind = str(self.random.choice(["sphere", "capsule", "cylinder", "box"]))
        size = self.made.length * self.between(0.02, 0.5)
        if kind == "box":
            sides = {axis: si(size * self.between(1.0, 3.0), "m") for axis in "xyz"}
            return {"kind": kind, "size": sides, "rounding": si(0.4 * size, "m")}
        shape: Json = {"kind": kind, "radius": si(size, "m")}
        if kind != "sphere":
            shape["axis"] = self.direction().tolist()
        if kind == "capsule":
            shape["length"] = si(size * self.between(0.1, 3.0), "m")
        return shape

    def add_actuator(self, number: int) -> None:
        rods = [name for name, body in self.bodies.items() if body["kind"] == "rod"]
        if not rods:
            return
        kind = str(self.random.choice(["chamber", "cable"]))
        lever = {"z": float(self.random.uniform(-1.5, 1.5))}
        if not self.planar:
            lever["y"] = float(self.random.uniform(-1.5, 1.5))
        rod = str(self.random.choice(rods))
        actuator: Json = {"kind": kind, "rod": rod, "lever": lever}
        if not self.planar and self.chance(0.3):
            radius = float(self.bodies[rod]["radius"]["base"].split()[0])
            turn = float(self.random.uniform(-6.0, 6.0))
            actuator["path"] = {"radius": si(radius, "m"), "turn": si(turn, "rad")}
            self.made.kinds["helix"] += 1
        self.document.setdefault("actuators", {})[f"a{number}"] = actuator
        self.made.kinds[kind] += 1

    def add_wrench(self, number: int) -> None:
        follower = self.chance(0.35)
        force = self.direction() * self.made.force * self.between(0.05, 3.0)
        wrench: Json = {
            **self.station(),
            "force": self.vector(force, "N"),
            "frame": "body" if follower else "world",
            "input": self.chance(0.7),
        }
        if self.chance(0.3):
            axis = np.array([0.0, 1.0, 0.0]) if self.planar else self.direction()
            moment = axis * self.made.force * self.made.length * self.between(0.05, 1.0)
            wrench["moment"] = self.vector(moment, "N*m")
            self.made.kinds["moment"] += 1
        self.document.setdefault("wrenches", {})[f"w{number}"] = wrench
        # It has its force in the file and is multiplied by its load.
        self.sizes[f"w{number}"] = 1.0
        self.made.kinds["follower" if follower else "dead force"] += 1

    def station(self) -> Json:
        name = str(self.random.choice(list(self.bodies)))
        ends = ["base", "tip", "tip"]
        ends += ["centroid"] if self.bodies[name]["kind"] == "link" else []
        station: Json = {"body": name, "at": str(self.random.choice(ends))}
        if self.chance(0.3):
            offset = self.direction() * self.made.length * self.between(0.01, 0.5)
            station["offset"] = self.vector(offset, "m")
        return station

    def offset(self) -> Json:
        if self.chance(0.3):
            return {}
        return self.vector(self.direction() * self.made.length * self.between(0.05, 2.0), "m")

    def direction(self) -> Array:
        """Draw a unit vector, of a planar model in its plane; often along an axis."""
        if self.chance(0.3):
            axes = [0, 2] if self.planar else [0, 1, 2]
            direction = np.zeros(3)
            direction[int(self.random.choice(axes))] = 1.0 if self.chance(0.5) else -1.0
            return direction
        direction = self.random.normal(size=3)
        if self.planar:
            direction[1] = 0.0
        return np.asarray(direction / np.linalg.norm(direction))

    def vector(self, components: Array, unit: str) -> Json:
        return {axis: si(x, unit) for axis, x in zip("xyz", components.tolist(), strict=True)}

    def between(self, low: float, high: float) -> float:
        """Draw from a logarithmic distribution."""
        return float(low * (high / low) ** self.random.uniform())

    def chance(self, share: float) -> bool:
        return bool(self.random.uniform() < share)


def si(value: float, unit: str) -> str:
    """Write a quantity so that it reads back to the same number."""
    return f"{float(value)!r} {unit}"
