"""Parameter sets: maps from design parameters to the exosuit's geometry, with Jacobians."""

from __future__ import annotations

from flexor.design.catalogue import names, parameter_set, register
from flexor.design.choices import Combination, combinations
from flexor.design.custom import custom
from flexor.design.mapped import MappedVariables, mapped
from flexor.design.parameter_set import ParameterSet
from flexor.design.profile import Clamped, Profile
from flexor.design.published import Legendre, Linear, SineCosine
from flexor.design.stated_variables import variables
from flexor.design.union import union
from flexor.design.variables import Variables
from flexor.model.geometry import DesignSpace, Geometry, GeometryJacobian

__all__ = [
    "Clamped",
    "Combination",
    "DesignSpace",
    "Geometry",
    "GeometryJacobian",
    "Legendre",
    "Linear",
    "MappedVariables",
    "ParameterSet",
    "Profile",
    "SineCosine",
    "Variables",
    "combinations",
    "custom",
    "mapped",
    "names",
    "parameter_set",
    "register",
    "union",
    "variables",
]
