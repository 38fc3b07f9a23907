"""Protocol of the tables of a model file, for the consistency checks."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Protocol

from flexor.model.schema.actuator import Actuator
from flexor.model.schema.body import Body
from flexor.model.schema.design import Design
from flexor.model.schema.obstacle import Obstacle
from flexor.model.schema.points import Contact, SphereGroup, Spring, Wrench
from flexor.model.schema.vector import Gravity


class Tables(Protocol):
    """What `ModelFile` has of them."""

    @property
    def gravity(self) -> Gravity:
        """Gravitational acceleration."""
        ...

    @property
    def bodies(self) -> Mapping[str, Body]:
        """Rods and links."""
        ...

    @property
    def spheres(self) -> Mapping[str, SphereGroup]:
        """Groups of spheres."""
        ...

    @property
    def contacts(self) -> Mapping[str, Contact]:
        """Contacts between groups."""
        ...

    @property
    def obstacles(self) -> Mapping[str, Obstacle]:
        """Fixed obstacles."""
        ...

    @property
    def actuators(self) -> Mapping[str, Actuator]:
        """Chambers and cables."""
        ...

    @property
    def springs(self) -> Mapping[str, Spring]:
        """Springs and straps."""
        ...

    @property
    def wrenches(self) -> Mapping[str, Wrench]:
        """Point loads."""
        ...

    @property
    def design(self) -> Design | None:
        """What is designed."""
        ...
