"""Quantities of tendons: lengths, tensions, moment arms and the effort of muscles."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from flexor.arrays import Array
from flexor.model.derivatives import Differential, weights
from flexor.model.results import Paths
from flexor.model.structure import Structure
from flexor.observables.slopes import Steps


def lengths(paths: Paths) -> Array:
    """Return the length of each tendon [m], (n, s, tendons)."""
    engine, shape = paths.model.engine, (len(paths.model.tendons),)
    return _each(paths, shape, lambda p, q, _: engine.tendon_lengths(p, q))


def tensions(paths: Paths) -> Array:
    """Return the tension of each tendon [N], (n, s, tendons)."""
    engine, shape = paths.model.engine, (len(paths.model.tendons),)
    return _each(paths, shape, engine.tendon_tensions)


def arms(paths: Paths) -> Array:
    """Return the moment arms by each joint, (n, s, tendons, joints) [m; 1 for translations]."""
    model = paths.model
    shape, columns = (len(model.tendons), len(model.joints)), model.joint_columns
    return _each(paths, shape, lambda p, q, _: model.engine.tendon_arms(p, q)[:, columns])


def crossed(model: Structure) -> list[tuple[int, int]]:
    """Return which tendons cross which joints, as they are at rest or a little bent."""
    bent = 0.05 * np.sin(np.arange(1.0, model.dof + 1.0))
    states = [model.engine.tendon_arms(model.parameters, q) for q in (0.0 * bent, bent, -bent)]
    there = np.abs(np.array(states)[:, :, model.joint_columns]).max(axis=0) > 1e-12
    return [(int(tendon), int(joint)) for tendon, joint in np.argwhere(there)]


def effort(paths: Paths) -> Array:
    """Return the sum of the squared activations of all muscles, (n, s)."""
    columns = [paths.model.input_of(name) for name in paths.model.muscles]
    return np.asarray((paths.applied[:, :, columns] ** 2).sum(axis=2))


def effort_slope(paths: Paths, steps: Steps) -> Differential:
    """Return the change of the effort, of the loads alone."""
    model, n = paths.model, len(paths)
    applied = paths.applied[np.arange(n), steps]
    chosen = np.zeros((n, len(model.inputs)))
    for column in map(model.input_of, model.muscles):
        chosen[:, column] += 2.0 * applied[:, column]
    return Differential(((steps, weights(model, n, {"applied": chosen})),))


def _each(
    paths: Paths, shape: tuple[int, ...], evaluate: Callable[[Array, Array, Array], Array]
) -> Array:
    """Evaluate a function of parameters, coordinates and loads at each equilibrium."""
    values = np.full((*paths.q.shape[:2], *shape), np.nan)
    parameters = paths.parameters
    for i, step in np.argwhere(np.isfinite(paths.q).all(axis=2)):
        values[i, step] = evaluate(parameters[i], paths.q[i, step], paths.applied[i, step])
    return values
