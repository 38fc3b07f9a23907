"""Objective f_exo: press on the finger with the exosuit's tip (equation 14)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexor.arrays import Array
from flexor.errors import InputError
from flexor.model.results import Paths
from flexor.objectives.base import Objective
from flexor.objectives.gradient import PathGradient


@dataclass(frozen=True)
class TipForce(Objective):
    """f_exo = -F_t, the force of the exosuit's tip on the finger at the last load (14).

    The paper does not say what F_t is; here it is the magnitude of the contact force that the
    spheres at the exosuit's tip exert on the finger. Differentiable while they touch; where they do
    not, F_t = 0 and so is the gradient.
    """

    name: str = "tip-force"
    quantity: str = "tip force"
    unit: str = "N"

    def value(self, paths: Paths) -> Array:
        """-F_t [N], (n,); InputError if the model has no contact."""
        if paths.sphere_count < 1:
            raise InputError(
                f'objective "{self.name}" is a contact force, but the model has no contact.'
            )
        return 0.0 - paths.tip_force[:, -1]

    def shown(self, paths: Paths) -> Array:
        """F_t [N], (n,)."""
        return np.array(paths.tip_force[:, -1])

    def gradient(self, paths: Paths) -> PathGradient:
        """Minus one for the tip force at the last load."""
        force = np.zeros(paths.tip_force.shape)
        force[:, -1] = -1.0
        return PathGradient(np.zeros(paths.joint_angles.shape), force)
