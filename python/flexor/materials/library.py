"""The library of materials that is shipped with Flexor.

`fitted.toml` is written by ``./dev fit-materials``, from tensile tests; `published.toml` holds
constants from papers and data sheets. Both are in SI units.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Mapping
from functools import cache
from pathlib import Path
from typing import Any

from flexor.errors import unknown
from flexor.materials.material import KINDS, Material

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

FITTED = Path(__file__).with_name("fitted.toml")
PUBLISHED = Path(__file__).with_name("published.toml")


@cache
def library() -> Mapping[str, Material]:
    """Return the materials by name."""
    tables: dict[str, dict[str, Any]] = {}
    for file in (FITTED, PUBLISHED):
        tables |= tomllib.loads(file.read_text(encoding="utf-8"))
    return {name: _material(name, table) for name, table in tables.items()}


def find(name: str) -> Material:
    """Return a material of the library.

    Raises
    ------
    InputError
        If there is none of this name.
    """
    materials = library()
    if name not in materials:
        raise unknown("material", name, materials)
    return materials[name]


def _material(name: str, table: dict[str, Any]) -> Material:
    constants = {key: table[key] for key in KINDS[table["kind"]] if key in table}
    return Material(
        name,
        table["kind"],
        {key: tuple(v) if isinstance(v, list) else v for key, v in constants.items()},
        density=table["density"],
        strain_limit=table.get("strain_limit", math.inf),
        stress_limit=table.get("stress_limit", math.inf),
        stretch_range=_range(table.get("stretch_range")),
        title=table["title"],
        source=table["source"],
    )


def _range(ends: list[float] | None) -> tuple[float, float] | None:
    return None if ends is None else (float(ends[0]), float(ends[1]))
