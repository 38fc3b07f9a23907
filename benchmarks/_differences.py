"""Finite differences of equilibria along a direction, to check exact derivatives."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from flexor.design import ParameterSet
from flexor.model import Model, Paths

Array = NDArray[np.float64]

# Central differences of sixth order.
WEIGHTS = (45.0 / 60.0, -9.0 / 60.0, 1.0 / 60.0)
# Tighter than the engine's default, as differences divide the residual error by the step.
TOLERANCE = 1e-12


@dataclass(frozen=True)
class Check:
    """Exact derivatives along one direction of each of n designs, and their differences.

    Attributes
    ----------
    exact, differences : (n, outputs) arrays
        Of the joint angles and the tip force, per range of the parameters.
    regular : (n,) bool array
        Whether the engine calls the design regular.
    smooth : (n,) bool array
        Whether no design of the stencil differs in its contacts, its snaps, or the side of the
        minimum radius on which any point of its surface lies.
    """

    exact: Array
    differences: Array
    regular: NDArray[np.bool_]
    smooth: NDArray[np.bool_]

    @property
    def error(self) -> Array:
        """Largest error of each design, relative to the largest of its derivatives, (n,)."""
        size = np.abs(self.exact).max(axis=1)
        error = np.abs(self.exact - self.differences).max(axis=1)
        return np.where(size > 0.0, error / np.where(size > 0.0, size, 1.0), error)


def check(model: Model, chosen: ParameterSet, designs: Array, seed: int, step: float) -> Check:
    """Differentiate both ways along random directions.

    Parameters
    ----------
    model, chosen
        The model and the parameter set.
    designs : (n, k) array
        Where.
    seed
        Of the directions.
    step
        Of the differences, as a fraction of the ranges.
    """
    random = np.random.default_rng(seed)
    direction = random.standard_normal(designs.shape)
    direction *= (chosen.upper - chosen.lower) / np.linalg.norm(direction, axis=1, keepdims=True)
    here = model.evaluate(chosen.geometry(designs, model.X), gradient=True, tolerance=TOLERANCE)
    exact = here.chained(chosen.jacobian(designs, model.X))
    assert here.regularity is not None
    clamped = _clamped(model, chosen, designs)
    smooth = np.ones(len(designs), dtype=np.bool_)
    differences = np.zeros(exact.shape[:2])
    for i, weight in enumerate(WEIGHTS):
        for sign in (1.0, -1.0):
            moved = designs + sign * (i + 1) * step * direction
            batch = model.evaluate(chosen.geometry(moved, model.X), tolerance=TOLERANCE)
            differences += sign * weight * outputs(batch) / step
            smooth &= batch.pairs[:, -1] == here.pairs[:, -1]
            smooth &= batch.event_count == here.event_count
            smooth &= (_clamped(model, chosen, moved) == clamped).all(axis=1)
    return Check(
        exact=np.einsum("nok,nk->no", exact, direction),
        differences=differences,
        regular=here.regularity == "regular",
        smooth=smooth,
    )


def outputs(batch: Paths) -> Array:
    """Joint angles and tip force at the last step, (n, joints + 1)."""
    return np.concatenate((batch.joint_angles[:, -1], batch.tip_force[:, -1:]), axis=1)


def _clamped(model: Model, chosen: ParameterSet, designs: Array) -> NDArray[np.bool_]:
    return chosen.geometry(designs, model.X).radius <= model.design.minimum_radius
