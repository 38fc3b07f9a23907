"""A Cosserat rod in strong form, by collocation: the reference side of `strong_form`."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_bvp

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Solution:
    """A solved rod.

    Attributes
    ----------
    curve : callable
        From places s (m,) [m] to position, quaternion (scalar first), force and moment across the
        section, all in the world, (13, m).
    form, tension
        What was solved.
    """

    curve: Callable[[Array], Array]
    form: StrongForm
    tension: float

    def poses(self, s: Array) -> Array:
        """Return homogeneous matrices at places s (m,), (m, 4, 4)."""
        state = self.curve(s)
        found = np.tile(np.eye(4), (len(s), 1, 1))
        found[:, :3, 3] = state[:3].T
        found[:, :3, :3] = _rotation(state[3:7]).transpose(2, 0, 1)
        return found

    def strains(self, s: Array) -> Array:
        """Return curvatures [1/m] and linear strains at places s (m,), (6, m)."""
        return self.form.strain(s, _section_wrench(self.curve(s)), self.tension)


@dataclass(frozen=True)
class StrongForm:
    """A clamped rod with a cable, gravity and a load at its tip.

    Attributes
    ----------
    length : float
        [m].
    stiffness : callable
        From places s (m,) to the section's stiffness (6, m): torsion, bending about y and z,
        extension, shear along y and z.
    weight : callable
        From places s (m,) to the force per length in the world (3, m) [N/m].
    cable : callable
        From places s (m,) to the cable's offset and its derivative by s, (3, m) each.
    """

    length: float
    stiffness: Callable[[Array], Array]
    weight: Callable[[Array], Array]
    cable: Callable[[Array], tuple[Array, Array]]

    def strain(self, s: Array, wrench: Array, tension: float) -> Array:
        """Invert the law of the section, cable included.

        Returns
        -------
        (6, m) array
            Curvatures [1/m] and linear strains.

        Notes
        -----
        K (ξ - ξ*) + T Jᵀ t = W, with t the unit vector along τ = J ξ + d′ and J ξ = v + κ × d, by
        Newton's method at every place for itself.
        """
        stiffness, (offset, slope) = self.stiffness(s).T, self.cable(s)
        rest = np.array([0.0, 0.0, 0.0, 1.0, 0.0, 0.0])
        arm = np.concatenate([-_cross(offset), np.tile(np.eye(3), (len(s), 1, 1))], axis=2)
        strain = rest + wrench.T / stiffness
        for _ in range(50):
            tangent = np.einsum("mij,mj->mi", arm, strain) + slope.T
            norm = np.linalg.norm(tangent, axis=1)[:, None]
            unit = tangent / norm
            excess = stiffness * (strain - rest) + tension * np.einsum("mij,mi->mj", arm, unit)
            excess -= wrench.T
            across = (np.eye(3) - unit[:, :, None] * unit[:, None, :]) / norm[:, :, None]
            curvature = tension * np.swapaxes(arm, 1, 2) @ across @ arm
            curvature[:, range(6), range(6)] += stiffness
            step = np.linalg.solve(curvature, excess[:, :, None])[:, :, 0]
            strain = strain - step
            if np.max(np.abs(step)) < 1e-14:
                break
        return strain.T

    def solve(
        self, tension: float, force: Array, moment: Array, near: Solution | None = None
    ) -> Solution:
        """Solve n′ = -f, m′ = n × r′ with the clamped base and the loaded tip."""

        def slope(s: Array, y: Array) -> Array:
            strain = self.strain(s, _section_wrench(y), tension)
            forward = np.einsum("ijm,jm->im", _rotation(y[3:7]), strain[3:])
            turn = 0.5 * _quaternion_rate(y[3:7], strain[:3])
            return np.concatenate(
                [forward, turn, -self.weight(s), np.cross(y[7:10].T, forward.T).T]
            )

        base = np.array([0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0])
        tip = np.concatenate([force, moment])
        mesh = np.linspace(0.0, self.length, 41)
        state = np.zeros((13, len(mesh)))
        state[0], state[3] = mesh, 1.0
        if near is not None:
            state = near.curve(mesh)
        found = solve_bvp(
            slope,
            lambda start, end: np.concatenate([start[:7] - base, end[7:] - tip]),
            *(mesh, state),
            tol=1e-8,
            bc_tol=1e-13,
            max_nodes=20_000,
        )
        if not found.success:
            raise RuntimeError(f"the strong form was not solved: {found.message}")
        return Solution(found.sol, self, tension)


def _section_wrench(state: Array) -> Array:
    """Moment and force across the section in its own frame, (6, m)."""
    turn = _rotation(state[3:7])
    return np.concatenate(
        [np.einsum("jim,jm->im", turn, part) for part in (state[10:], state[7:10])]
    )


def _cross(vectors: Array) -> Array:
    """Return the matrices of v × (.) for vectors (3, m), (m, 3, 3)."""
    x, y, z = vectors
    zero = np.zeros_like(x)
    return np.array([[zero, -z, y], [z, zero, -x], [-y, x, zero]]).transpose(2, 0, 1)


def _rotation(quaternion: Array) -> Array:
    """Return the rotation matrices (3, 3, m) of quaternions (4, m), scalar first."""
    w, x, y, z = quaternion / np.linalg.norm(quaternion, axis=0)
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def _quaternion_rate(quaternion: Array, curvature: Array) -> Array:
    """Twice the rate of a quaternion turning by a body rate: q (0, κ)."""
    w, v = quaternion[0], quaternion[1:]
    scalar = -np.sum(v * curvature, axis=0)
    return np.concatenate([scalar[None], w * curvature + np.cross(v.T, curvature.T).T])
