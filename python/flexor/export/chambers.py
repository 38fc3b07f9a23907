"""Chambers along a rod: where a cavity is hollow, what closes it, and where its tube enters."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexor.arrays import Array
from flexor.export.device import Device
from flexor.export.outlines import Segment

Interval = tuple[float, float]


@dataclass(frozen=True)
class Chamber:
    """A hollow part of the rod.

    Attributes
    ----------
    cavity : str
        Its name in the section.
    low, high : float
        Its ends [mm].
    pressure : str or None
        The pressure that acts in it; None if it is open to the air.
    """

    cavity: str
    low: float
    high: float
    pressure: str | None


def chambers(device: Device, parts: list[Segment], cap: float) -> list[Chamber]:
    """Return the chambers of a device.

    Where a pressure ends within a hollow, a wall of the thickness `cap` [mm] closes it, outside of
    its span: what the pressure does not reach stays hollow, as in the mechanics.
    """
    size = parts[-1].x[-1]
    found = []
    for cavity, run in _runs(parts):
        spans = sorted(
            (max(span[0] * size, run[0]), min(span[1] * size, run[1]), name)
            for name, (own, span) in device.pressures().items()
            if own == cavity and span[0] * size < run[1] and span[1] * size > run[0]
        )
        found += _divided(cavity, run, spans, cap)
    return found


def _runs(parts: list[Segment]) -> list[tuple[str, Interval]]:
    """Return from where to where each cavity goes on from segment to segment [mm]."""
    found: list[tuple[str, Interval]] = []
    begun: dict[str, float] = {}
    for index, part in enumerate(parts):
        for name in part.cavities:
            begun.setdefault(name, float(part.x[0]))
            after = parts[index + 1].cavities if index + 1 < len(parts) else {}
            if name not in after:
                found.append((name, (begun.pop(name), float(part.x[-1]))))
    return found


def _divided(
    cavity: str, run: Interval, spans: list[tuple[float, float, str]], cap: float
) -> list[Chamber]:
    """Cut a run into chambers, with walls between those of different pressure."""
    begin, open_from, found = run[0], None, []
    hollow: list[tuple[float, float, str | None]] = []
    for low, high, name in spans:
        gap = low - begin
        if open_from is None:  # before the first pressure
            if gap > cap:
                hollow.append((begin, low - cap, None))
        elif gap > 2.0 * cap:
            hollow.append((begin + cap, low - cap, None))
        elif gap < cap:  # half of the wall is taken from either chamber
            half = 0.5 * (cap - gap)
            last = hollow[-1]
            hollow[-1] = (last[0], last[1] - half, last[2])
            low += half
        hollow.append((low, high, name))
        begin = open_from = high
    if not spans:
        hollow.append((run[0], run[1], None))
    elif run[1] - begin > cap:
        hollow.append((begin + cap, run[1], None))
    found = [Chamber(cavity, low, high, name) for low, high, name in hollow if high > low]
    return found


def closed_ends(device: Device, hollows: list[Chamber], size: float, cap: float) -> list[bool]:
    """Return whether a cap closes the base, and the tip: where a pressure reaches nearly there."""
    pressed = [each for each in hollows if each.pressure is not None]
    return [
        any(each.low < cap for each in pressed),
        any(each.high > size - cap for each in pressed),
    ]


def widest_place(outline: Array) -> tuple[Array, float]:
    """Return the centre and radius of the largest circle within a polygon (m, 2), nearly."""
    low, high = outline.min(axis=0), outline.max(axis=0)
    y, z = (np.linspace(low[i], high[i], 41)[1:-1] for i in (0, 1))
    points = np.stack(np.meshgrid(y, z), axis=-1).reshape(-1, 2)
    points = points[contains(outline, points)]
    distance = distances(points, outline).min(axis=1)
    # The one in the middle of several.
    best = points[distance > distance.max() - 1e-6]
    centre = best[np.linalg.norm(best - best.mean(axis=0), axis=1).argmin()]
    return centre, float(distance.max())


def contains(outline: Array, points: Array) -> Array:
    """Whether points (n, 2) are inside a polygon (m, 2); shape (n,)."""
    a, b = outline, np.roll(outline, -1, axis=0)
    y, z = points[:, None, 0], points[:, None, 1]
    crosses = (a[:, 1] > z) != (b[:, 1] > z)
    with np.errstate(divide="ignore", invalid="ignore"):
        at = a[:, 0] + (z - a[:, 1]) / (b[:, 1] - a[:, 1]) * (b[:, 0] - a[:, 0])
    return np.asarray(np.sum(crosses & (y < at), axis=1) % 2 == 1)


def distances(points: Array, outline: Array) -> Array:
    """Distances of points (n, 2) from the m sides of a polygon (m, 2), (n, m)."""
    a = outline
    side = np.roll(outline, -1, axis=0) - a
    squared = np.maximum((side**2).sum(axis=1), 1e-300)
    offset = points[:, None] - a
    share = np.clip((offset * side).sum(axis=2) / squared, 0.0, 1.0)
    return np.asarray(np.linalg.norm(offset - share[..., None] * side, axis=2))
