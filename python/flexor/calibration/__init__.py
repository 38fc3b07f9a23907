"""Calibration: constants of models fitted to measured or published values.

`calibrate` fits; `flexor.calibration.schema` is the schema of targets files.
"""

from __future__ import annotations

from flexor.calibration.constants import Constant
from flexor.calibration.identifiability import Direction, Identifiability, Profile
from flexor.calibration.reading import parse, read
from flexor.calibration.result import Calibration, Fit
from flexor.calibration.run import calibrate
from flexor.calibration.schema import TargetsFile
from flexor.calibration.stages import Progress

__all__ = [
    "Calibration",
    "Constant",
    "Direction",
    "Fit",
    "Identifiability",
    "Profile",
    "Progress",
    "TargetsFile",
    "calibrate",
    "parse",
    "read",
]
