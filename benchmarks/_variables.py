"""Fields of the pneumatic finger as design variables, of every kind, for tests and benchmarks."""

from __future__ import annotations

# Lengths, profiles, sections, layers, places, straps, moduli, skins, joints with
# their limits.
FIELDS: dict[str, tuple[object, object]] = {
    "exosuit.length": ("9 cm", "11 cm"),
    "exosuit.radius.base": ("7 mm", "10 mm"),
    "exosuit.radius.tip": ("5.5 mm", "8 mm"),
    "exosuit.section.wall": ("1.5 mm", "2.5 mm"),
    "exosuit.section.floor": ("1.8 mm", "3 mm"),
    "exosuit.section.layer.thickness": ("0.3 mm", "0.6 mm"),
    "exosuit.placement.z": ("2.1 cm", "2.2 cm"),
    "proximal.to.at": (0.45, 0.65),
    "middle.slack": ("0 mm", "1 mm"),
    "distal.width": ("10 mm", "20 mm"),
    "fabric.young_modulus": ("20 MPa", "40 MPa"),
    "ph_1.skin.thickness": ("1.5 mm", "2.5 mm"),
    "ph_2.joint.stiffness": ("0.02 N*m/rad", "0.05 N*m/rad"),
    "ph_3.length": ("2.2 cm", "2.5 cm"),
    "ph_1.joint.rest": ("-5 deg", "5 deg"),
    "ph_3.joint.upper": ("20 deg", "90 deg"),
    "ph_3.joint.limit_stiffness": ("5 N*m/rad", "15 N*m/rad"),
    "ph_3.joint.limit_width": ("0.5 deg", "3 deg"),
}
# And the load.
VARIABLES = {**FIELDS, "evaluation.pressure": ("40 kPa", "60 kPa")}
