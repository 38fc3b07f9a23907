"""Bodies and the spheres on them, which forces refer to."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated, Any, TypeVar, get_args, get_origin

from pydantic import Field

from flexor.model.schema.body import Body, Rod
from flexor.model.schema.points import SphereGroup
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
    spheres: dict[Name, SphereGroup] = Field(default_factory=dict)

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

    def rod(self, name: str) -> Rod:
        """Return a rod by name."""
        body = self.bodies[name]
        if not isinstance(body, Rod):
            raise TypeError(f"{name} is a {body.kind}")
        return body
