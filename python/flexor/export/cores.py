"""Cores of a mould: how each is pulled out of the body, and the ends by which it is held."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexor.arrays import Array
from flexor.errors import InputError
from flexor.export.body import Body, void
from flexor.export.chambers import Chamber
from flexor.export.solids import Solid, extruded, united


@dataclass(frozen=True, eq=False)
class Core:
    """The core of a chamber.

    Attributes
    ----------
    name : str
        Of its part.
    solid : Manifold
        It, with the ends by which it is held [mm].
    ends : dict
        Outline of the end at the ``"base"`` and at the ``"tip"``, as far as it reaches them.
    pull : str
        The end towards which it is pulled.
    stretch : float
        By how much the silicone is stretched then, along the circumference.
    place : float
        Where the widest part of the core is that passes a narrower one, X.
    """

    name: str
    solid: Solid
    ends: dict[str, Array]
    pull: str
    stretch: float
    place: float


def cores(body: Body, hold: float, limit: float) -> list[Core]:
    """Return the cores of all chambers.

    Parameters
    ----------
    body
        The body.
    hold
        Length of the ends by which they are held [mm].
    limit
        Largest stretch of the silicone when one is pulled.

    Raises
    ------
    InputError
        If a chamber reaches no end of the body, or its core cannot be pulled.
    """
    return [_core(body, each, hold, limit) for each in body.chambers]


def _core(body: Body, chamber: Chamber, hold: float, limit: float) -> Core:
    label = chamber.pressure or chamber.cavity
    ends, solids = {}, void(chamber, body.parts)
    if chamber.low <= 1e-9:
        ends["base"] = body.parts[0].cavities[chamber.cavity][0]
        solids.append(extruded(ends["base"], -hold, 0.0))
    if chamber.high >= body.length - 1e-9:
        ends["tip"] = body.parts[-1].cavities[chamber.cavity][-1]
        solids.append(extruded(ends["tip"], body.length, body.length + hold))
    if not ends:
        raise InputError(
            f'the hollow of "{label}" from X = {chamber.low / body.length:.3g} to '
            f"{chamber.high / body.length:.3g} reaches neither end of the rod: its core cannot be "
            "pulled out, so that the body cannot be cast at once."
        )
    x, around = _circumference(body, chamber)
    ways = {}
    for end in ends:
        order = slice(None) if end == "base" else slice(None, None, -1)
        narrowest = np.minimum.accumulate(around[order])[order]
        ratio = around / narrowest - 1.0
        ways[end] = (float(ratio.max()), float(x[int(ratio.argmax())] / body.length))
    pull = min(ways, key=lambda end: ways[end][0])
    stretch, place = ways[pull]
    if stretch > limit:
        raise InputError(
            f'the core of "{label}" has an undercut at X = {place:.3g}: to pull it out at the '
            f"{pull}, the silicone would be stretched by {100.0 * stretch:.3g} %, more than the "
            f"{100.0 * limit:.3g} % of --stretch."
        )
    return Core(f"core-{label}", united(solids), ends, pull, stretch, place)


def _circumference(body: Body, chamber: Chamber) -> tuple[Array, Array]:
    """Return places along a chamber [mm] and the circumference of its core there [mm]."""
    places, lengths = [], []
    for part in body.parts:
        low, high = max(chamber.low, part.x[0]), min(chamber.high, part.x[-1])
        if not high > low + 1e-9 or chamber.cavity not in part.cavities:
            continue
        x, outlines = part.between(part.cavities[chamber.cavity], low, high)
        places.append(x)
        lengths.append(np.linalg.norm(np.roll(outlines, -1, axis=1) - outlines, axis=2).sum(axis=1))
    return np.concatenate(places), np.concatenate(lengths)
