"""Models: TOML files with units, checked and lowered to the engine.

`load` gives a `Model`; `Model.equilibrium` follows its equilibria as a `Path`, `Model.evaluate`
those of many designs as `Paths`. What a file may say is in `flexor.model.schema`.
"""

from __future__ import annotations

from flexor.model.contact_forces import ContactForces
from flexor.model.events import Event
from flexor.model.extremes import Extreme
from flexor.model.geometry import DesignSpace, Geometry, GeometryJacobian, SlotValues
from flexor.model.loading import load
from flexor.model.loads import forces
from flexor.model.model import Model
from flexor.model.reading import parse, presets, read
from flexor.model.results import Path, Paths, State
from flexor.model.schema import ModelFile
from flexor.model.status import MEANINGS, explained, why_not_closed, why_singular, why_stalled

__all__ = [
    "MEANINGS",
    "ContactForces",
    "DesignSpace",
    "Event",
    "Extreme",
    "Geometry",
    "GeometryJacobian",
    "Model",
    "ModelFile",
    "Path",
    "Paths",
    "SlotValues",
    "State",
    "explained",
    "forces",
    "load",
    "parse",
    "presets",
    "read",
    "why_not_closed",
    "why_singular",
    "why_stalled",
]
