"""Every number of a model file can be a design variable, or it is said here why not."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import BaseModel

import flexor
from flexor.design import variables
from flexor.design.fields import value_of
from flexor.errors import InputError
from flexor.model import Model, parse
from flexor.model.quantity import infer_quantity

EVERYTHING = Path(__file__).parents[1] / "model" / "everything.toml"
EXAMPLES = ("pneumatic-finger", "muscle-finger", "capstan", "four-bar", "elbow", "tendon-glove")
# Tables that are no part of what is made or worn.
OTHER = {"design", "population", "evaluation", "start", "solver", "constants", "variants"}
MORE = """
[torques.passive]
kind = "double-exponential"
body = "tool"
coordinate = "theta_y"
flexion = { moment = "1 N*mm", rate = 3.0, angle = "40 deg" }
extension = { moment = "1 N*mm", rate = 3.0, angle = "-20 deg" }
offset = "0.1 N*mm"

[torques.measured]
kind = "table"
body = "tool"
coordinate = "theta_z"
angles = ["-30 deg", "0 deg", "30 deg"]
torques = ["-2 N*mm", "0.1 N*mm", "2 N*mm"]

[torques.reflex]
kind = "spastic"
body = "tool"
coordinate = "theta_y"
threshold = "10 deg"
stiffness = "0.1 N*m/rad"

[couplings.together]
first = "tool"
second = "tool"
first_coordinate = "theta_y"
second_coordinate = "theta_z"
ratio = 0.7
stiffness = "0.1 N*m/rad"

[tendons.passed]
kind = "spring"
stiffness = "10 N/m"
slack_length = "3 cm"
friction = 0.1
slip_stiffness = "5 N/mm"
path = [
  { world = { z = "10 cm" } },
  { body = "hand", at = "tip", offset = { z = "1 cm" } },
  { body = "tool", at = "tip", offset = { z = "1 cm" } },
]
"""
# By the table and the field, with what is said.
FIXED = "fixed when the model is made|planar system"
REFUSED = {
    # Directions.
    "RevoluteJoint.axis": FIXED,
    "PrismaticJoint.axis": FIXED,
    "HalfSpace.normal": f"{FIXED}|no effect",
    "Cylinder.axis": FIXED,
    "Wrap.axis": FIXED,
    "Tie.axis": FIXED,
    "Tie.rotation.Rotation.y": f"{FIXED}|no effect",
    # Curves of muscles, and what tendons give in guides.
    "Thelen.width": FIXED,
    "Thelen.passive_shape": FIXED,
    "Thelen.passive_strain": FIXED,
    "SpringTendon.toe": FIXED,
    "SpringTendon.slip_stiffness": FIXED,
    "TorqueTable.angles": FIXED,
    # Made once for the model: the mesh, the share of the tip, self-contact.
    "Rod.tip": "no effect",
    "Layer.modulus": "no effect",
    # Compared with results only.
    "Material.strain_limit": "no effect",
    "Material.stress_limit": "no effect",
}


def _numbers(node: Any, keys: tuple[str, ...], table: str) -> Iterator[tuple[str, tuple[str, ...]]]:
    """Yield what each number of a file is, and its keys."""
    if isinstance(node, BaseModel):
        kind = type(node).__name__
        for name in type(node).model_fields:
            place = f"{table}.{kind}" if kind in ("Offset", "Rotation", "Gravity") else kind
            yield from _numbers(getattr(node, name), (*keys, name), f"{place}.{name}")
    elif isinstance(node, dict):
        for name, value in node.items():
            yield from _numbers(value, (*keys, name), table)
    elif isinstance(node, tuple):
        for i, value in enumerate(node):
            yield from _numbers(value, (*keys, str(i)), table)
    elif isinstance(node, float):
        yield table, keys


def _bounds(keys: tuple[str, ...], model: Model) -> tuple[object, object]:
    """Return bounds 1 % around a value, beside it where it is a share."""
    own = value_of(keys, model.file)
    value = float(own)
    _, unit = infer_quantity(getattr(own, "text", own), ".".join(keys))
    around = 0.01 * abs(value) or 1e-3
    high = value if value in (0.5, 1.0) else value + around
    low = value if value == 0.0 else value - around
    return unit.exact(low), unit.exact(high)


def test_every_number_is_a_variable_or_it_is_said_why_not() -> None:
    """Each by itself in some model, with the parameters of the changed file."""
    text = (
        EVERYTHING.read_text(encoding="utf-8").replace(
            "self_contact = true", "self_contact = false"
        )
        + MORE
    )
    made, refused = set[str](), dict[str, str]()
    for model in (Model(parse(text)), *map(flexor.load, EXAMPLES)):
        for table in type(model.file).model_fields:
            for what, keys in _numbers(getattr(model.file, table), (table,), table):
                if table in OTHER or what in made or (model.planar and _is_across(keys)):
                    continue
                why = _refusal(keys, model)
                if why:
                    refused[what] = why
                else:
                    made.add(what)
    said = {what: why for what, why in refused.items() if what not in made}
    unknown = [
        f"{what}: {why}"
        for what, why in said.items()
        if not re.search(REFUSED.get(what, "^$"), why)
    ]
    assert not unknown, "\n".join(unknown)
    assert sorted(REFUSED.keys() & made) == []


def _refusal(keys: tuple[str, ...], model: Model) -> str:
    """Return why a number cannot be varied; empty if it can, and its values are right."""
    label, own = ".".join(keys), float(value_of(keys, model.file))
    try:
        chosen = variables({label: _bounds(keys, model)}, model)
        prepared = chosen.prepared(model)
        found, _ = chosen.designs(chosen.upper[None, :], prepared)
        expected = flexor.load(prepared.file, changes=chosen.changes(chosen.upper)).parameters
    except InputError as error:
        return "" if own == 0.0 and "it is zero in the file" in str(error) else str(error)
    assert found.indices.size > 0, label
    if len(expected) == len(prepared.parameters):
        actual = prepared.parameters.copy()
        actual[found.indices] = found.values[0]
        np.testing.assert_allclose(actual, expected, rtol=1e-8, atol=1e-13, err_msg=label)
    return ""


def _is_across(keys: tuple[str, ...]) -> bool:
    """Whether a component of a vector leaves the plane, or turns in another."""
    if len(keys) < 2 or keys[-1] not in "xyz":
        return False
    turns = keys[-2] in ("rotation", "moment")
    return (keys[-1] == "y") != turns
