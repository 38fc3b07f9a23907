"""Objective f_b: bend the joints of the finger (equation 13)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexor.errors import InputError
from flexor.model.results import Paths
from flexor.objectives.base import Objective, norm
from flexor.objectives.gradient import FloatArray, PathGradient


@dataclass(frozen=True)
class Bending(Objective):
    """f_b = norm of q_b, q_b = pi - theta over the finger's joints at the last load (13).

    Shown as the sum of the joint angles. Differentiable wherever the path is, but at q_b = 0.
    """

    name: str = "bending"
    quantity: str = "bending"
    unit: str = "rad"

    def value(self, paths: Paths) -> FloatArray:
        """f_b [rad], (n,)."""
        return norm(self.residual(paths))

    def shown(self, paths: Paths) -> FloatArray:
        """Sum of the joint angles [rad], (n,)."""
        return total_bending(paths)

    def residual(self, paths: Paths) -> FloatArray:
        """q_b [rad], (n, j)."""
        return unbent(paths)

    def gradient(self, paths: Paths) -> PathGradient:
        """-q_b / norm(q_b) at the last load."""
        return norm_gradient(unbent(paths), norm(unbent(paths)), paths)

    def residual_gradient(self, paths: Paths) -> PathGradient:
        """Minus the identity at the last load."""
        return unbent_gradient(paths, rows=paths.joint_angles.shape[2])


def unbent(paths: Paths) -> FloatArray:
    """q_b = pi - theta at the last load [rad], (n, j).

    Raises
    ------
    InputError
        If the model has no joints.
    """
    if paths.joint_angles.shape[2] == 0:
        raise InputError("an objective of bending needs joints, but the model has none.")
    return np.pi - paths.joint_angles[:, -1, :]


def total_bending(paths: Paths) -> FloatArray:
    """Sum of the joint angles at the last load [rad], (n,)."""
    total = np.zeros(paths.joint_angles.shape[0])
    for joint in range(paths.joint_angles.shape[2]):
        total += paths.joint_angles[:, -1, joint]
    return total


def norm_gradient(q_b: FloatArray, length: FloatArray, paths: Paths) -> PathGradient:
    """Gradient of a norm of given ``length`` (n,) whose first components are q_b (n, j)."""
    angles = np.zeros(paths.joint_angles.shape)
    smooth = length > 0.0
    angles[smooth, -1, :] = -q_b[smooth] / length[smooth, None]
    return PathGradient(angles, np.zeros(paths.tip_force.shape))


def unbent_gradient(paths: Paths, rows: int) -> PathGradient:
    """Gradient of a vector of ``rows`` components that begins with q_b and goes on constant."""
    n, steps, joints = paths.joint_angles.shape
    angles = np.zeros((n, rows, steps, joints))
    for joint in range(joints):
        angles[:, joint, -1, joint] = -1.0
    return PathGradient(angles, np.zeros((n, rows, steps)))
