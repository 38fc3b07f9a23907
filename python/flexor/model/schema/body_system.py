"""Bodies and the spheres on them, which forces refer to."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from functools import cached_property
from typing import Annotated, Any, TypeVar, get_args, get_origin

from pydantic import Field, model_validator

from flexor.arrays import Array
from flexor.materials import library
from flexor.model.schema.body import Body, Rod
from flexor.model.schema.material import Material
from flexor.model.schema.points import SphereGroup
from flexor.model.schema.reference import reference_frames
from flexor.model.schema.table import Name, Switch, Table, Text
from flexor.model.schema.vector import Gravity

T = TypeVar("T", bound=Table)


class BodySystem(Table):
    """The part of a model file that does not depend on the forces."""

    name: Name
    title: Text = ""
    planar: Switch = False
    gravity: Gravity = Gravity()
    bodies: Annotated[dict[Name, Body], Field(min_length=1)]
    materials: dict[Name, Material] = Field(default_factory=dict)
    spheres: dict[Name, SphereGroup] = Field(default_factory=dict)

    @model_validator(mode="before")
    @classmethod
    def _add_materials(cls, data: object) -> object:
        """Add the materials that rods name and only the library has."""
        if not isinstance(data, Mapping):
            return data
        given, bodies = data.get("materials", {}), data.get("bodies", {})
        if not isinstance(given, Mapping) or not isinstance(bodies, Mapping):
            return data
        sections = [
            {key: body[key] for key in ("material", "section") if key in body}
            for body in bodies.values()
            if isinstance(body, Mapping)
        ]
        named = set(_named_materials(sections))
        found = {
            name: {"library": name} for name in sorted(named - set(given)) if name in library()
        }
        return {**data, "materials": {**given, **found}} if found else data

    @classmethod
    def named_tables(cls) -> dict[str, Any]:
        """Return the type of the entries of each table of named entries.

        Sphere groups are last: they may have the name of a body or of a force.
        """
        fields = {name: field.annotation for name, field in cls.model_fields.items()}
        fields["spheres"] = fields.pop("spheres")
        for table in ("start", "solver"):  # their keys are no names of their own
            fields.pop(table, None)
        mappings = {name: get_args(f) for name, f in fields.items() if get_origin(f) is dict}
        return {name: kind for name, (_, kind) in mappings.items() if get_origin(kind) is not dict}

    def entries(self, kind: type[T]) -> Iterator[tuple[str, str, T]]:
        """Yield table, name and entry of each named entry of a kind."""
        for table in self.named_tables():
            for name, entry in getattr(self, table).items():
                if isinstance(entry, kind):
                    yield table, name, entry

    @cached_property
    def reference_frames(self) -> dict[str, Callable[[float], Array]]:
        """The frame along each body in the reference state; see `reference_frames`."""
        return reference_frames(self.bodies)

    @property
    def pressing(self) -> dict[str, float]:
        """Half of the width of the narrowest obstacle [m] on which each body's skin presses."""
        return {}

    def rod(self, name: str) -> Rod:
        """Return a rod by name."""
        body = self.bodies[name]
        if not isinstance(body, Rod):
            raise TypeError(f"{name} is a {body.kind}")
        return body


def _named_materials(table: object) -> Iterator[str]:
    """Yield the values of all keys ``material`` in tables and lists and what is in these."""
    if isinstance(table, Mapping):
        for key, value in table.items():
            if key == "material" and isinstance(value, str):
                yield value
            elif not isinstance(value, str):
                yield from _named_materials(value)
    elif isinstance(table, (list, tuple)):
        for each in table:
            yield from _named_materials(each)
