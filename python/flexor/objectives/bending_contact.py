"""Objective f_bc: bend the finger and keep in contact with it (equation 15), in two readings."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexor.errors import InputError
from flexor.model.results import Paths
from flexor.objectives.base import Objective, norm
from flexor.objectives.bending import norm_gradient, total_bending, unbent, unbent_gradient
from flexor.objectives.gradient import FloatArray, PathGradient


@dataclass(frozen=True)
class BendingContact(Objective):
    """f_bc as the paper's text intends it: contact is rewarded (15).

    The printed vector q_bc = [q_b, -n_c] has a norm that grows with the number n_c of touching
    spheres, so minimising it avoids contact, against its purpose ("maximize the bending of the
    finger while ensuring that the exosuit tip did not slide"). Here the last component is what is
    missing, as it is for the joints: q_bc = [pi - theta, pi (1 - n_c / N)], N the number of the
    exosuit's spheres. Zero is fully bent and fully touching, and no contact at all weighs as much
    as one joint left straight. (One radian for each missing sphere, the weight of the printed
    form, lets contact overrule bending: its best designs hold the finger straight or bend it
    backwards.)

    Differentiable between jumps of n_c: the count is piecewise constant, so that the gradient is
    that of the angles' part alone, and does not see a sphere come into contact or leave it.
    """

    name: str = "bending-contact"
    quantity: str = "bending"
    unit: str = "rad"

    def value(self, paths: Paths) -> FloatArray:
        """f_bc [rad], (n,)."""
        return norm(self.residual(paths))

    def shown(self, paths: Paths) -> FloatArray:
        """Sum of the joint angles [rad], (n,)."""
        return total_bending(paths)

    def residual(self, paths: Paths) -> FloatArray:
        """q_bc [rad], (n, j + 1).

        Raises
        ------
        InputError
            If the exosuit has no spheres.
        """
        return np.concatenate((unbent(paths), self._contact(paths)[:, None]), axis=1)

    def gradient(self, paths: Paths) -> PathGradient:
        """-q_b / f_bc at the last load, n_c held."""
        return norm_gradient(unbent(paths), self.value(paths), paths)

    def residual_gradient(self, paths: Paths) -> PathGradient:
        """Minus the identity for the joints at the last load, zero for the contact."""
        return unbent_gradient(paths, rows=paths.joint_angles.shape[2] + 1)

    def _contact(self, paths: Paths) -> FloatArray:
        if paths.sphere_count < 1:
            raise InputError(
                f'objective "{self.name}" counts touching spheres, but the model has no contact.'
            )
        return np.pi * (1.0 - paths.touching[:, -1] / paths.sphere_count)


@dataclass(frozen=True)
class BendingContactPrinted(BendingContact):
    """f_bc as printed: norm of [pi - theta, -n_c], which avoids contact (15)."""

    name: str = "bending-contact-printed"

    def _contact(self, paths: Paths) -> FloatArray:
        return 0.0 - paths.touching[:, -1].astype(np.float64)
