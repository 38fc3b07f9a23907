"""Fibres wound or laid on surfaces of a body, and pressure in its cavity."""

from __future__ import annotations

import numpy as np

from .mesh import Indices
from .sections import Array


def _shapes(order: int) -> tuple[Array, Array, Array, Array]:
    """Return weights (q,), shape functions (q, 9) and their two derivatives at Gauss points."""
    at, weight = np.polynomial.legendre.leggauss(order)
    value = np.column_stack((at * (at - 1.0) / 2.0, 1.0 - at * at, at * (at + 1.0) / 2.0))
    slope = np.column_stack((at - 0.5, -2.0 * at, at + 0.5))

    def product(first: Array, second: Array) -> Array:
        return np.einsum("qa,rb->qrab", first, second).reshape(order**2, 9)

    weights = np.outer(weight, weight).ravel()
    return weights, product(value, value), product(slope, value), product(value, slope)


class Fibres:
    """Fibres of one direction, smeared over faces; E is their Green strain.

    Π = ∫ T E - T²/(2k) dA, with k [N/mm] a stiffness per width and the tension T [N/mm] an
    unknown at each point. `direction` is "around" the section or "along" the actuator.
    """

    def __init__(self, points: Array, faces: Indices, direction: str, stiffness: float) -> None:
        # Two points a direction: at three, inextensible fibres would lock the faces in bending.
        weights, _, slope_r, slope_s = _shapes(2)
        self.cells = faces.reshape(-1, 9)
        x = points[self.cells]
        r, s = slope_r @ x, slope_s @ x  # c, q, 3
        normal = np.cross(r, s)
        area = np.linalg.norm(normal, axis=-1)
        fibre = np.cross((1.0, 0.0, 0.0), normal)
        if direction == "along":
            fibre = np.cross(normal, fibre)
        fibre /= np.linalg.norm(fibre, axis=-1)[..., None]
        base = np.stack((r, s), axis=-1)  # c, q, 3, 2
        metric = base.swapaxes(-1, -2) @ base
        share = np.linalg.solve(metric, np.einsum("cqix,cqi->cqx", base, fibre)[..., None])[..., 0]
        self.slopes = share[..., :1] * slope_r + share[..., 1:] * slope_s  # c, q, 9
        self.areas = weights * area
        self.stiffness = stiffness
        self.unknowns = np.zeros(self.areas.shape)
        self._grams = np.einsum("cqa,cqb->cqab", self.slopes, self.slopes)

    def stretch(self, x: Array) -> Array:
        """Return the fibres' stretch (cells, quadrature points)."""
        return np.linalg.norm(self.slopes @ x[self.cells], axis=-1)

    def assemble(self, x: Array) -> tuple[Array, Array]:
        """Return residuals (cells, 27) and tangents (cells, 27, 27)."""
        g = self.slopes @ x[self.cells]
        strain = (np.sum(g * g, axis=-1) - 1.0) / 2.0
        forces = np.einsum("cqa,cqi->cqai", self.slopes, g).reshape(*g.shape[:2], 27)
        self._forces, self._strain = forces, strain
        # With the tension condensed, its residual acts through the stiffness.
        residual = np.einsum("cq,cqx->cx", self.areas * self.stiffness * strain, forces)
        geometric = np.einsum("cq,cqab->cab", self.areas * self.unknowns, self._grams)
        tangent = np.einsum("cab,ik->caibk", geometric, np.eye(3)).reshape(-1, 27, 27)
        stiff = self.stiffness * self.areas[..., None] * forces
        tangent += forces.swapaxes(1, 2) @ stiff
        return residual, tangent

    def update(self, change: Array, share: float) -> None:
        """Follow a share of a change of the positions (n, 3) with the tension."""
        change = change[self.cells].reshape(len(self.cells), 27)
        strain = self._strain + np.einsum("cqx,cx->cq", self._forces, change)
        self.unknowns = (1.0 - share) * self.unknowns + share * self.stiffness * strain


