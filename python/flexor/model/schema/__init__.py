"""Schema of model files: one frozen pydantic model per table.

`ModelFile` is the whole file; its fields are the registry of forces, each of which has its own
module. Attributes are in SI units and keep their original text.
"""

from __future__ import annotations

from flexor.model.schema.body import Body, Link, Placement, Rod
from flexor.model.schema.design import Design, Evaluation
from flexor.model.schema.joint import (
    FixedJoint,
    FreeJoint,
    Joint,
    PrismaticJoint,
    RevoluteJoint,
)
from flexor.model.schema.model_file import ModelFile
from flexor.model.schema.points import SphereGroup

__all__ = [
    "Body",
    "Design",
    "Evaluation",
    "FixedJoint",
    "FreeJoint",
    "Joint",
    "Link",
    "ModelFile",
    "Placement",
    "PrismaticJoint",
    "RevoluteJoint",
    "Rod",
    "SphereGroup",
]
