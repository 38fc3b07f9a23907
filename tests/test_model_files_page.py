"""The reference of the model file lists every key with its default, and its examples work."""

from __future__ import annotations

import inspect
import re
from pathlib import Path
from typing import Any

import pytest
from pydantic_core import PydanticUndefined

import flexor
from flexor.model import Model, parse, schema
from flexor.model.schema.actuator import Actuator
from flexor.model.schema.force import Force
from flexor.model.schema.inclusion import Inclusion
from flexor.model.schema.material import Material
from flexor.model.schema.obstacle import HalfSpace
from flexor.model.schema.pressure import Pressure
from flexor.model.schema.section import KINDS
from flexor.model.schema.skin import Layer
from flexor.model.schema.solid import Ball, Box, Capsule, Cylinder
from flexor.model.schema.strain import BASES, MODES
from flexor.model.schema.table import Table
from flexor.model.schema.torque import DoubleExponential, Spastic, TorqueTable

PAGE = (Path(__file__).parent.parent / "docs" / "model-files.md").read_text(encoding="utf-8")
SECTIONS = dict(re.findall(r"^##+ (.+)\n((?:(?!##).*\n)*)", PAGE, flags=re.MULTILINE))
TABLES: dict[str, type[Table]] = {
    "Top level": schema.ModelFile,
    "Rods": schema.Rod,
    "Links": schema.Link,
    "Skins": Layer,
    "Placement": schema.Placement,
    "Parts": Inclusion,
    "Spheres": schema.SphereGroup,
    **{
        table.capitalize(): kind
        for table, kind in schema.ModelFile.named_tables().items()
        if inspect.isclass(kind) and issubclass(kind, Force)
    },
    "Materials": Material,
    "Actuators": Actuator,
    "Pressures": Pressure,
    "Design": schema.Design,
    "Evaluation": schema.Evaluation,
}


def rows(section: str) -> dict[str, list[str]]:
    """Return the cells of each key in a section's tables."""
    lines = [line for line in SECTIONS[section].splitlines() if line.startswith("| `")]
    cells = [[cell.strip() for cell in line.strip("|").split("|")] for line in lines]
    return {key.strip("`"): rest for key, *rest in cells}


def as_written(default: Any) -> str | None:
    """Return a default as TOML; None for those that the page describes in words."""
    if isinstance(default, float) and hasattr(default, "text"):
        return f'"{default.text}"'
    if isinstance(default, bool):
        return str(default).lower()
    if isinstance(default, str):
        return f'"{default}"'
    return repr(default) if isinstance(default, (int, float)) else None


@pytest.mark.parametrize("section", TABLES)
def test_every_key_is_listed_with_its_default(section: str) -> None:
    fields = TABLES[section].model_fields
    found = rows(section)
    if section == "Top level":
        found.pop("parts")  # put in their place before the file is checked
    assert list(found) == list(fields)
    for key, field in fields.items():
        documented = found[key][1]
        assert (documented == "required") == field.is_required(), key
        if field.default is not PydanticUndefined and (text := as_written(field.default)):
            assert documented == f"`{text}`", key


@pytest.mark.parametrize(
    ("section", "kinds"),
    [
        ("Obstacles", (HalfSpace, Ball, Capsule, Cylinder, Box)),
        ("Torques", (DoubleExponential, TorqueTable, Spastic)),
    ],
)
def test_every_key_of_kinds_is_listed_with_its_default(
    section: str, kinds: tuple[type[Table], ...]
) -> None:
    found = rows(section)
    keys: set[str] = set()
    for kind in kinds:
        keys |= kind.model_fields.keys()
        for key, field in kind.model_fields.items():
            documented = found[key][1]
            assert documented.startswith("required") == field.is_required(), key
            if field.default is not PydanticUndefined and (text := as_written(field.default)):
                assert documented == f"`{text}`", key
    assert set(found) == keys


def test_joints() -> None:
    found = rows("Joints")
    for kind, column in ((schema.RevoluteJoint, 1), (schema.PrismaticJoint, 3)):
        for key, field in kind.model_fields.items():
            if text := as_written(field.default):
                assert found[key][column] == f"`{text}`", key
            assert key == "kind" or key in found
    for key in (*schema.FreeJoint.model_fields, "universal", "spherical", "prismatic"):
        assert f"`{key}`" in SECTIONS["Joints"] or f'`"{key}"`' in SECTIONS["Joints"]


def test_modes_bases_and_sections() -> None:
    for name in (*MODES, *BASES):
        assert f"`{name}`" in SECTIONS["Strain"]
    for kind in KINDS:
        assert f'`"{kind}"`' in SECTIONS["Sections"]


def test_its_model_is_valid() -> None:
    (text,) = re.findall(r"```toml\n(.*?)```", PAGE, flags=re.DOTALL)
    model = Model(parse(text))
    path = model.equilibrium("0:5:1")
    assert path.stable.all()
    assert path.joint_angles[-1, 0] > 0.1
    assert flexor.optimize(model, "L+R01", budget=5).evaluations == 5
    (sets,) = re.findall(r"```\n(use = .*?)```", PAGE, flags=re.DOTALL)
    head, tables = text.split("[bodies.suit]", 1)
    use, constants = sets.split("\n\n", 1)
    both = f"{head}{use}\n\n[bodies.suit]{tables}\n{constants}"
    assert Model(parse(both)).slot("suit.young_modulus").tolist() == [1e5]
    assert Model(parse(both, use="stiff")).slot("suit.young_modulus").tolist() == [3e5]


def test_its_python_example_runs() -> None:
    (code,) = re.findall(r"```python\n(.*?)```", PAGE, flags=re.DOTALL)
    exec(compile(code, "model-files.md", "exec"), {})


def test_its_links_resolve() -> None:
    headings = {re.sub(r"[^\w -]", "", name).lower().replace(" ", "-") for name in SECTIONS}
    assert set(re.findall(r"\]\(#([^)]+)\)", PAGE)) <= headings
