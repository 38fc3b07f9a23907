"""Whom a size serves, as the folder of its search says."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from flexor.errors import InputError
from flexor.store import check_regular
from flexor.study.members import SIZES

if TYPE_CHECKING:
    from flexor.study.study import Study


@dataclass(frozen=True)
class Served:
    """Whom one of several sizes serves."""

    size: int  # its number, from 1
    sizes: int  # how many there are
    wearers: tuple[str, ...]  # their names
    share: float  # of all wearers, by weight
    together: float  # share that all sizes serve

    @property
    def sentence(self) -> str:
        """Return it as a sentence."""
        number = len(self.wearers)
        whom = f"{number} wearer{'s' if number != 1 else ''}, {_percent(self.share)} of all"
        of_all = f"; the {self.sizes} sizes together serve {_percent(self.together)}"
        return f"Size {self.size} serves {whom}{of_all if self.sizes > 1 else ''}."


def served(study: Study) -> Served | None:
    """Return whom a study's design serves; None if it is no size.

    Parameters
    ----------
    study
        A study, such as one of the folder of `flexor.sizes`.

    Raises
    ------
    InputError
        If the file that says it is damaged.
    """
    place = None if study.folder is None else Path(study.folder).resolve()
    file = None if place is None else place.parent / SIZES
    if place is None or file is None or not check_regular(file):
        return None
    try:
        found = json.loads(file.read_text(encoding="utf-8"))
        rows = {str(row["study"]): row for row in found["sizes"]}
        if place.name not in rows:
            return None
        weights = {name: float(row["weight"]) for name, row in rows.items()}
        names = tuple(str(each) for each in rows[place.name]["wearers"])
        together, total = float(found["served"]), sum(weights.values())
        share = weights[place.name] / total * together if total else 0.0
        number = int(place.name.removeprefix("size-"))
    except (OSError, ValueError, KeyError, TypeError, AttributeError):
        raise InputError(f'"{file}" cannot be read: it is damaged.') from None
    return Served(number, len(rows), names, share, together)


def _percent(share: float) -> str:
    return f"{100.0 * share:.0f} %"
