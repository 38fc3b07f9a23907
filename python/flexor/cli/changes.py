"""Model files with some fields changed on the command line."""

from __future__ import annotations

import sys
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from flexor.cli.values import assignments
from flexor.errors import unknown

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

if TYPE_CHECKING:
    from flexor.model import Model

# Tables whose entries may be named without the table: exosuit.length is bodies.exosuit.length.
_NAMED = ("bodies", "contacts", "actuators", "springs", "wrenches", "spheres")


def load_changed(model: str, constants: str | None, changes: list[str]) -> Model:
    """Load a model with some of its fields changed.

    Parameters
    ----------
    model : str
        Model file or preset.
    constants : str or None
        Which set of constants to use, if not the file's own choice.
    changes : list of str
        Such as `["exosuit.length=8 cm"]`.

    Returns
    -------
    Model
        The changed model.

    Raises
    ------
    InputError
        If there is no such model or field, or the value cannot be used.
    """
    from flexor.model import Model, load, parse

    loaded = load(model, constants)
    wanted = assignments("--set", changes, "exosuit.length=8 cm")
    if not wanted:
        return loaded
    import tomli_w

    document = tomllib.loads(loaded.file.to_toml())
    chosen = document.get("constants", {}).get(document.get("use"), {})
    for key, text in wanted.items():
        parts = _whole(document, key.split("."))
        # The set of constants in force would put its own value back.
        for table in (chosen, document) if _has(chosen, parts) else (document,):
            _put(table, parts, _value(text))
    return Model(parse(tomli_w.dumps(document), source=model), source=model)


def _whole(document: Mapping[str, Any], parts: list[str]) -> list[str]:
    if len(parts) > 1 and parts[0] not in document:
        for table in _NAMED:
            if parts[0] in document.get(table, {}):
                return [table, *parts]
    return parts


def _has(table: Any, parts: list[str]) -> bool:
    for part in parts:
        if not isinstance(table, Mapping) or part not in table:
            return False
        table = table[part]
    return True


def _put(table: dict[str, Any], parts: list[str], value: object) -> None:
    for depth, part in enumerate(parts[:-1]):
        below = table.get(part)
        if not isinstance(below, dict):
            known = [name for name, entry in table.items() if isinstance(entry, dict)]
            if depth == 0:
                known += [name for group in _NAMED for name in table.get(group, {})]
            raise unknown(f"table in --set {'.'.join(parts)}", part, known)
        table = below
    table[parts[-1]] = value


def _value(text: str) -> object:
    try:
        return tomllib.loads(f"value = {text}")["value"]
    except tomllib.TOMLDecodeError:
        return text
