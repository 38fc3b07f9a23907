"""Objectives f_b and f_bc: bend the joints of the finger, and keep in contact with it.

Equations 13 and 15; f_bc in two readings.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexor.arrays import Array
from flexor.errors import InputError
from flexor.model.results import Paths
from flexor.objectives.base import Objective, norm
from flexor.objectives.gradient import PathGradient


@dataclass(frozen=True)
class Bending(Objective):
    """f_b = norm of q_b, q_b = pi - theta over the finger's joints at the last load (13).

    Shown as the sum of the joint angles. Differentiable wherever the path is, but at q_b = 0.
    """

    name: str = "bending"
    quantity: str = "bending"
    unit: str = "rad"

    def value(self, paths: Paths) -> Array:
        """Norm of the residual [rad], (n,)."""
        return norm(self.residual(paths))

    def shown(self, paths: Paths) -> Array:
        """Sum of the joint angles [rad], (n,)."""
        return total_bending(paths)

    def residual(self, paths: Paths) -> Array:
        """q_b [rad], (n, j)."""
        return unbent(paths)

    def gradient(self, paths: Paths) -> PathGradient:
        """-q_b over the value at the last load; n_c is held."""
        length = self.value(paths)
        angles, smooth = np.zeros(paths.joint_angles.shape), length > 0.0
        angles[smooth, -1, :] = -unbent(paths)[smooth] / length[smooth, None]
        return PathGradient(angles, np.zeros(paths.tip_force.shape))

    def residual_gradient(self, paths: Paths) -> PathGradient:
        """Minus the identity for the joints at the last load, zero for the contact."""
        n, steps, joints = paths.joint_angles.shape
        rows = self.residual(paths).shape[1]
        angles = np.zeros((n, rows, steps, joints))
        for joint in range(joints):
            angles[:, joint, -1, joint] = -1.0
        return PathGradient(angles, np.zeros((n, rows, steps)))


@dataclass(frozen=True)
class BendingContact(Bending):
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

    def residual(self, paths: Paths) -> Array:
        """q_bc [rad], (n, j + 1)."""
        return np.concatenate((unbent(paths), self._contact(paths)[:, None]), axis=1)

    def _contact(self, paths: Paths) -> Array:
        if paths.sphere_count < 1:
            raise InputError(
                f'objective "{self.name}" counts touching spheres, but the model has no contact.'
            )
        return np.pi * (1.0 - paths.touching[:, -1] / paths.sphere_count)


@dataclass(frozen=True)
class BendingContactPrinted(BendingContact):
    """f_bc as printed: norm of [pi - theta, -n_c], which avoids contact (15)."""

    name: str = "bending-contact-printed"

    def _contact(self, paths: Paths) -> Array:
        return 0.0 - paths.touching[:, -1].astype(np.float64)


def unbent(paths: Paths) -> Array:
    """q_b = pi - theta at the last load [rad], (n, j)."""
    if paths.joint_angles.shape[2] == 0:
        raise InputError("an objective of bending needs joints, but the model has none.")
    return np.pi - paths.joint_angles[:, -1, :]


def total_bending(paths: Paths) -> Array:
    """Sum of the joint angles at the last load [rad], (n,)."""
    total = np.zeros(paths.joint_angles.shape[0])
    for joint in range(paths.joint_angles.shape[2]):
        total += paths.joint_angles[:, -1, joint]
    return total
