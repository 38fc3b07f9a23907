"""The drawable state of a model at one load: bodies, lines, contact forces and marks."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from flexor.arrays import Array
from flexor.plot.style import CHAMBER

# Of models up to a width of USUAL [cm], beyond in proportion.
LONGEST_ARROW = 1.8  # cm
HIGHEST = 0.9  # cm, of pressures
USUAL = 16.0


@dataclass(frozen=True)
class Band:
    """A part of a rod, or a cavity, in its plane."""

    name: str  # of the material, or that it is a cavity
    low: Array  # (m,): where it begins above the axis [m]; NaN where it is not
    high: Array  # (m,): where it ends


@dataclass(frozen=True)
class Pressure:
    """The pressure of contact along the underside of a rod."""

    points: Array  # (m, 3) [m]
    down: Array  # (m, 3): the direction in which it acts
    values: Array  # (m,) [Pa]


@dataclass(frozen=True)
class Rod:
    """A soft rod."""

    name: str
    frames: Array  # (m, 4, 4): frames, base to tip; x along the rod, z dorsal [m]
    half_height: Array  # (m,): half-dimension of the section along z [m]
    half_width: Array  # (m,): along y [m]
    bands: list[Band] = field(default_factory=list)


@dataclass(frozen=True)
class Link:
    """A rigid tapered link."""

    name: str
    base: Array  # (3,): where its axis begins [m]
    tip: Array  # (3,): where its axis ends [m]
    radius_base: float  # [m]
    radius_tip: float  # [m]
    moves: bool = True  # whether there is a joint at its base, which is then marked


@dataclass(frozen=True)
class Line:
    """A line, such as a chamber, a cable, a strap, a spring, a tie or the outline of a plane."""

    name: str  # of the actuator, the strap, the spring or the obstacle
    points: Array  # (m, 3) [m]
    label: str  # in the legend; empty for none
    colour: str = CHAMBER


@dataclass(frozen=True)
class Mark:
    """The place where a quantity is largest, or where friction acts."""

    symbol: str  # of matplotlib
    point: Array  # (3,) [m]
    label: str  # in the legend
    colour: str = "white"

    @property
    def style(self) -> dict[str, str | float]:
        """Keywords of matplotlib in which it differs; points with friction lie close together."""
        small = {"markersize": 3.5, "markeredgewidth": 0.3} if self.symbol == "o" else {}
        return {"color": self.colour, **small}


@dataclass(frozen=True)
class ContactArrow:
    """A contact force on the limb."""

    point: Array  # (3,): point of application [m]
    force: Array  # (3,) [N]


@dataclass(frozen=True)
class Scene:
    """The drawable state of a model at one load step, in the world frame and SI units."""

    rods: list[Rod] = field(default_factory=list)
    links: list[Link] = field(default_factory=list)
    lines: list[Line] = field(default_factory=list)
    contact_arrows: list[ContactArrow] = field(default_factory=list)
    marks: list[Mark] = field(default_factory=list)
    pressures: list[Pressure] = field(default_factory=list)
    gravity: Array = field(default_factory=lambda: np.zeros(3))  # [m/s²]

    def extent(self) -> tuple[Array, Array]:
        """Return the corners of the bounding box of all bodies and lines, each (3,) [m]."""
        low, high = [], []
        for rod in self.rods:
            margin = np.maximum(rod.half_height, rod.half_width)[:, None]
            low.append((rod.frames[:, :3, 3] - margin).min(axis=0))
            high.append((rod.frames[:, :3, 3] + margin).max(axis=0))
        for link in self.links:
            low.append(np.minimum(link.base - link.radius_base, link.tip - link.radius_tip))
            high.append(np.maximum(link.base + link.radius_base, link.tip + link.radius_tip))
        for line in self.lines:
            low.append(line.points.min(axis=0))
            high.append(line.points.max(axis=0))
        if not low:
            return np.zeros(3), np.zeros(3)
        return np.min(low, axis=0), np.max(high, axis=0)


def enlarged(size: float, width: float) -> float:
    """Return a size in a drawing [cm] of a model so wide [cm]."""
    return size * max(1.0, width / USUAL)


def _enlarged(size: float, scenes: Sequence[Scene]) -> float:
    corners = [scene.extent() for scene in scenes]
    ends = max(high[0] for _, high in corners), min(low[0] for low, _ in corners)
    return enlarged(size, 100.0 * float(ends[0] - ends[1]))


def arrow_scale(scenes: Sequence[Scene]) -> tuple[float, float]:
    """Return the length of an arrow per newton [cm/N] and a round force for the key [N].

    The key is at most the largest force; both are 0 without contact.
    """
    forces = [
        float(np.linalg.norm(arrow.force)) for scene in scenes for arrow in scene.contact_arrows
    ]
    largest = max(forces, default=0.0)
    if largest <= 0.0:
        return 0.0, 0.0
    return _enlarged(LONGEST_ARROW, scenes) / largest, _round_down(largest)


def pressure_scale(scenes: Sequence[Scene]) -> tuple[float, float]:
    """Return the height of a pressure [cm/Pa] and a round pressure for the key [Pa]."""
    values = [float(each.values.max()) for scene in scenes for each in scene.pressures]
    largest = max(values, default=0.0)
    if largest <= 0.0:
        return 0.0, 0.0
    return _enlarged(HIGHEST, scenes) / largest, _round_down(largest)


def _round_down(value: float) -> float:
    decade = 10.0 ** math.floor(math.log10(value))
    return next(n * decade for n in (5.0, 2.0, 1.0) if n * decade <= value * (1.0 + 1e-9))
