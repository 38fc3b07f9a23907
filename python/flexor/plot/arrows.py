"""Common scale of the force arrows in a figure, and the value of its key."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from flexor.plot.scene import Scene

MAX_LENGTH = 1.8  # cm


def scale(scenes: Sequence[Scene]) -> tuple[float, float]:
    """Return the length of an arrow per newton [cm/N] and a round force for the key [N].

    The key is at most the largest force; both are 0 without contact.
    """
    forces = [
        float(np.linalg.norm(arrow.force)) for scene in scenes for arrow in scene.contact_arrows
    ]
    largest = max(forces, default=0.0)
    if largest <= 0.0:
        return 0.0, 0.0
    return MAX_LENGTH / largest, _round_down(largest)


def _round_down(value: float) -> float:
    decade = 10.0 ** math.floor(math.log10(value))
    return next(n * decade for n in (5.0, 2.0, 1.0) if n * decade <= value * (1.0 + 1e-9))
