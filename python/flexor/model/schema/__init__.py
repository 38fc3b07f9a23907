"""Schema of model files: one frozen pydantic model per table.

`ModelFile` is the whole file. Attributes are in SI units and keep their original text.
"""

from __future__ import annotations

from flexor.model.schema.actuator import Actuator, Curve, Helix, Lever
from flexor.model.schema.body import Body, Link, Placement, Rod, Section
from flexor.model.schema.design import Design, Evaluation
from flexor.model.schema.joint import (
    FixedJoint,
    FreeJoint,
    Joint,
    PrismaticJoint,
    RevoluteJoint,
    SphericalJoint,
    UniversalJoint,
)
from flexor.model.schema.model_file import ModelFile
from flexor.model.schema.obstacle import Obstacle
from flexor.model.schema.points import (
    Attachment,
    Contact,
    Ground,
    SphereGroup,
    Spring,
    Station,
    Wrench,
)
from flexor.model.schema.profile import Taper
from flexor.model.schema.strain import ModeBasis, ReferenceStrain, Strain

__all__ = [
    "Actuator",
    "Attachment",
    "Body",
    "Contact",
    "Curve",
    "Design",
    "Evaluation",
    "FixedJoint",
    "FreeJoint",
    "Ground",
    "Helix",
    "Joint",
    "Lever",
    "Link",
    "ModeBasis",
    "ModelFile",
    "Obstacle",
    "Placement",
    "PrismaticJoint",
    "ReferenceStrain",
    "RevoluteJoint",
    "Rod",
    "Section",
    "SphereGroup",
    "SphericalJoint",
    "Spring",
    "Station",
    "Strain",
    "Taper",
    "UniversalJoint",
    "Wrench",
]
