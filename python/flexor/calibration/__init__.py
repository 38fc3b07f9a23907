"""Calibration: constants of models fitted to what was measured or published.

`calibrate` fits; what a targets file may say is in `flexor.calibration.schema`.
"""

from __future__ import annotations

from flexor.calibration.calibration import Calibration, Fit
from flexor.calibration.constants import Constant
from flexor.calibration.knowledge import Direction, Knowledge, Profile
from flexor.calibration.progress import Progress
from flexor.calibration.reading import parse, read
from flexor.calibration.run import calibrate
from flexor.calibration.schema import TargetsFile

__all__ = [
    "Calibration",
    "Constant",
    "Direction",
    "Fit",
    "Knowledge",
    "Profile",
    "Progress",
    "TargetsFile",
    "calibrate",
    "parse",
    "read",
]