class Bars:
    """Straight bars between nodes; k [N] is their stiffness, E and T as for fibres."""

    def __init__(self, points: Array, ends: Indices, stiffness: float) -> None:
        self.cells = ends
        self.lengths = np.linalg.norm(np.diff(points[ends], axis=1)[:, 0], axis=-1)
        self.stiffness = stiffness
        self.unknowns = np.zeros(len(ends))

    def assemble(self, x: Array) -> tuple[Array, Array]:
        """Return residuals (bars, 6) and tangents (bars, 6, 6)."""
        slopes = np.array((-1.0, 1.0))
        g = np.diff(x[self.cells], axis=1)[:, 0] / self.lengths[:, None]
        strain = (np.sum(g * g, axis=-1) - 1.0) / 2.0
        forces = np.einsum("a,ci->cai", slopes, g).reshape(-1, 6)
        self._forces, self._strain = forces / self.lengths[:, None], strain
        stiff = self.stiffness / self.lengths
        tangent = stiff[:, None, None] * forces[:, :, None] * forces[:, None]
        gram = np.kron(np.outer(slopes, slopes), np.eye(3))
        tangent += (self.unknowns / self.lengths)[:, None, None] * gram
        return (self.stiffness * strain)[:, None] * forces, tangent

    def update(self, change: Array, share: float) -> None:
        """Follow a share of a change of the positions (n, 3) with the tension."""
        change = change[self.cells].reshape(-1, 6)
        strain = self._strain + np.sum(self._forces * change, axis=1)
        self.unknowns = (1.0 - share) * self.unknowns + share * self.stiffness * strain


class Cavity:
    """Pressure on the faces of a cavity that the plane of symmetry closes."""

    def __init__(self, faces: Indices) -> None:
        self.cells = faces.reshape(-1, 9)
        self.weights, self.shapes, self.slope_r, self.slope_s = _shapes(3)
        self.pressure = 0.0  # MPa
        self.unknowns = np.zeros(0)

    def volume(self, x: Array) -> float:
        """Return the volume [mm³] of the half with y > 0."""
        x = x[self.cells]
        area = np.cross(self.slope_r @ x, self.slope_s @ x)
        return float(-np.einsum("q,cqi,cqi->", self.weights, self.shapes @ x, area) / 3.0)

    def assemble(self, x: Array) -> tuple[Array, Array]:
        """Return residuals (cells, 27) and tangents (cells, 27, 27).

        The tangent of one face is not symmetric; the sum over a closed cavity is, so each face
        contributes its symmetric part.
        """
        x = x[self.cells]
        r, s = self.slope_r @ x, self.slope_s @ x
        load = self.pressure * self.weights[:, None] * self.shapes  # q, a
        residual = np.einsum("qa,cqi->cai", load, np.cross(r, s)).reshape(-1, 27)
        unit = np.eye(3)
        turned_s = np.cross(unit, s[..., None, :])  # e_k × s: c, q, k, i
        turned_r = np.cross(r[..., None, :], unit)
        tangent = np.einsum("qa,qb,cqki->caibk", load, self.slope_r, turned_s, optimize=True)
        tangent += np.einsum("qa,qb,cqki->caibk", load, self.slope_s, turned_r, optimize=True)
        tangent = tangent.reshape(-1, 27, 27)
        return residual, (tangent + tangent.swapaxes(1, 2)) / 2.0

    def update(self, change: Array, share: float) -> None:
        """Do nothing: a pressure has no unknowns of its own."""


class Plane:
    """A frictionless plane z = `height` under nodes, held by a stiff spring [N/mm] at each."""

    def __init__(self, nodes: Indices, height: float, stiffness: float) -> None:
        self.cells = nodes[:, None]
        self.height, self.stiffness = height, stiffness
        self.unknowns = np.zeros(0)

    def force(self, x: Array) -> float:
        """Return the force [N] on the half with y > 0, upwards."""
        depth = np.maximum(self.height - x[self.cells[:, 0], 2], 0.0)
        return float(self.stiffness * depth.sum())

    def assemble(self, x: Array) -> tuple[Array, Array]:
        """Return residuals (nodes, 3) and tangents (nodes, 3, 3)."""
        depth = np.maximum(self.height - x[self.cells[:, 0], 2], 0.0)
        residual = np.zeros((len(depth), 3))
        tangent = np.zeros((len(depth), 3, 3))
        residual[:, 2] = -self.stiffness * depth
        tangent[:, 2, 2] = self.stiffness * (depth > 0.0)
        return residual, tangent

    def update(self, change: Array, share: float) -> None:
        """Do nothing: a plane has no unknowns of its own."""
