"""Calibration: constants of models fitted to what was measured or published.

`calibrate` fits; what a targets file may say is in `flexor.calibrate.schema`.
"""

from __future__ import annotations

from flexor.calibrate.calibration import Calibration, Fit
from flexor.calibrate.constants import Constant
from flexor.calibrate.knowledge import Direction, Knowledge, Profile
from flexor.calibrate.progress import Progress
from flexor.calibrate.reading import parse, read
from flexor.calibrate.run import calibrate
from flexor.calibrate.schema import TargetsFile

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
