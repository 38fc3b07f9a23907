"""A model in one state: where its bodies and spheres are, and how they touch."""

from __future__ import annotations

import re
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


def frames(
    engine: _engine.Model, parameters: Array, q: Array, counts: Mapping[str, int]
) -> dict[str, Array]:
    """Return the frames along each body, base to tip.

    Parameters
    ----------
    engine
        The engine's model.
    parameters, q : (P,) and (dof,) arrays
        The design and the state.
    counts
        Number of frames of each body; those that the engine has before them, at which the body is
        placed and its joint turns, are left out.

    Returns
    -------
    dict of (m, 4, 4) arrays
        By body: homogeneous matrices (1) in the world [m].
    """
    found = engine.frames(parameters, q)
    owners = [re.split(r"[.\[]", name)[0] for name in engine.frame_names()]
    rows = {body: [row for row, owner in enumerate(owners) if owner == body] for body in counts}
    return {body: found[rows[body][-count:]] for body, count in counts.items()}


def spheres(
    engine: _engine.Model, parameters: Array, q: Array, groups: Mapping[str, int]
) -> dict[str, Array]:
    """Return the contact spheres.

    Parameters
    ----------
    engine, parameters, q
        As for `frames`.
    groups
        Number of spheres of each group.

    Returns
    -------
    dict of (m, 4) arrays
        By group: centre x, y, z and radius [m].
    """
    parts = np.split(engine.spheres(parameters, q), np.cumsum(list(groups.values())))
    return dict(zip(groups, parts, strict=False))  # after the last group comes an empty part


def contact_forces(engine: _engine.Model, parameters: Array, q: Array) -> ContactForces:
    """Return the contact forces (8).

    Parameters
    ----------
    engine, parameters, q
        As for `frames`.
    """
    return ContactForces(**engine.contacts(parameters, q))
