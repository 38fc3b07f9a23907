"""``settings.json``: everything that determines the results of a piece of work."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from datetime import datetime, timezone
from pathlib import Path
from typing import Any

from pydantic import BaseModel, ConfigDict, ValidationError

from flexor.errors import InputError, shortened
from flexor.store.environment import DECISIVE, MINOR, environment, installed
from flexor.store.files import check_regular, reason, write_text

FORMAT = 3
SETTINGS = "settings.json"
# May differ when work is resumed; `check_versions` compares the versions.
_FREE = ("created", "flexor", "environment")
_NAMES = {
    "flexor": "Flexor",
    "engine": "another build of the engine",
    "engine_path": "another build of the engine path",
    "python": "Python",
}


class Header(BaseModel):
    """Settings common to every kind of work; a kind adds its own."""

    model_config = ConfigDict(extra="forbid", strict=True)

    format: int
    kind: str
    flexor: str
    environment: dict[str, str]
    created: str


@dataclass(frozen=True)
class Kind:
    """A kind of work."""

    name: str  # for example "study"
    schema: type[Header]  # the shape of its settings
    tables: str  # SQL that makes the tables of its record
    free: tuple[str, ...] = ()  # settings that may differ when it is resumed
    growing: tuple[str, ...] = ()  # mappings and lists that may grow when it is resumed
    # Settings that are hashes of something, and what to call it if another is given.
    hashed: Mapping[str, str] = field(default_factory=dict)


def new_settings(kind: Kind, values: Mapping[str, Any]) -> dict[str, Any]:
    """Return the settings of work that begins now, as plain JSON values."""
    header = {
        "format": FORMAT,
        "kind": kind.name,
        "flexor": installed("flexor"),
        "environment": environment(),
        "created": datetime.now(timezone.utc).isoformat(timespec="seconds"),
    }
    plain: dict[str, Any] = json.loads(json.dumps({**header, **values}))
    return plain


def read_settings(kind: Kind, folder: Path, *others: Kind) -> dict[str, Any]:
    """Read the settings of a folder of this kind, or one of ``others`` of the same shape."""
    path = folder / SETTINGS
    if not check_regular(path):
        what = "there is no such folder"
        if (folder / "comparison.json").exists():  # until format 1
            raise _unreadable(folder / "comparison.json", 1)
        if folder.exists():
            what = f"it has no {SETTINGS}" if folder.is_dir() else "it is a file"
        raise InputError(f'"{folder}" is not a {kind.name}: {what}.')
    try:
        values = json.loads(path.read_text(encoding="utf-8"))
        found, named = values["format"], values.get("kind")
        # JSON can contain lone surrogates, which UTF-8 cannot encode.
        json.dumps(values, ensure_ascii=False).encode("utf-8")
    except OSError as error:
        raise InputError(f'"{path}" cannot be read: {reason(error)}.') from error
    except (ValueError, KeyError, TypeError, AttributeError, RecursionError):
        raise _damaged(kind, path) from None
    if found != FORMAT:
        raise _unreadable(path, found)
    if isinstance(named, str) and named not in {each.name for each in (kind, *others)}:
        raise InputError(f'"{folder}" is not a {kind.name}: it is a {shortened(named)}.')
    try:
        kind.schema.model_validate(values)
    except (ValidationError, OverflowError):
        raise _damaged(kind, path) from None
    return dict(values)


def write_settings(folder: Path, values: Mapping[str, Any]) -> None:
    """Write the settings of a folder; existing ones are kept if that fails."""
    write_text(folder / SETTINGS, json.dumps(values, indent=2, ensure_ascii=False) + "\n")


def merged(
    kind: Kind, folder: Path, kept: Mapping[str, Any], wanted: Mapping[str, Any]
) -> dict[str, Any]:
    """Return the settings to resume with: those kept, grown and freely changed as wanted."""
    result = dict(kept)
    for key in {**kept, **wanted}:
        old, new = kept.get(key), wanted.get(key)
        if key in kind.free:
            result[key] = new
        elif key in kind.growing and isinstance(old, Mapping) and isinstance(new, Mapping):
            common = {name: new[name] for name in new if name in old}
            _check_same(kind, folder, {key: {name: old[name] for name in common}}, {key: common})
            result[key] = {**old, **new}
        elif key in kind.growing and isinstance(old, list) and isinstance(new, list):
            result[key] = sorted({*old, *new})
        elif key not in _FREE:
            _check_same(kind, folder, {key: old}, {key: new})
    return result


def check_versions(
    kind: Kind, folder: Path, kept: Mapping[str, Any], packages: Iterable[str]
) -> None:
    """Refuse to resume work of another version of what decides its bits.

    That is Flexor, its engine, the minor versions of Python and NumPy, and the ``packages`` that
    this work uses.
    """
    made = {"flexor": kept["flexor"], **kept["environment"]}
    here = {"flexor": installed("flexor"), **environment()}
    for key in dict.fromkeys(("flexor", *DECISIVE, *MINOR, *packages)):
        then, now = made.get(key), here[key]
        if then is None or (_minor(then) != _minor(now) if key in MINOR else then != now):
            name = _NAMES.get(key, key)
            then = "(not recorded)" if then is None else shortened(then)
            raise InputError(
                f'the {kind.name} "{folder}" was made with {name} {then}, this is {now}: resume it '
                "with that one, or start a new one."
            )


def _minor(version: str) -> list[str]:
    return version.split(".")[:2]


def _check_same(
    kind: Kind, folder: Path, kept: Mapping[str, Any], wanted: Mapping[str, Any]
) -> None:
    mine, theirs = dict(_flat(kept)), dict(_flat(wanted))
    for key in {**mine, **theirs}:
        old, new = mine.get(key), theirs.get(key)
        if old != new:
            called = kind.hashed.get(key, kind.hashed.get(key.split(".")[0]))
            how = called or f"{key} = {_shown(old)}, not {_shown(new)}"
            raise InputError(
                f'the {kind.name} "{folder}" was made with {how}: resume it unchanged, or '
                "start a new one."
            )


def _flat(values: Mapping[str, Any], above: str = "") -> Iterator[tuple[str, Any]]:
    for key, value in values.items():
        if isinstance(value, Mapping):
            yield from _flat(value, f"{above}{key}.")
        else:
            yield f"{above}{key}", value


def _shown(value: Any) -> str:
    text = "nothing" if value is None else json.dumps(value, ensure_ascii=False)
    return text if len(text) <= 60 else f"{text[:57]}..."


def _damaged(kind: Kind, path: Path) -> InputError:
    return InputError(f'"{path}" is damaged: it is not the settings of a {kind.name}.')


def _unreadable(path: Path, found: object) -> InputError:
    return InputError(
        f'"{path}" has format {shortened(repr(found))}; this version of Flexor reads '
        f"format {FORMAT}: use the version that made it, or start a new one."
    )
