"""Newton's method for an actuator under pressure, with tied and fixed displacements."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

import numpy as np
from scipy.sparse import csr_array
from scipy.sparse.linalg import splu

from .mesh import Indices
from .sections import Array

try:
    from pypardiso import PyPardisoSolver
except ImportError:  # not published for every machine; SuperLU takes several times as long
    PyPardisoSolver = None


# Of steps of Newton's method over the size of the body.
LONGEST, FARTHEST, SETTLED = 0.1, 100.0, 1e-6
TOLERANCE = 1e-5  # of the residual; convergence is quadratic, and rounding leaves up to 1e-6


class Term(Protocol):
    """A term of the energy: its cells (n, k) of nodes, residual (n, 3k) and tangent."""

    cells: Indices
    unknowns: Array

    def assemble(self, x: Array) -> tuple[Array, Array]:
        """Return residuals and symmetric tangents."""

    def update(self, change: Array, share: float) -> None:
        """Follow a share of a change of the positions."""


class Diverged(Exception):
    """Newton's method did not converge."""


class Equilibrium:
    """The sum of energy terms over the free displacements.

    `equations` (nodes, 3) number the unknowns; equal numbers are tied, -1 is fixed.
    """

    def __init__(self, terms: Sequence[Term], equations: Indices) -> None:
        self.terms, self.equations = list(terms), equations
        self.size = int(equations.max()) + 1
        keys, self.keep = [], []
        for term in terms:
            rows = equations[term.cells].reshape(len(term.cells), -1)
            i = np.broadcast_to(rows[:, :, None], (*rows.shape, rows.shape[1]))
            j = i.swapaxes(1, 2)
            upper = ((i >= 0) & (i <= j)).ravel()
            self.keep.append(np.flatnonzero(upper))
            keys.append((i * np.int64(self.size) + j).ravel()[self.keep[-1]])
        # Every diagonal entry exists, as the factorisation requires.
        diagonal = np.arange(self.size, dtype=np.int64) * (self.size + 1)
        pattern, self.slots = np.unique(np.concatenate([*keys, diagonal]), return_inverse=True)
        rows, self.columns = np.divmod(pattern, self.size)
        self.starts = np.concatenate(([0], np.cumsum(np.bincount(rows, minlength=self.size))))
        self._solver = None if PyPardisoSolver is None else PyPardisoSolver(mtype=-2)

    def _assemble(self, x: Array) -> tuple[Array, Array, list[float]]:
        residual = np.zeros(self.size)
        values, norms = [], []
        for term, keep in zip(self.terms, self.keep, strict=True):
            force, tangent = term.assemble(x)
            rows = self.equations[term.cells].ravel()
            free = rows >= 0
            part = np.bincount(rows[free], force.ravel()[free], minlength=self.size)
            residual += part
            norms.append(float(np.linalg.norm(part)))
            values.append(tangent.ravel()[keep])
        values.append(np.zeros(self.size))
        data = np.bincount(self.slots, np.concatenate(values), minlength=len(self.columns))
        return residual, data, norms

    def _solve(self, data: Array, right: Array) -> Array:
        shape = (self.size, self.size)
        upper = csr_array((data, self.columns, self.starts), shape=shape)
        if self._solver is not None:
            return self._solver._call_pardiso(upper, right)
        lower = upper.T - csr_array((upper.diagonal(), (range(self.size),) * 2), shape=shape)
        return splu((upper + lower).tocsc()).solve(right)

    def forces(self, x: Array) -> Array:
        """Return the sum of the terms' residuals (nodes, 3), reactions included."""
        total = np.zeros(x.size)
        for term in self.terms:
            force, _ = term.assemble(x)
            index = (3 * term.cells[..., None] + np.arange(3)).ravel()
            total += np.bincount(index, force.ravel(), minlength=x.size)
        return total.reshape(x.shape)

    def unknowns(self) -> list[Array]:
        """Return the unknowns of the terms themselves: pressures and tensions."""
        return [term.unknowns for term in self.terms]

    def restore(self, unknowns: Sequence[Array]) -> None:
        """Set the unknowns of the terms."""
        for term, values in zip(self.terms, unknowns, strict=True):
            term.unknowns = values

    def solve(self, x: Array, iterations: int = 18) -> tuple[Array, float]:
        """Return equilibrium positions near x, and the residual over the largest term's.

        Raises Diverged.
        """
        free = np.where(self.equations >= 0, self.equations, self.size)
        size = np.ptp(x, axis=0).max()
        length = np.inf
        for _ in range(iterations):
            residual, data, norms = self._assemble(x)
            error = float(np.linalg.norm(residual) / max(norms))
            if length < SETTLED * size and error < TOLERANCE:
                return x, error
            change = np.append(self._solve(data, -residual), 0.0)[free]
            length = float(np.abs(change).max())
            if not length < FARTHEST * size:
                break
            share = min(1.0, LONGEST * size / length)
            x = x + share * change
            for term in self.terms:
                term.update(change, share)
        raise Diverged
