"""Base class of the forces of a model file."""

from __future__ import annotations

from abc import abstractmethod
from typing import Any, ClassVar

from flexor.model.schema.body_system import BodySystem
from flexor.model.schema.table import Table


class Force(Table):
    """A table that describes a force on bodies, named in one of the file's tables.

    The registry of forces are the fields of `ModelFile`.

    Attributes
    ----------
    description : str
        List of the engine's description that it belongs to.
    """

    description: ClassVar[str]

    @abstractmethod
    def check(self, path: str, system: BodySystem) -> None:
        """Check that every reference resolves.

        Parameters
        ----------
        path
            Dotted path of the table, for messages.
        system
            The file that it is in.

        Raises
        ------
        PydanticCustomError
            Naming the field that does not.
        """

    def check_planar(self, path: str) -> None:
        """Reject anything that leaves the plane of a planar model.

        Parameters
        ----------
        path
            Dotted path of the table, for messages.

        Raises
        ------
        PydanticCustomError
            Naming the field that does.
        """

    @abstractmethod
    def lower(self, name: str, system: BodySystem) -> dict[str, Any]:
        """Describe the force to the engine.

        Parameters
        ----------
        name
            Its name.
        system
            The checked file that it is in.

        Returns
        -------
        dict
            Its description, ready for JSON: SI units, every list explicit.
        """
