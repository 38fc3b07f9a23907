"""A nearly incompressible neo-Hookean body: displacements with a pressure linear in each element.

Q2/P1: 27-node hexahedra, pressure discontinuous between elements, so that neither bending nor
incompressibility locks. The pressure is condensed out of the tangent but remains an unknown of its
own in Newton's method, which therefore converges over large steps.

    Π = ∫ μ/2 (I₁ - 3) - μ (J - 1) + p (J - 1) - p²/(2K) dV
"""

from __future__ import annotations

import numpy as np

from .mesh import Indices, Mesh
from .sections import Array

LEVI_CIVITA = np.zeros((3, 3, 3))
LEVI_CIVITA[[0, 1, 2], [1, 2, 0], [2, 0, 1]] = 1.0
LEVI_CIVITA[[0, 2, 1], [2, 1, 0], [1, 0, 2]] = -1.0


class Solid:
    """Energy terms of a mesh with shear modulus and bulk modulus in MPa."""

    def __init__(self, mesh: Mesh, shear: float, bulk: float) -> None:
        import felupe  # an extra; the committed results are read without it

        element = felupe.TriQuadraticHexahedron()
        order = np.ravel_multi_index((element.points.T + 1).astype(int), (3, 3, 3))
        self.cells: Indices = mesh.cells.reshape(-1, 27)[:, order]
        meshed = felupe.Mesh(mesh.points, self.cells, "hexahedron27")
        region = felupe.RegionTriQuadraticHexahedron(meshed)
        if region.dV.min() <= 0.0:
            raise ValueError("an element of the mesh is inverted")
        self.shear, self.bulk = shear, bulk
        self.gradients = np.ascontiguousarray(region.dhdX.transpose(3, 2, 1, 0))  # c, q, J, a
        self.volumes = np.ascontiguousarray(region.dV.T)  # c, q
        self.modes = np.column_stack(
            (np.ones(len(region.quadrature.points)), region.quadrature.points)
        )
        mass = np.einsum("cq,qm,qn->cmn", self.volumes, self.modes, self.modes)
        self.compliance = mass / bulk
        self.stiffness = np.linalg.inv(self.compliance)
        flat = self.gradients.reshape(len(self.cells), -1, 27)
        weighted = flat * np.repeat(self.volumes, 3, axis=1)[..., None]
        laplace = shear * (flat.transpose(0, 2, 1) @ weighted)
        self.linear = np.einsum("cab,ik->caibk", laplace, np.eye(3)).reshape(-1, 81, 81)
        self.unknowns = np.zeros((len(self.cells), 4))

    def deformation(self, x: Array) -> Array:
        """Return F (cells, quadrature points, 3, 3) at current positions (n, 3)."""
        return (self.gradients @ x[self.cells][:, None]).transpose(0, 1, 3, 2)

    def assemble(self, x: Array) -> tuple[Array, Array]:
        """Return residuals (cells, 81) and tangents (cells, 81, 81) with the pressure condensed."""
        f = self.deformation(x)
        cofactor = _cofactor(f)
        dilation = np.einsum("cqij,cqij->cq", f, cofactor) / 3.0 - 1.0
        multiplier = self.volumes * (self.unknowns @ self.modes.T - self.shear)

        stress = (
            self.shear * self.volumes[..., None, None] * f + multiplier[..., None, None] * cofactor
        )
        residual = np.einsum("cqJa,cqiJ->cai", self.gradients, stress, optimize=True)
        forces = np.einsum("cqJa,cqiJ->cqai", self.gradients, cofactor, optimize=True)
        weights = self.volumes[..., None] * self.modes
        coupling = weights.transpose(0, 2, 1) @ forces.reshape(*forces.shape[:2], 81)  # c, m, ai
        defect = np.einsum("cqm,cq->cm", weights, dilation) - np.einsum(
            "cmn,cn->cm", self.compliance, self.unknowns
        )
        self._coupling, self._defect = coupling, defect

        turned = np.einsum("JLn,cqmn,cq->cmqJL", LEVI_CIVITA, f, multiplier, optimize=True)
        right = turned @ self.gradients[:, None]  # c, m, q, J, b
        cells = len(self.cells)
        flat = self.gradients.reshape(cells, -1, 27).transpose(0, 2, 1)[:, None]
        geometric = flat @ right.reshape(cells, 3, -1, 27)  # c, m, a, b
        tangent = np.einsum("ikm,cmab->caibk", LEVI_CIVITA, geometric).reshape(cells, 81, 81)
        tangent += self.linear
        stiff = self.stiffness @ coupling
        tangent += coupling.transpose(0, 2, 1) @ stiff
        total = residual.reshape(cells, 81) + np.einsum("cm,cmx->cx", defect, stiff)
        return total, tangent

    def update(self, change: Array, share: float) -> None:
        """Follow a share of a change of the positions (n, 3) with the pressures."""
        change = change[self.cells].reshape(len(self.cells), 81)
        defect = self._defect + np.einsum("cmx,cx->cm", self._coupling, change)
        self.unknowns = self.unknowns + share * np.einsum("cmn,cn->cm", self.stiffness, defect)


def _cofactor(f: Array) -> Array:
    a, b, c = f[..., 0, :], f[..., 1, :], f[..., 2, :]
    return np.stack((np.cross(b, c), np.cross(c, a), np.cross(a, b)), axis=-2)
