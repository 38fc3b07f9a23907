"""The top level of a model file."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import Field, model_validator

from flexor.model.schema.actuator import Actuator
from flexor.model.schema.body import Body, Rod
from flexor.model.schema.checks import check_names, check_references, check_tree
from flexor.model.schema.design import Design, Evaluation
from flexor.model.schema.obstacle import Obstacle
from flexor.model.schema.planar import check_planar
from flexor.model.schema.points import Contact, SphereGroup, Spring, Wrench
from flexor.model.schema.start import StartTable
from flexor.model.schema.table import Name, Switch, Table, Text
from flexor.model.schema.vector import Gravity


class ModelFile(Table):
    """A model file with one of its sets of constants applied.

    ``constants`` holds the sets as written, ``use`` the name of the one whose values have been
    applied to the other tables; see `flexor.model.constants`.
    """

    name: Name
    title: Text = ""
    planar: Switch = False
    gravity: Gravity = Gravity()
    bodies: Annotated[dict[Name, Body], Field(min_length=1)]
    spheres: dict[Name, SphereGroup] = Field(default_factory=dict)
    contacts: dict[Name, Contact] = Field(default_factory=dict)
    obstacles: dict[Name, Obstacle] = Field(default_factory=dict)
    actuators: dict[Name, Actuator] = Field(default_factory=dict)
    springs: dict[Name, Spring] = Field(default_factory=dict)
    wrenches: dict[Name, Wrench] = Field(default_factory=dict)
    design: Design | None = None
    evaluation: Evaluation = Evaluation()
    start: StartTable = Field(default_factory=dict)
    constants: dict[Name, dict[str, Any]] = Field(default_factory=dict)
    use: Name | None = None

    @model_validator(mode="after")
    def _check(self) -> ModelFile:
        """Check the consistency of the tables."""
        check_names(self)
        check_tree(self)
        check_references(self)
        if self.planar:
            check_planar(self)
        return self

    def rod(self, name: str) -> Rod:
        """Return a rod by name.

        Parameters
        ----------
        name
            Its name.
        """
        body = self.bodies[name]
        if not isinstance(body, Rod):
            raise TypeError(f"{name} is a {body.kind}")
        return body

    def to_document(self) -> dict[str, Any]:
        """Return the tables as TOML values, with quantities as originally written."""
        document = self.model_dump(exclude_none=True)
        return {key: value for key, value in document.items() if value != {}}

    def to_toml(self) -> str:
        """Serialise the file as TOML.

        Returns
        -------
        str
            Text that parses to an equal `ModelFile`.
        """
        import tomli_w

        return tomli_w.dumps(self.to_document())
