"""Counts of a long run, saved after each chunk and resumed from there."""

from __future__ import annotations

import hashlib
import json
import sys
from dataclasses import asdict, fields
from pathlib import Path
from typing import Any, TypeVar

import flexor
from flexor import _engine

T = TypeVar("T")


def engine() -> str:
    """Return the version and the first digits of the hash of the compiled engine."""
    found = hashlib.sha256(Path(_engine.__file__).read_bytes()).hexdigest()
    return f"{flexor.__version__}, {found[:12]}"


def resumed(path: Path, fresh: T, same: tuple[str, ...]) -> T:
    """Return the saved counts, which must be of the same settings, or fresh ones."""
    if not path.exists():
        return fresh
    saved: dict[str, Any] = json.loads(path.read_text())
    count = type(fresh)(**{key: saved[key] for key in (f.name for f in fields(fresh))})  # type: ignore[arg-type]
    for key in same:
        if getattr(count, key) != getattr(fresh, key):
            was = getattr(count, key)
            sys.exit(f'error: "{path}" is of {key} {was}: choose another --state to start again.')
    return count


def save(path: Path, count: Any) -> None:
    """Write the counts atomically."""
    draft = path.with_name(f"{path.name}.new")
    draft.write_text(json.dumps(asdict(count), indent=1))
    draft.replace(path)
