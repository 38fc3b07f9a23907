"""Random models with sections of materials, cavities under pressure and several pieces."""

from __future__ import annotations

from typing import Any

import numpy as np
from _random_models import Generator, Json, si

LAWS = ("linear", "neo-hookean", "mooney-rivlin", "yeoh", "ogden")


class Devices(Generator):
    """Draws models of which most rods are devices."""

    def rod(self) -> Json:
        """Draw a rod."""
        rod = super().rod()
        if self.chance(0.15):
            return rod
        modulus = float(rod.pop("young_modulus").split()[0])
        rod.pop("poisson_ratio")
        rod.pop("density", None)
        materials = self.document.setdefault("materials", {})
        name, stiff = f"m{len(materials)}", f"m{len(materials) + 1}"
        materials[name] = {**self.law(modulus), "winding": self.pick("none", "hoop")}
        materials[stiff] = self.law(modulus * self.between(3.0, 1e3))
        if self.weight:
            materials[name]["density"] = rod_density = self.density(
                float(rod["radius"]["base"].split()[0]) ** 2 * float(rod["length"].split()[0])
            )
            materials[stiff]["density"] = rod_density
        rod["material"] = name
        if self.chance(0.25) and rod["elements"] > 1:
            middle = int(self.random.integers(1, rod["elements"])) / rod["elements"]
            first, second = self.section(stiff), self.section(stiff)
            rod["section"] = [{**first, "span": [0.0, middle]}, {**second, "span": [middle, 1.0]}]
            self.made.kinds["two sections"] += 1
        else:
            rod["section"] = self.section(stiff)
        return rod

    def law(self, modulus: float) -> Json:
        """Draw a material with this Young's modulus."""
        kind = str(self.random.choice(np.array(LAWS)))
        self.made.kinds[kind] += 1
        shear = modulus / 3.0
        if kind == "linear":
            ratio = float(self.random.uniform(-0.5, 0.5))
            return {"kind": kind, "young_modulus": si(modulus, "Pa"), "poisson_ratio": ratio}
        if kind == "neo-hookean":
            return {"kind": kind, "shear_modulus": si(shear, "Pa")}
        if kind == "mooney-rivlin":
            share = float(self.random.uniform(-0.2, 0.6))
            first, second = 0.5 * shear * (1.0 - share), 0.5 * shear * share
            return {"kind": kind, "c10": si(first, "Pa"), "c01": si(second, "Pa")}
        if kind == "yeoh":
            second, third = (shear * self.random.uniform(-0.05, 0.1) for _ in range(2))
            table = {"c1": 0.5 * shear, "c2": second, "c3": abs(third)}
            return {"kind": kind, **{key: si(value, "Pa") for key, value in table.items()}}
        exponents = [float(self.random.uniform(1.0, 4.0)), float(self.random.uniform(-3.0, 6.0))]
        share = float(self.random.uniform(0.0, 0.4))
        mu = [2.0 * shear * (1.0 - share) / exponents[0], 2.0 * shear * share / exponents[1]]
        return {"kind": kind, "mu": [si(each, "Pa") for each in mu], "alpha": exponents}

    def section(self, stiff: str) -> Json:
        """Draw a section, of multiples of S; `stiff` is the material of its layer."""
        kind = self.pick("tube", "half-round", "box", "composite", "circular", "stiffness")
        self.made.kinds[kind] += 1
        if kind == "circular":
            return {"kind": kind}
        if kind == "stiffness":
            size = self.made.force * self.made.length**2
            section: Json = {"kind": kind, "EI_yy": si(size * self.between(0.1, 10.0), "N*m^2")}
            section["EI_zz"] = section["GJ"] = section["EI_yy"]
            for key in ("EA", "GA_y", "GA_z"):
                section[key] = si(1e3 * self.made.force * self.between(0.1, 10.0), "N")
            return section
        if kind == "composite":
            place = 0.0 if self.planar else float(self.random.uniform(-0.2, 0.2))
            return {
                "kind": kind,
                "torsion_stiffness": si(self.made.force * self.made.length**2, "N*m^2"),
                "parts": [
                    {"shape": "ring", "radius": 1.0, "wall": float(self.random.uniform(0.1, 0.5))},
                    {"shape": "disc", "y": place, "radius": 0.2, "cavity": "bore"},
                    {"shape": "rectangle", "z": -1.1, "width": 1.0, "height": 0.2},
                ],
            }
        section = {
            "kind": kind,
            "wall": float(self.random.uniform(0.05, 0.9)),
            "stretch": float(self.random.uniform(0.9, 1.3)),
            "winding": self.pick("outside", "inside"),
        }
        if kind != "tube":
            section["floor"] = float(self.random.uniform(0.1, 0.8))
            if self.chance(0.5):
                thickness = 0.5 * section["floor"] * float(self.random.uniform(0.1, 1.0))
                section["layer"] = {"thickness": thickness, "material": stiff}
        elif self.chance(0.5):
            thickness = 0.5 * section["wall"] * float(self.random.uniform(0.1, 1.0))
            width = float(self.random.uniform(0.1, 1.0))
            section["layer"] = {"thickness": thickness, "width": width, "material": stiff}
        if kind == "box":
            section["width"] = float(self.random.uniform(2.0, 5.0))
        return section

    def add_actuator(self, number: int) -> None:
        """Add a pressure, where there is a cavity, or a line."""
        rods = [name for name, body in self.bodies.items() if cavities(body)]
        if not rods or self.chance(0.3):
            super().add_actuator(number)
            return
        rod = str(self.random.choice(rods))
        actuator: Json = {"kind": "pressure", "rod": rod}
        if self.chance(0.3):
            ends = np.sort(self.random.uniform(0.0, 1.0, 2)).tolist()
            actuator["span"] = ends
        self.document.setdefault("actuators", {})[f"a{number}"] = actuator
        radius = float(self.bodies[rod]["radius"]["base"].split()[0])
        self.sizes[f"a{number}"] = 0.1 * self.made.force * self.made.length / radius**3
        self.made.kinds["pressure"] += 1

    def pick(self, *names: str) -> str:
        """Draw a name."""
        return str(self.random.choice(np.array(names)))


def cavities(body: Json) -> bool:
    """Whether a body has a section with a cavity."""
    sections: Any = body.get("section", {})
    pieces = sections if isinstance(sections, list) else [sections]
    return any(each.get("kind") in ("tube", "half-round", "box", "composite") for each in pieces)
