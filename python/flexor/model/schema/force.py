"""Base class of the forces of a model file."""

from __future__ import annotations

from abc import abstractmethod
from typing import Any, ClassVar

from flexor.model.schema.body_system import BodySystem
from flexor.model.schema.table import Table


class Force(Table):
    """A table that describes a force on bodies, named in one of the file's tables.

    The registry of forces are the fields of `ModelFile`. Checks raise `PydanticCustomError`, which
    names the field; ``path`` is the dotted path of the table, for messages.
    """

    description: ClassVar[str]  # list of the engine's description that it belongs to

    @abstractmethod
    def check(self, path: str, system: BodySystem) -> None:
        """Check that every reference resolves in the file that the table is in."""

    def check_planar(self, path: str) -> None:
        """Reject anything that leaves the plane of a planar model."""

    def listed(self) -> str:
        """Return the list of the engine's description that it belongs to."""
        return self.description

    @abstractmethod
    def lower(self, name: str, system: BodySystem) -> dict[str, Any]:
        """Describe the force to the engine, ready for JSON: SI units, every list explicit."""
