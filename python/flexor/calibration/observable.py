"""What can be observed of a path of equilibria."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from flexor.calibration.schema import Target
from flexor.errors import InputError, unknown_name
from flexor.model import Model
from flexor.model.schema import Rod
from flexor.model.units import ANGLE, FORCE, LENGTH, Dimension

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Followed:
    """Paths of n sets of constants over the same s loads.

    Attributes
    ----------
    model : Model
        A model with their structure.
    parameters : (n, P) array
        The engine's parameters of each.
    q : (n, s, dof) array
        Generalized coordinates.
    tip_force, touching : (n, s) arrays
        F_t (14) [N], and n_c.
    """

    model: Model
    parameters: Array
    q: Array
    tip_force: Array
    touching: NDArray[np.uint32]


@dataclass(frozen=True)
class Observable:
    """A quantity of every equilibrium of a path.

    Attributes
    ----------
    kind : Dimension or None
        What it is measured in; None for plain numbers.
    values : callable
        From `Followed` to SI values (n, s).
    """

    kind: Dimension | None
    values: Callable[[Followed], Array]


def observable(target: Target, model: Model, place: str) -> Observable:
    """Find the observable of a target.

    Parameters
    ----------
    target
        Any target but an optimum.
    model
        Its model.
    place
        File and target, for messages.

    Raises
    ------
    InputError
        If the model has no such thing to be observed.
    """
    if target.observable in ("bending", "angle"):
        return Observable(ANGLE, _angles(target, model, place))
    if target.observable in ("tip-force", "contacts"):
        if not model.file.contacts:
            raise InputError(
                f'{place}.observable is "{target.observable}", but the model "{model.name}" has no '
                "contact."
            )
        if target.observable == "contacts":
            return Observable(None, lambda paths: paths.touching.astype(np.float64))
        return Observable(FORCE, lambda paths: paths.tip_force)
    row, count, first = _frames(target, model, place)
    if target.observable == "rotation":
        return Observable(ANGLE, lambda paths: _rotation(paths, first, count)[..., row])
    axis = ("x", "y", "z").index(target.observable)
    return Observable(LENGTH, lambda paths: _frames_of(paths, first, count)[:, :, row, axis, 3])


def bending(model: Model) -> Callable[[Followed], Array]:
    """Return the sum of all angles of a model's joints [rad]."""
    columns = list(_angular(model).values())
    return lambda paths: np.asarray(paths.q[:, :, columns].sum(axis=2))


def _angular(model: Model) -> dict[str, int]:
    columns = zip(model.joints, model.joint_columns, strict=True)
    return {name: int(column) for name, column in columns if name in model.angular_joints}


def _angles(target: Target, model: Model, place: str) -> Callable[[Followed], Array]:
    angular = _angular(model)
    if not angular:
        raise InputError(
            f'{place}.observable is "{target.observable}", but the model "{model.name}" has no '
            "joint that turns."
        )
    if target.of is None:
        return bending(model)
    short = {name.removesuffix(".theta"): column for name, column in angular.items()}
    if target.of not in short and target.of not in angular:
        raise InputError(f"{place}.of is the {unknown_name('joint', target.of, short)}.")
    column = {**short, **angular}[target.of]
    return lambda paths: np.asarray(paths.q[:, :, column])


def _frames(target: Target, model: Model, place: str) -> tuple[int, int, int]:
    """Which frame of a body, how many it has, and where they begin among the engine's."""
    name = str(target.of)
    if name not in model.file.bodies:
        raise InputError(f"{place}.of is the {unknown_name('body', name, model.file.bodies)}.")
    body = model.file.bodies[name]
    first, stop = model.body_frames[name]
    at = {"base": 0.0, "tip": 1.0}.get(str(target.at), target.at)
    assert isinstance(at, float)
    row = body.point_at(at) if isinstance(body, Rod) else {0.0: 0, 1.0: 1}.get(at)
    if row is None:
        where = (
            f"a multiple of 1/{body.elements} (an element's end)"
            if isinstance(body, Rod)
            else '"base" or "tip" of a link'
        )
        raise InputError(f"{place}.at is {at!r}: it must be {where}.")
    return row, stop - first, first


def _frames_of(paths: Followed, first: int, count: int) -> Array:
    n, steps = paths.q.shape[:2]
    found = np.full((n, steps, count, 4, 4), np.nan)
    for i in range(n):
        for step in range(steps):
            if np.all(np.isfinite(paths.q[i, step])):
                frames = paths.model.engine.frames(paths.parameters[i], paths.q[i, step])
                found[i, step] = frames[first : first + count]
    return found


def _rotation(paths: Followed, first: int, count: int) -> Array:
    """Angle about y from the world's x axis to the body's, unwrapped along the body; (n, s, m)."""
    frames = _frames_of(paths, first, count)
    return np.unwrap(np.arctan2(-frames[..., 2, 0], frames[..., 0, 0]), axis=2)
