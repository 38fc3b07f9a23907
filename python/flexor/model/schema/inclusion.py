"""Parts: models that a model is made of."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import Field, model_validator

from flexor.model.schema.body import Placement
from flexor.model.schema.table import Name, PositiveNumber, Switch, Table, Text
from flexor.model.validation import describe, field_error


class Inclusion(Table):
    """A model of another file, ``file``, as a part of this one.

    Its world is the frame ``placement`` at the tip of ``parent``, or in the world. ``mirror``
    reflects it in its x-z plane, ``scale`` multiplies its lengths; ``set`` are values of its
    fields, by dotted path, ``variant`` one of its variants.
    """

    file: Text
    variant: Name | None = None
    parent: Name | None = None
    placement: Placement = Placement()
    mirror: Switch = False
    scale: Annotated[PositiveNumber, Field(ge=0.01, le=100.0)] = 1.0
    set: dict[Text, Any] = Field(default_factory=dict)

    @model_validator(mode="after")
    def _check(self) -> Inclusion:
        if self.placement.reference != "axis":
            tail = f"is {describe(self.placement.reference)}: a part is placed by its axes"
            raise field_error(tail, path="placement.reference")
        return self
