"""Calibration folders: what was asked, everything that was evaluated, and what came out.

settings.json    what decides the numbers
targets.toml     the targets file, as it was
record.sqlite    every evaluation (`Record`)
lock             held by the process that is running the calibration
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from flexor.errors import InputError, shortened

FORMAT = 1
SETTINGS = "settings.json"
TARGETS = "targets.toml"
RECORD = "record.sqlite"


def create(folder: Path, settings: Mapping[str, Any], targets: str) -> None:
    """Make a calibration folder.

    Raises
    ------
    InputError
        If the place is taken or cannot be written.
    """
    if folder.exists() and (not folder.is_dir() or any(folder.iterdir())):
        if (folder / SETTINGS).exists():
            raise InputError(
                f'"{folder}" holds a calibration already: add --resume or choose another folder.'
            )
        raise InputError(f'"{folder}" is not an empty folder: choose another.')
    try:
        folder.mkdir(parents=True, exist_ok=True)
        (folder / TARGETS).write_text(targets, encoding="utf-8")
        # Last and at once: a folder without settings is no calibration.
        draft = folder / f"{SETTINGS}.new"
        draft.write_text(json.dumps(settings, indent=2, ensure_ascii=False) + "\n", "utf-8")
        draft.replace(folder / SETTINGS)
    except OSError as error:
        why = (error.strerror or str(error)).lower()
        raise InputError(f'the folder "{folder}" cannot be made: {why}.') from error


def check_same(folder: Path, settings: Mapping[str, Any]) -> None:
    """Refuse to go on with a calibration under other settings.

    Raises
    ------
    InputError
        If the folder is no calibration, or naming the first setting that differs.
    """
    path = folder / SETTINGS
    if not path.is_file():
        what = f"it has no {SETTINGS}" if folder.is_dir() else "there is no such folder"
        raise InputError(f'"{folder}" is not a calibration: {what}.')
    try:
        kept = json.loads(path.read_text(encoding="utf-8"))
        found = kept["format"]
    except (OSError, ValueError, KeyError, TypeError, RecursionError):
        raise InputError(f'"{path}" is damaged: it is not the settings of a calibration.') from None
    if found != FORMAT:
        raise InputError(
            f'"{path}" has format {shortened(repr(found))}; this version of Flexor reads '
            f"format {FORMAT}."
        )
    for key, value in settings.items():
        if kept.get(key) != value and key != "flexor":
            raise InputError(
                f'the calibration "{folder}" was made with other {key}: resume it as it was or '
                "begin another."
            )
