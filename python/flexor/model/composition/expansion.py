"""From a file with parts to one that has their bodies and forces, with the part in their names."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from pydantic import ValidationError
from pydantic_core import PydanticCustomError

from flexor.errors import InputError, unknown_name
from flexor.materials import library
from flexor.model import variants
from flexor.model.composition.mirroring import ODD_COORDINATES, mirrored
from flexor.model.composition.naming import renamed, with_prefix
from flexor.model.composition.placing import Frame
from flexor.model.composition.scaling import scaled
from flexor.model.schema import ModelFile
from flexor.model.schema.checks import is_name
from flexor.model.schema.inclusion import Inclusion
from flexor.model.schema.material import Material, own_keys
from flexor.model.schema.table import Table
from flexor.model.validation import describe, first_error

Document = Mapping[str, Any]
Reader = Callable[[Inclusion, str], ModelFile]
MAX_PARTS = 200  # files of a model, those of parts of parts counted
MAX_DEPTH = 10  # parts of parts


def expanded(document: Document, source: str, read: Reader) -> dict[str, Any]:
    """Return a document in which the entries of its parts take the place of the parts.

    An entry ``exosuit`` of the part ``index`` is called ``index.exosuit``. What a part says about
    designs, loads, wearers, gravity and the solver is not taken over, nor are its variants, of
    which it may name one. Variants of the document that change its parts become changes of the
    entries.

    Parameters
    ----------
    document
        The tables of a model file.
    source
        Its name, for messages.
    read
        Reads and checks the file of a part; its second argument is the part's path in messages.

    Raises
    ------
    InputError
        If a part cannot be included.
    """
    sets = [document.get(table, {}) for table in variants.TABLES]
    changed = [values for each in sets if isinstance(each, Mapping) for values in each.values()]
    touched = any(isinstance(values, Mapping) and "parts" in values for values in changed)
    if "parts" not in document and not touched:
        return dict(document)
    plain = {key: value for key, value in document.items() if key not in variants.TABLES}
    base = _flat(plain, source, read)
    made = dict(base)
    for table in variants.TABLES:
        if table not in document:
            continue
        made[table] = document[table]
        if isinstance(document[table], Mapping):
            made[table] = {
                name: _variant(f"{table}.{name}", values, plain, base, source, read)
                for name, values in document[table].items()
            }
    return made


def _variant(
    path: str, values: Any, plain: Document, base: Document, source: str, read: Reader
) -> Any:
    """Return a variant as changes of the entries of parts, in place of those of the parts."""
    if not isinstance(values, Mapping) or "parts" not in values:
        return values
    if path.startswith("constants"):
        tail = "sets of constants change no parts: make it a variant"
        raise InputError(f"{source}: {path} has parts: {tail}.")
    parts, known = values["parts"], plain.get("parts", {})
    for name in parts if isinstance(parts, Mapping) else ():
        if name not in known:
            raise InputError(f"{source}: {path}.parts has an {unknown_name('part', name, known)}.")
    other = _flat(variants.merged(plain, {"parts": parts}), f"{source}: {path}", read)
    own = {key: value for key, value in values.items() if key != "parts"}
    found = variants.leading(base, other)
    if found is None:
        tail = "takes something away from a part: a variant changes values and adds fields"
        raise InputError(f"{source}: {path}.parts {tail}.")
    return variants.merged(found, own)


def _flat(document: Document, source: str, read: Reader) -> dict[str, Any]:
    made = {key: value for key, value in document.items() if key != "parts"}
    for name, part in _parts(document, source).items():
        path = f"{source}: parts.{name}"
        for table, entries in _included(name, part, read(part, path), document, path).items():
            own = made.get(table, {})
            if not isinstance(own, Mapping):
                raise InputError(f"{source}: {table} is {describe(own)}: expected a table.")
            for entry in entries:
                if entry in own:
                    tail = f'has the name of an entry of the part "{name}": rename it'
                    raise InputError(f'{source}: {table}."{entry}" {tail}.')
            made[table] = {**own, **entries}
    _check_parents(document, made, source)
    if "inputs" in made:
        made["inputs"] = _without_nesting(made["inputs"])
    return made


def _parts(document: Document, source: str) -> dict[str, Inclusion]:
    """Check the table of parts."""
    tables = document.get("parts", {})
    if not isinstance(tables, Mapping):
        raise InputError(f"{source}: parts is {describe(tables)}: expected a table of parts.")
    found = {}
    for name, table in tables.items():
        if not is_name(name):
            rule = "names start with a letter and consist of letters, digits, _ and -"
            raise InputError(f'{source}: parts contains "{name}": {rule}.')
        if name in ModelFile.model_fields or name == "parts":
            tail = "a part cannot have the name of a table of the file"
            raise InputError(f'{source}: parts contains "{name}": {tail}.')
        try:
            found[name] = Inclusion.model_validate(table)
        except ValidationError as error:
            path, tail = first_error(error, table if isinstance(table, Mapping) else {})
            path = f"parts.{name}.{path}" if path else f"parts.{name}"
            raise InputError(f"{source}: {path} {tail}.") from None
    return found


def _included(
    name: str, part: Inclusion, file: ModelFile, document: Document, path: str
) -> dict[str, dict[str, Any]]:
    """Return the entries of a part by table."""
    prefix, frame = f"{name}.", Frame.of(part.parent, part.placement)
    shared = _of_the_library(file, document.get("materials", {}))
    names = {entry for table in file.named_tables() for entry in getattr(file, table)} - shared
    made: dict[str, dict[str, Any]] = {}
    for table in file.named_tables():
        for entry, value in getattr(file, table).items():
            if table == "materials" and entry in shared:
                continue
            if isinstance(value, Table):
                value = _dumped(value, part, frame, names, prefix, f"{path}: {table}.{entry}")
            else:
                value = list(with_prefix(value, names, prefix))
            made.setdefault(table, {})[f"{prefix}{entry}"] = value
    if file.start:
        made["start"] = {
            f"{prefix}{entry}": _start(entry, value, part.mirror)
            for entry, value in file.start.items()
        }
    return made


def _dumped(
    table: Table, part: Inclusion, frame: Frame, names: set[str], prefix: str, path: str
) -> dict[str, Any]:
    table = table if part.scale == 1.0 else scaled(table, part.scale)
    table = mirrored(table) if part.mirror else table
    # References to the part's own entries first: what it is placed on is not one of these.
    table = renamed(table, names, prefix)
    try:
        table = frame.placed(table, "")
    except PydanticCustomError as error:
        raise InputError(f"{path} {error.message()}.") from None
    return table.model_dump(exclude_none=True)


def _of_the_library(file: ModelFile, own: Any) -> set[str]:
    """Return the materials that are those of the library, without a change, for all parts."""
    plain = {"library", "winding"}
    return {
        name
        for name, material in file.materials.items()
        if name in library()
        and name not in own
        and set(own_keys(material.model_dump(exclude_none=True))) <= plain
        and material.winding == Material.model_fields["winding"].default
    }


def _start(name: str, value: Any, mirror: bool) -> Any:
    if isinstance(value, Mapping):
        return {key: _start(key, each, mirror) for key, each in value.items()}
    odd = mirror and name.rpartition(".")[2].partition("[")[0] in ODD_COORDINATES
    if not odd:
        return value
    if isinstance(value, str):
        text = value.strip().removeprefix("+")
        return text[1:].strip() if text.startswith("-") else f"-{text}"
    return -value


def _check_parents(document: Document, made: Document, source: str) -> None:
    """Check that parts are attached to bodies that exist."""
    bodies = made.get("bodies", {})
    for name, table in document.get("parts", {}).items():
        parent = table.get("parent")
        if parent is not None and parent not in bodies:
            what = unknown_name("body", str(parent), bodies)
            raise InputError(f"{source}: parts.{name}.parent refers to the {what}.")


def _without_nesting(inputs: Any) -> Any:
    """Let inputs drive forces where they drive inputs of parts, which are then no longer inputs."""
    if not isinstance(inputs, Mapping):
        return inputs
    gone = {
        name
        for entry, drives in inputs.items()
        if isinstance(drives, (list, tuple))
        for name in drives
        if isinstance(name, str) and name in inputs and name != entry
    }

    def members(drives: Any, seen: frozenset[str]) -> list[Any]:
        found: list[Any] = []
        for name in drives:
            known = isinstance(name, str) and name in gone and name not in seen
            found += members(inputs[name], seen | {name}) if known else [name]
        return found

    return {
        name: members(drives, frozenset({name})) if isinstance(drives, (list, tuple)) else drives
        for name, drives in inputs.items()
        if name not in gone
    }
