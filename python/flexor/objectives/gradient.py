"""Derivatives of objectives with respect to the states of the paths they are computed from."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexor.arrays import Array
from flexor.errors import InputError
from flexor.model.derivatives import Differential, weights
from flexor.model.structure import Structure


@dataclass(frozen=True)
class PathGradient:
    """Derivative of values with respect to the state of the paths they came from.

    `chained` takes it to the design parameters, with the engine's derivatives of the state. What is
    not listed (the number of touching spheres) is constant between its jumps.
    """

    joint_angles: Array  # (n, ..., steps, j), [1/rad]
    tip_force: Array  # (n, ..., steps), [1/N]

    def differential(self, model: Structure) -> Differential:
        """Return it as the first-order change of the values, which are n numbers."""
        n, steps = self.tip_force.shape
        parts = []
        for step in range(steps):
            angles, force = self.joint_angles[:, step], self.tip_force[:, step]
            if angles.any() or force.any():
                groups = {"joints": angles, "tip_force": force[:, None]}
                parts.append((np.full(n, step), weights(model, n, groups)))
        return Differential(tuple(parts))

    def chained(self, derivatives: Array) -> Array:
        """Return the derivative of the values with respect to k parameters, (n, ..., k).

        It is made of ``derivatives`` (n, j + 1, k), of the joint angles and last of the tip force
        at the last load, as `flexor.model.Paths.chained` gives them; NaN where those are.
        InputError if the values depend on loads before the last.
        """
        if self.joint_angles[..., :-1, :].any() or self.tip_force[..., :-1].any():
            raise InputError(
                "the residual has a gradient at loads before the last, of which no derivatives are "
                "recorded."
            )
        weights = np.concatenate(
            (self.joint_angles[..., -1, :], self.tip_force[..., -1][..., None]), axis=-1
        )
        return np.asarray(np.einsum("n...o,nok->n...k", weights, derivatives))
