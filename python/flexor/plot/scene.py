"""The drawable state of a model at one load: bodies, actuator lines and contact forces."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Rod:
    """A soft rod.

    Attributes
    ----------
    name : str
        The body's name.
    frames : ndarray, shape (m, 4, 4)
        Frames along the rod, base to tip; x along the rod, z dorsal [m].
    half_height, half_width : ndarray, shape (m,)
        Half-dimensions of the section along z and y [m].
    """

    name: str
    frames: Array
    half_height: Array
    half_width: Array


@dataclass(frozen=True)
class Link:
    """A rigid tapered link.

    Attributes
    ----------
    name : str
        The body's name.
    base, tip : ndarray, shape (3,)
        Ends of its axis [m].
    radius_base, radius_tip : float
        Radii at the ends [m].
    moves : bool
        Whether there is a joint at its base, which is then marked.
    """

    name: str
    base: Array
    tip: Array
    radius_base: float
    radius_tip: float
    moves: bool = True


@dataclass(frozen=True)
class Line:
    """A line along a rod, such as a chamber or a cable.

    Attributes
    ----------
    name : str
        The actuator's name.
    points : ndarray, shape (m, 3)
        Points of the line [m].
    label : str
        Label in the legend.
    """

    name: str
    points: Array
    label: str


@dataclass(frozen=True)
class ContactArrow:
    """A contact force on the limb.

    Attributes
    ----------
    point : ndarray, shape (3,)
        Point of application [m].
    force : ndarray, shape (3,)
        The force [N].
    """

    point: Array
    force: Array


@dataclass(frozen=True)
class Scene:
    """The drawable state of a model at one load step, in the world frame and SI units."""

    rods: list[Rod] = field(default_factory=list)
    links: list[Link] = field(default_factory=list)
    lines: list[Line] = field(default_factory=list)
    contact_arrows: list[ContactArrow] = field(default_factory=list)

    def extent(self) -> tuple[Array, Array]:
        """Return the corners of the bounding box of all bodies, each of shape (3,) [m]."""
        low, high = [], []
        for rod in self.rods:
            margin = np.maximum(rod.half_height, rod.half_width)[:, None]
            low.append((rod.frames[:, :3, 3] - margin).min(axis=0))
            high.append((rod.frames[:, :3, 3] + margin).max(axis=0))
        for link in self.links:
            low.append(np.minimum(link.base - link.radius_base, link.tip - link.radius_tip))
            high.append(np.maximum(link.base + link.radius_base, link.tip + link.radius_tip))
        if not low:
            return np.zeros(3), np.zeros(3)
        return np.min(low, axis=0), np.max(high, axis=0)
