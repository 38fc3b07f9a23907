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

    Attributes
    ----------
    first, second : (m,) arrays
        Indices of the spheres, counted through all groups; of a round cone that is touched between
        its ends, ``second`` is the nearer one; -1 is a fixed obstacle.
    cone : (m,) array
        Whether the second is a round cone.
    force : (m, 3) array
        Force on the first sphere [N]; the second feels its opposite.
    point : (m, 3) array
        Middle of the overlap [m].
    depth : (m,) array
        Overlap d of (8) [m].
    """

    first: NDArray[np.uint32]
    second: NDArray[np.int64]
    cone: NDArray[np.bool_]
    force: Array
    point: Array
    depth: Array
