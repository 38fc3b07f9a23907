"""Observables of paths of equilibria."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from flexor.arrays import Array
from flexor.calibration.schema import Target
from flexor.errors import InputError, unknown_name
from flexor.model import Model
from flexor.model.schema import Rod
from flexor.model.units import ANGLE, FORCE, LENGTH, Dimension


@dataclass(frozen=True, eq=False)
class ObservedPaths:
    """Paths of n sets of constants under the same s loads."""

    model: Model  # with their structure
    parameters: Array  # (n, P), of the engine
    q: Array  # (n, s, dof)
    tip_force: Array  # (n, s), F_t (14) [N]
    touching: NDArray[np.uint32]  # (n, s), n_c
    obstacle_force: Array  # (n, s, obstacles), normal forces [N]


@dataclass(frozen=True)
class Observable:
    """A quantity of every equilibrium of a path."""

    kind: Dimension | None  # what it is measured in; None for plain numbers
    values: Callable[[ObservedPaths], Array]  # SI, (n, s)


def observable(target: Target, model: Model, place: str) -> Observable:
    """Return the observable of a target (any but an optimum); messages begin with `place`."""
    if target.observable in ("bending", "angle"):
        return Observable(ANGLE, _angles(target, model, place))
    if target.observable in ("tip-force", "contacts"):
        if not model.first_spheres:
            raise InputError(
                f'{place}.observable is "{target.observable}", but the model "{model.name}" has no '
                "contact."
            )
        if target.observable == "contacts":
            return Observable(None, lambda paths: paths.touching.astype(np.float64))
        return Observable(FORCE, lambda paths: paths.tip_force)
    if target.observable == "obstacle-force":
        names = tuple(model.file.obstacles)
        if target.of not in names:
            raise InputError(
                f"{place}.of is the {unknown_name('obstacle', str(target.of), names)}."
            )
        index = names.index(str(target.of))
        return Observable(FORCE, lambda paths: paths.obstacle_force[:, :, index])
    body, row = _frame(target, model, place)
    if target.observable == "rotation":
        return Observable(ANGLE, lambda paths: _rotation(paths, body)[..., row])
    axis = ("x", "y", "z").index(target.observable)
    return Observable(LENGTH, lambda paths: _frames(paths, body)[:, :, row, axis, 3])


def _angles(target: Target, model: Model, place: str) -> Callable[[ObservedPaths], Array]:
    joints = zip(model.joints, model.joint_columns, strict=True)
    angular = {name: int(column) for name, column in joints if name in model.angular_joints}
    if not angular:
        raise InputError(
            f'{place}.observable is "{target.observable}", but the model "{model.name}" has no '
            "joint that turns."
        )
    if target.of is None:
        columns = list(angular.values())
        return lambda paths: np.asarray(paths.q[:, :, columns].sum(axis=2))
    short = {model.joint_labels[name]: column for name, column in angular.items()}
    if target.of not in short and target.of not in angular:
        raise InputError(f"{place}.of is the {unknown_name('joint', target.of, short)}.")
    column = {**short, **angular}[target.of]
    return lambda paths: np.asarray(paths.q[:, :, column])


def _frame(target: Target, model: Model, place: str) -> tuple[str, int]:
    """Return the body of a target, and the row of its frame along the body."""
    name = str(target.of)
    if name not in model.file.bodies:
        raise InputError(f"{place}.of is the {unknown_name('body', name, model.file.bodies)}.")
    body = model.file.bodies[name]
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
    return name, row


def _frames(paths: ObservedPaths, body: str) -> Array:
    """Return the m frames along a body, (n, s, m, 4, 4); NaN where there is no equilibrium."""
    model, (n, steps) = paths.model, paths.q.shape[:2]
    first, stop = model.body_frames[body]
    found = np.full((n, steps, stop - first, 4, 4), np.nan)
    for i, step in np.argwhere(np.isfinite(paths.q).all(axis=2)):
        q = paths.q[i, step]
        found[i, step] = model.engine.frames(paths.parameters[i], q)[first:stop]
    return found


def _rotation(paths: ObservedPaths, body: str) -> Array:
    """Angle about y from the world's x axis to the body's, unwrapped along the body; (n, s, m)."""
    found = _frames(paths, body)
    return np.unwrap(np.arctan2(-found[..., 2, 0], found[..., 0, 0]), axis=2)
