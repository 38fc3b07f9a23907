"""From a design to what is made: solids, moulds, cut outlines, a printed finger, a bench."""

from __future__ import annotations

from flexor.export.body import Body, body
from flexor.export.device import Device, device_of, device_of_design, model_of_design, recorded
from flexor.export.files import write_solid
from flexor.export.finger import Finger, finger
from flexor.export.mould import Mould, mould
from flexor.export.options import BodyOptions, FingerOptions, MouldOptions
from flexor.export.sheets import Sheet, sheets, write_dxf

__all__ = [
    "Body",
    "BodyOptions",
    "Device",
    "Finger",
    "FingerOptions",
    "Mould",
    "MouldOptions",
    "Sheet",
    "body",
    "device_of",
    "device_of_design",
    "finger",
    "model_of_design",
    "mould",
    "recorded",
    "sheets",
    "write_dxf",
    "write_solid",
]
