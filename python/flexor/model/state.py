"""A model in one state: where its bodies and spheres are, and how they touch."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from flexor import _engine

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class ContactForces:
    """Contact forces in one state; m pairs touch.

    Where two round cones meet in a hollow, and a sphere touches both, the sphere that they share is
    taken off again: an entry whose force pulls.

    Attributes
    ----------
    first, second : (m,) arrays
        Indices of the spheres, counted through all groups; of a round cone that is touched between
        its ends, ``second`` is the nearer one.
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
    second: NDArray[np.uint32]
    cone: NDArray[np.bool_]
    force: Array
    point: Array
    depth: Array


def frames(
    engine: _engine.Model, parameters: Array, q: Array, ranges: Mapping[str, tuple[int, int]]
) -> dict[str, Array]:
    """Return the frames along each body, base to tip.

    Parameters
    ----------
    engine
        The engine's model.
    parameters, q : (P,) and (dof,) arrays
        The design and the state.
    ranges
        Range of each body's frames among the engine's.

    Returns
    -------
    dict of (m, 4, 4) arrays
        By body: homogeneous matrices (1) in the world [m].
    """
    found = engine.frames(parameters, q)
    return {body: found[start:stop] for body, (start, stop) in ranges.items()}


def spheres(engine: _engine.Model, parameters: Array, q: Array) -> dict[str, Array]:
    """Return the contact spheres.

    Parameters
    ----------
    engine, parameters, q
        As for `frames`.

    Returns
    -------
    dict of (m, 4) arrays
        By group: centre x, y, z and radius [m].
    """
    found = engine.spheres(parameters, q)
    return {group: found[start:stop] for group, (start, stop) in engine.sphere_groups.items()}


def contact_forces(engine: _engine.Model, parameters: Array, q: Array) -> ContactForces:
    """Return the contact forces (8).

    Parameters
    ----------
    engine, parameters, q
        As for `frames`.
    """
    return ContactForces(**engine.contacts(parameters, q))
