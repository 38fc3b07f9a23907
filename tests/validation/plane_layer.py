"""A soft layer under a rigid cylinder by plane-strain finite elements.

`python -m tests.validation.plane_layer` prints the modulus with which an elastic foundation has the
same force, as a multiple of Young's modulus.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


class Layer:
    """A layer of thickness 1 and Young's modulus 1, bonded to a rigid base.

    Nine-node quadrilaterals, volume strain integrated with fewer points, on half of a layer that is
    12 thicknesses wide; linear elasticity.
    """

    def __init__(self, poisson_ratio: float, columns: int = 100, rows: int = 6) -> None:
        t: Array = np.linspace(0.0, 1.0, columns + 1)
        self.x = _with_middles(12.0 * (0.35 * t + 0.65 * t**3))
        y: Array = np.linspace(0.0, 1.0, rows + 1)
        self.points = int(np.searchsorted(self.x, 7.0))
        self.compliance = self._solve(poisson_ratio, self.x, _with_middles(y))

    def _solve(self, nu: float, x: Array, y: Array) -> Array:
        """Return the normal displacement of each point of the surface by a force on each other."""
        from scipy.sparse import csc_matrix
        from scipy.sparse.linalg import splu

        height, count = len(y), len(x) * len(y)
        mu, bulk = 0.5 / (1.0 + nu), nu / ((1.0 + nu) * (1.0 - 2.0 * nu))
        laws = (
            (3, mu * np.diag([2.0, 2.0, 1.0])),
            (2, bulk * np.array([[1.0, 1.0, 0.0], [1.0, 1.0, 0.0], [0.0, 0.0, 0.0]])),
        )
        places, values = [], []
        for i in range(0, len(x) - 1, 2):
            for j in range(0, len(y) - 1, 2):
                size = x[i + 2] - x[i], y[j + 2] - y[j]
                matrix = sum(_element(size, points, law) for points, law in laws)
                nodes = [(i + a) * height + j + b for a in range(3) for b in range(3)]
                unknowns = np.array([[2 * n, 2 * n + 1] for n in nodes]).ravel()
                places.append(np.stack(np.meshgrid(unknowns, unknowns, indexing="ij"), axis=-1))
                values.append(matrix)
        pairs = np.concatenate([place.reshape(-1, 2) for place in places])
        entries = np.concatenate([np.ravel(value) for value in values])
        whole = csc_matrix((entries, pairs.T), shape=(2 * count, 2 * count))
        base = [2 * i * height + k for i in range(len(x)) for k in (0, 1)]
        free = np.setdiff1d(np.arange(2 * count), base + [2 * j for j in range(height)])
        top = np.searchsorted(free, 2 * (np.arange(self.points) * height + height - 1) + 1)
        forces = np.zeros((len(free), self.points))
        forces[top, np.arange(self.points)] = 1.0
        solved: Array = splu(whole[free][:, free].tocsc()).solve(forces)
        return solved[top]

    def force(self, radius: float, depth: float) -> float:
        """Return the force per length on a rigid cylinder, without friction."""
        target = 0.5 * self.x[: self.points] ** 2 / radius - depth
        touching: NDArray[np.bool_] = target < 0.0
        for _ in range(100):
            active = np.flatnonzero(touching)
            pressed = np.linalg.solve(self.compliance[np.ix_(active, active)], target[active])
            moved = self.compliance[:, active] @ pressed
            now = ~touching & (moved > target + 1e-12)
            now[active[pressed < 0.0]] = True
            if (now == touching).all():
                return float(-2.0 * pressed.sum())
            touching = now
        raise RuntimeError("the contact does not settle")

    def modulus(self, radius: float, depth: float) -> float:
        """Return the modulus with which an elastic foundation has the same force."""
        return self.force(radius, depth) / (4.0 / 3.0 * np.sqrt(2.0 * radius * depth) * depth)


def _with_middles(ends: Array) -> Array:
    points = np.empty(2 * len(ends) - 1)
    points[::2], points[1::2] = ends, 0.5 * (ends[1:] + ends[:-1])
    return points


def _element(size: tuple[float, float], count: int, law: Array) -> Array:
    stations, weights = np.polynomial.legendre.leggauss(count)
    matrix = np.zeros((18, 18))
    for s, ws in zip(stations, weights, strict=True):
        for t, wt in zip(stations, weights, strict=True):
            along, up = np.outer(_slopes(s), _values(t)), np.outer(_values(s), _slopes(t))
            strain = np.zeros((3, 18))
            strain[0, ::2] = strain[2, 1::2] = along.ravel() * 2.0 / size[0]
            strain[1, 1::2] = strain[2, ::2] = up.ravel() * 2.0 / size[1]
            matrix += strain.T @ law @ strain * ws * wt * size[0] * size[1] / 4.0
    return matrix


def _values(s: float) -> Array:
    return np.array([0.5 * s * (s - 1.0), 1.0 - s * s, 0.5 * s * (s + 1.0)])


def _slopes(s: float) -> Array:
    return np.array([s - 0.5, -2.0 * s, s + 0.5])


if __name__ == "__main__":
    for nu in (0.3, 0.48, 0.495):
        layer = Layer(nu)
        for width in (0.3, 0.5, 0.7, 1.0, 1.4, 2.0, 3.0):
            modulus = layer.modulus(10.0, 0.05 * width**2)
            print(f"nu {nu}  a/h {width}  M/E {modulus:.2f}")
