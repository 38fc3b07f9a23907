"""The mirror image of a part in its x-z plane, such as the left hand of a right one.

Points and forces change the sign of y, rotations and moments those of x and z. Flexion, about y,
stays flexion.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Any

from flexor.model import units
from flexor.model.composition.rebuilding import rebuilt
from flexor.model.schema.actuator import Curve, Helix, Lever
from flexor.model.schema.body import Placement
from flexor.model.schema.coupling import Coupling
from flexor.model.schema.joint import PrismaticJoint, RevoluteJoint
from flexor.model.schema.obstacle import HalfSpace
from flexor.model.schema.section import Part, Stiffness
from flexor.model.schema.solid import Capsule, Cylinder
from flexor.model.schema.strain import ReferenceStrain
from flexor.model.schema.table import Table
from flexor.model.schema.tie import Tie
from flexor.model.schema.torque import DoubleExponential, Spastic, TorqueTable
from flexor.model.schema.vector import ForceVector, MomentVector, Offset, Rotation, Triple
from flexor.model.schema.wrap import Wrap
from flexor.model.units import Quantity

# Strain modes that change their sign.
_ODD = ("twist_x", "bend_z", "shear_y")
# Of a symmetric matrix in the order of the modes, the rows that belong to them.
_ODD_ROWS = (0, 2, 4)


def mirrored(table: Table) -> Table:
    """Return the mirror image of a table of a part."""

    def change(each: Table) -> Mapping[str, Any]:
        for kind, image in _IMAGES.items():
            if isinstance(each, kind):
                return image(each)
        return {}

    made: Table = rebuilt(table, change)
    return made


def _negative(value: Any) -> Any:
    """Return minus a quantity, or minus each of several."""
    if isinstance(value, tuple):
        return tuple(_negative(each) for each in value)
    if not isinstance(value, Quantity):
        return 0.0 - value
    text = value.text.strip().removeprefix("+")
    text = text[1:].strip() if text.startswith("-") else f"-{text}"
    return Quantity(0.0 - value, text) if value != 0.0 else value


def _with_negative(*names: str) -> Callable[[Any], dict[str, Any]]:
    def image(each: Any) -> dict[str, Any]:
        return {
            name: _negative(value) for name in names if (value := getattr(each, name)) is not None
        }

    return image


def _polar(axis: Triple) -> Triple:
    return (axis[0], 0.0 - axis[1], axis[2])


def _axial(axis: Triple) -> Triple:
    return (0.0 - axis[0], axis[1], 0.0 - axis[2])


def _tie(tie: Tie) -> dict[str, Any]:
    if tie.axis is None:
        return {}
    turns = tie.kind == "hinge" or tie.drive == "rotation"
    return {"axis": _axial(tie.axis) if turns else _polar(tie.axis)}


def _helix(helix: Helix) -> dict[str, Any]:
    start = units.ANGLE.si(math.pi - helix.start)
    return {"start": start, "turn": _negative(helix.turn)}


def _stiffness(section: Stiffness) -> dict[str, Any]:
    if section.matrix is None:
        return _with_negative("ES_z", "EI_yz")(section)
    signs = [-1.0 if i in _ODD_ROWS else 1.0 for i in range(6)]
    rows = enumerate(section.matrix)
    return {
        "matrix": tuple(
            tuple(signs[i] * signs[j] * value + 0.0 for j, value in enumerate(row))
            for i, row in rows
        )
    }


def _turns_back(coordinate: str | None) -> bool:
    """Whether an angle changes its sign; those of hinges do not, whose axis is mirrored."""
    return coordinate in ("theta_x", "theta_z")


def _exponentials(torque: DoubleExponential) -> dict[str, Any]:
    if not _turns_back(torque.coordinate):
        return {}
    ends = (torque.extension, torque.flexion)
    flexion, extension = (end.model_copy(update={"angle": _negative(end.angle)}) for end in ends)
    return {"flexion": flexion, "extension": extension, "offset": _negative(torque.offset)}


def _table(torque: TorqueTable) -> dict[str, Any]:
    if not _turns_back(torque.coordinate):
        return {}
    return {"angles": _negative(torque.angles)[::-1], "torques": _negative(torque.torques)[::-1]}


def _spastic(torque: Spastic) -> dict[str, Any]:
    if not _turns_back(torque.coordinate):
        return {}
    other = {"flexion": "extension", "extension": "flexion"}
    return {"threshold": _negative(torque.threshold), "resists": other[torque.resists]}


def _coupling(coupling: Coupling) -> dict[str, Any]:
    first, second = map(_turns_back, (coupling.first_coordinate, coupling.second_coordinate))
    return {
        "ratio": -coupling.ratio if first != second else coupling.ratio,
        "offset": _negative(coupling.offset) if second else coupling.offset,
    }


# Coordinates that change their sign, by the last part of their name.
ODD_COORDINATES = (*_ODD, "theta_x", "theta_z", "y")

_IMAGES: dict[type[Table], Callable[[Any], dict[str, Any]]] = {
    Placement: _with_negative("y"),
    Offset: _with_negative("y"),
    ForceVector: _with_negative("y"),
    Rotation: _with_negative("x", "z"),
    MomentVector: _with_negative("x", "z"),
    RevoluteJoint: lambda joint: {"axis": _axial(joint.axis)},
    PrismaticJoint: lambda joint: {"axis": _polar(joint.axis)},
    ReferenceStrain: _with_negative(*_ODD),
    Curve: _with_negative("y"),
    Lever: _with_negative("y"),
    Helix: _helix,
    Part: _with_negative("y"),
    Stiffness: _stiffness,
    HalfSpace: lambda plane: {"normal": _polar(plane.normal)},
    Capsule: lambda solid: {"axis": _polar(solid.axis)},
    Cylinder: lambda solid: {"axis": _polar(solid.axis)},
    Wrap: lambda wrap: {} if wrap.axis is None else {"axis": _polar(wrap.axis)},
    Tie: _tie,
    DoubleExponential: _exponentials,
    TorqueTable: _table,
    Spastic: _spastic,
    Coupling: _coupling,
}
