"""The independent components of a model as models of their own files.

`flexor.model.components` divides the description of a model; here its file is divided alike, so
that a component can be lowered by itself with other values of its fields.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from flexor.model.components import components, texts
from flexor.model.schema import ModelFile
from flexor.model.schema.design import Evaluation
from flexor.model.schema.force import Force
from flexor.model.structure import Structure

Entries = Mapping[str, Collection[str]]  # names of entries by table
_EMPTY: dict[str, Any] = {
    "inputs": {},
    "start": {},
    "constants": {},
    "variants": {},
    "use": None,
    "design": None,
    "population": None,
    "evaluation": Evaluation(),
}


@dataclass(frozen=True, eq=False)
class Restricted:
    """Some components of a model.

    Attributes
    ----------
    entries : dict
        Names of their entries, by table.
    model : Structure
        The model that consists of these.
    slots : (P,) array
        The whole model's parameter of each of its own.
    """

    entries: Entries
    model: Structure
    slots: NDArray[np.intp]


def entries_of_components(model: Structure) -> list[dict[str, set[str]]]:
    """Return the entries of each independent component; none if there is only one.

    Bodies that are fixed in the world are in each that refers to them, materials in those whose
    bodies are made of them.
    """
    return [_entries(model.file, part) for part in components(model.description)]


def restricted(model: Structure, entries: Entries) -> Restricted | None:
    """Return the model of some entries; None if it is not a part of the whole."""
    file = _file(model.file, entries)
    try:
        found = Structure(file)
    except ValueError:  # an `InputError` is one
        return None
    slots = np.empty(found.parameters.size, dtype=np.intp)
    for name, (start, stop) in found.engine.slots.items():
        first, last = model.engine.slots.get(name, (0, 0))
        if last - first != stop - start:
            return None
        slots[start:stop] = np.arange(first, last)
    same = (found.parameters == model.parameters[slots]).all()
    return Restricted(entries, found, slots) if same else None


def together(model: Structure, parts: Sequence[Entries]) -> dict[str, set[str]]:
    """Return the entries of several components."""
    found: dict[str, set[str]] = {table: set() for table in model.file.named_tables()}
    for part in parts:
        for table, names in part.items():
            found[table] |= set(names)
    return found


def _entries(file: ModelFile, part: Mapping[str, Any]) -> dict[str, set[str]]:
    lists = {
        key: {each["name"] for each in entries if "name" in each}
        for key, entries in part.items()
        if isinstance(entries, list) and entries and isinstance(entries[0], Mapping)
    }
    found: dict[str, set[str]] = {table: set() for table in file.named_tables()}
    found["bodies"] = lists["bodies"]
    found["spheres"] = lists.get("spheres", set()) & file.spheres.keys()
    for table, name, force in file.entries(Force):  # type: ignore[type-abstract]
        if name in lists.get(force.listed(), ()):
            found[table].add(name)
    made_of = {text for name in found["bodies"] for text in texts(file.bodies[name].model_dump())}
    found["materials"] = made_of & file.materials.keys()
    return found


def _file(file: ModelFile, entries: Entries) -> ModelFile:
    tables: dict[str, Any] = dict(_EMPTY)
    for table in file.named_tables():
        if table not in ("materials", "inputs"):  # fibres number all materials
            own = getattr(file, table)
            tables[table] = {name: each for name, each in own.items() if name in entries[table]}
    for name, obstacle in tables["obstacles"].items():
        if obstacle.spheres is not None:
            groups = tuple(each for each in obstacle.spheres if each in entries["spheres"])
            tables["obstacles"][name] = obstacle.model_copy(update={"spheres": groups})
    return file.model_copy(update=tables)
