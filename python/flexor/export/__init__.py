"""From a design to what is made: solids, moulds, cut outlines, a printed finger, a bench."""

from __future__ import annotations

from flexor.export.body import Body, body
from flexor.export.device import Device, device_of, device_of_design, recorded
from flexor.export.files import write_solid
from flexor.export.mould import Mould, mould
from flexor.export.options import BodyOptions, MouldOptions
from flexor.export.sheets import Sheet, sheets, write_dxf

__all__ = [
    "Body",
    "BodyOptions",
    "Device",
    "Mould",
    "MouldOptions",
    "Sheet",
    "body",
    "device_of",
    "device_of_design",
    "mould",
    "recorded",
    "sheets",
    "write_dxf",
    "write_solid",
]
