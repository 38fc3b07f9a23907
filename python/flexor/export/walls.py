"""The thinnest walls of a body, and the thinnest places of its cores."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexor.arrays import Array
from flexor.errors import InputError
from flexor.export.body import Body
from flexor.export.chambers import distances
from flexor.export.device import MM


@dataclass(frozen=True)
class Thinnest:
    """A thin place.

    Attributes
    ----------
    what : str
        Such as ``"the wall of the cavity bore"``.
    size : float
        Its thickness [mm].
    x : float
        X in [0, 1].
    """

    what: str
    size: float
    x: float


def thinnest(body: Body) -> list[Thinnest]:
    """Return the thinnest place of each wall and of each core, in the order of the cavities."""
    found: dict[str, Thinnest] = {}

    def note(what: str, size: float, x: float) -> None:
        if what not in found or size < found[what].size:
            found[what] = Thinnest(what, size, x / body.length)

    for part in body.parts:
        names = list(part.cavities)
        for row, x in enumerate(part.x):
            outer = part.outer[row]
            for index, name in enumerate(names):
                hole = part.cavities[name][row]
                note(f'the wall around the cavity "{name}"', _apart(hole, outer), x)
                note(f'the core of the cavity "{name}"', float(np.ptp(hole, axis=0).min()), x)
                for other in names[index + 1 :]:
                    between = f'the wall between the cavities "{name}" and "{other}"'
                    note(between, _apart(hole, part.cavities[other][row]), x)
            if not names:
                note("the body", float(np.ptp(outer, axis=0).min()), x)
    return list(found.values())


def check_walls(body: Body, least: float) -> None:
    """Check that all walls and cores can be made.

    Parameters
    ----------
    body
        The body.
    least
        Smallest thickness [m].

    Raises
    ------
    InputError
        Naming the thinnest.
    """
    worst = min(thinnest(body), key=lambda each: each.size)
    if worst.size < MM * least * (1.0 - 1e-9):
        raise InputError(
            f"{body.device.source} cannot be cast: {worst.what} is {worst.size:.3g} mm thick at "
            f"X = {worst.x:.3g}, less than the {MM * least:.3g} mm of --least-wall."
        )


def _apart(first: Array, second: Array) -> float:
    return float(min(distances(first, second).min(), distances(second, first).min()))
