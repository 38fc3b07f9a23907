"""Folders of several studies, one for each combination of choices or each size."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from flexor.errors import InputError, shortened
from flexor.store import check_regular

# Files that say which studies a folder has, the best first.
CHOICES, SIZES = "choices.json", "sizes.json"
_MOST = 8  # of which a message has the names


def is_choices(folder: Path) -> bool:
    """Return whether a folder holds choices."""
    return check_regular(folder / CHOICES)


def has_members(folder: Path) -> bool:
    """Return whether a folder holds several studies: choices or sizes."""
    return folder.is_dir() and (is_choices(folder) or check_regular(folder / SIZES))


def member(folder: Path, which: str | None = None) -> Path:
    """Return the folder of one of the studies in a folder of choices or sizes.

    Parameters
    ----------
    folder
        The folder.
    which
        Its folder there, such as ``"2"`` or ``"size-2"``, the number of a size, or the name of a
        combination; by default the best combination, or the size that serves most.

    Raises
    ------
    InputError
        If there is none of that name, or none is the best since the searches have not ended.
    """
    chosen = is_choices(folder)
    file = folder / (CHOICES if chosen else SIZES)
    try:
        read = json.loads(file.read_text(encoding="utf-8"))
        rows = read.get("tried" if chosen else "sizes")
        names = _names(folder, rows, chosen)
    except (OSError, ValueError, KeyError, TypeError, AttributeError):
        raise InputError(f'"{file}" cannot be read: it is damaged.') from None
    what = "combination" if chosen else "size"
    if which is None:
        if rows is None:
            raise InputError(
                f'the searches in "{folder}" have not ended: resume them by flexor optimize '
                f"--resume {folder}, or give --design, one of {', '.join(sorted(set(names)))}."
            )
        return folder / next(iter(names.values()))
    if which not in names:
        known = list(names)
        more = f" and {len(known) - _MOST} more" if len(known) > _MOST else ""
        listed = ", ".join(f'"{each}"' for each in known[:_MOST])
        raise InputError(f'"{folder}" has no {what} "{shortened(which)}": it has {listed}{more}.')
    return folder / names[which]


def _names(folder: Path, rows: Any, chosen: bool) -> Mapping[str, str]:
    """Return the studies by what they may be called, the best first."""
    if rows is None:
        begun = sorted(each.name for each in folder.iterdir() if each.name.isdigit())
        return {each: each for each in begun}
    names = {}
    for row in rows:
        study = str(row["study"])
        if Path(study).name != study:
            raise ValueError
        for name in (study, *([str(row["name"])] if chosen else [study.removeprefix("size-")])):
            names[name] = study
    return names
