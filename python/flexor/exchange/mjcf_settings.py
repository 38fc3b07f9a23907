"""Settings of MJCF that hold for a whole file: classes of defaults and the compiler's options."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexor.arrays import Array
from flexor.exchange import rotations
from flexor.exchange.xml import Element

Attributes = dict[str, str]
MAIN = "main"


@dataclass(frozen=True)
class Settings:
    """What elements without an own value have.

    Attributes
    ----------
    angle : float
        What angles are multiplied by to be in radians.
    sequence : str
        Axes of the three angles of a rotation.
    limits_by_range : bool
        Whether a range alone limits a joint.
    classes : dict
        Defaults by class and tag.
    """

    angle: float
    sequence: str
    limits_by_range: bool
    classes: dict[str, dict[str, Attributes]]

    def merged(self, element: Element, tag: str, kind: str | None) -> Attributes:
        """Return the attributes of an element with those of its class."""
        name = element.attributes.get("class", kind) or MAIN
        if name not in self.classes:
            raise element.error(f'is of the class "{name}", which no default defines')
        own = {key: value for key, value in element.attributes.items() if key != "class"}
        inherited = self.classes[name].get(tag, {})
        # One way to say how something is oriented replaces another one.
        if any(key in own for key in _TURNS):
            inherited = {key: value for key, value in inherited.items() if key not in _TURNS}
        return {**inherited, **own}

    def limited(self, element: Element) -> bool:
        """Return whether a range counts."""
        given = element.attributes.get("limited", "auto")
        if given not in ("auto", "true", "false"):
            raise element.error(f'has limited="{given}": expected "true", "false" or "auto"')
        if given == "auto":
            return self.limits_by_range and "range" in element.attributes
        return given == "true"

    def turn(self, element: Element) -> Array:
        """Return the rotation of an element that says how it is oriented, or none."""
        given = [key for key in _TURNS if key in element.attributes]
        if len(given) > 1:
            raise element.error(f"has both {given[0]} and {given[1]}: expected one of them")
        if not given:
            return np.eye(3)
        key = given[0]
        values = element.numbers(key, _TURNS[key])
        found: Array | None = None
        if key == "quat" and np.linalg.norm(values) > 0.0:
            found = rotations.from_quaternion(values)
        elif key == "axisangle" and np.linalg.norm(values[:3]) > 0.0:
            found = rotations.about(values[:3], self.angle * float(values[3]))
        elif key == "euler":
            found = rotations.from_euler(self.angle * values, self.sequence)
        elif key == "xyaxes":
            found = rotations.from_axes(values[:3], values[3:])
        elif key == "zaxis":
            found = rotations.from_z(values)
        if found is None:
            raise element.error(f"has a {key} without a direction")
        return found


_TURNS = {"quat": 4, "axisangle": 4, "euler": 3, "xyaxes": 6, "zaxis": 3}


def settings_of(root: Element) -> Settings:
    """Return the settings of a file, wherever in it they are; later ones replace earlier ones."""
    compiler: Attributes = {}
    for element in root.children_of("compiler"):
        compiler |= element.attributes
        if element.attributes.get("coordinate", "local") != "local":
            raise element.error('has coordinate="global", which is not read: save it as local')
        for key, allowed in (("angle", ("degree", "radian")), ("autolimits", ("true", "false"))):
            if element.attributes.get(key, allowed[0]) not in allowed:
                expected = " or ".join(f'"{one}"' for one in allowed)
                raise element.error(f'has {key}="{element.attributes[key]}": expected {expected}')
        sequence = element.attributes.get("eulerseq", "xyz")
        if len(sequence) != 3 or not set(sequence) <= set("xyzXYZ"):
            raise element.error(f'has eulerseq="{sequence}": expected three of xyz or of XYZ')
    classes: dict[str, dict[str, Attributes]] = {MAIN: {}}
    for element in root.children_of("default"):
        _add_class(element, classes, None)
    return Settings(
        angle=1.0 if compiler.get("angle") == "radian" else np.pi / 180.0,
        sequence=compiler.get("eulerseq", "xyz"),
        limits_by_range=compiler.get("autolimits", "true") == "true",
        classes=classes,
    )


def _add_class(
    element: Element, classes: dict[str, dict[str, Attributes]], parent: str | None
) -> None:
    name = element.attributes.get("class")
    if name is None:
        if parent is not None:
            raise element.error("has no class")
        name = MAIN
    inherited = classes[name] if parent is None and name in classes else classes[parent or MAIN]
    own = {tag: dict(attributes) for tag, attributes in inherited.items()}
    for child in element.children:
        if child.tag != "default":
            own[child.tag] = {**own.get(child.tag, {}), **child.attributes}
    classes[name] = own
    for child in element.children_of("default"):
        _add_class(child, classes, name)
