"""What the commands that make studies share: where they go, and what is said if interrupted."""

from __future__ import annotations

import re
import shlex
from pathlib import Path

from flexor.cli.console import complain, err

STUDIES = Path("studies")


def free_folder(*words: str) -> Path:
    """Return a folder in `studies/` that is named after words and does not exist yet.

    Parameters
    ----------
    *words : str
        Such as model, parameter set and objective.
    """
    name = re.sub(r"[^\w.+-]", "-", "-".join(words))
    names = [name, *(f"{name}-{count}" for count in range(2, 10_000))]
    return STUDIES / next(n for n in names if not (STUDIES / n).exists())


def interrupted(place: Path | None, command: str) -> int:
    """Say how to go on, and return the exit code.

    Parameters
    ----------
    place : Path or None
        The study folder, if it was made.
    command : str
        What resumes it, up to the folder.
    """
    made = ("settings.json", "comparison.json")
    if place is None or not any((place / name).exists() for name in made):
        complain("interrupted before the first design.")
        return 130
    err.print(
        "interrupted; every design evaluated so far is kept. To go on:\n"
        f"  {command} {shlex.quote(str(place))}",
        markup=False,
        soft_wrap=True,
    )
    return 130
