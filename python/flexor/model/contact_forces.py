"""Contact forces in one state."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from flexor.arrays import Array


@dataclass(frozen=True, eq=False)
class ContactForces:
    """Contact forces in one state; m pairs touch.

    Where two round cones meet in a hollow, and a sphere touches both, the sphere that they share is
    taken off again: an entry whose force pulls.
    """

    first: NDArray[np.uint32]  # (m,), index of the sphere, counted through all groups
    # (m,), index of the other, -1 - i for the obstacle i of the model; of a round cone that is
    # touched between its ends, the nearer one
    second: NDArray[np.int64]
    cone: NDArray[np.bool_]  # (m,), whether the second is a round cone
    force: Array  # (m, 3), force on the first sphere [N]; the second feels its opposite
    point: Array  # (m, 3), middle of the overlap [m]
    depth: Array  # (m,), overlap d of (8) [m]
    pressure: Array  # (m,), largest pressure of contact through skins, otherwise NaN [Pa]
