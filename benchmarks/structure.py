"""What the tangent of a rod is made of, and what using it would give at many degrees of freedom.

The twist of every section adds to that of all sections beyond it, so each strain acts on all loads
further out and the tangent is full. But it acts on them through one rigid motion of the rest of the
rod: a block of the tangent that couples the strains of one part with those of the part beyond it
has a small rank, whatever the number of elements. Measured here are that rank (singular values
above 1e-9 of the largest diagonal entry of the scaled tangent), and the time of one factorisation
and solution: dense (LAPACK's Cholesky, one thread) against a recursion from node to node that
carries a matrix of that rank outward (NumPy, with the same pivots: it finds a tangent that is not
positive definite just as Cholesky does). The multiplications of both are counted.
"""

from __future__ import annotations

import argparse
import os
from dataclasses import dataclass

# One thread each, set before NumPy reads it: their threads would only add to the time.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
os.environ.setdefault("MKL_NUM_THREADS", "1")

import numpy as np
from _machine import machine
from _rods import finger, spatial_rod
from _section import Section, table
from _timing import by_turns, exponent
from numpy.typing import NDArray
from scipy.linalg import cho_factor, cho_solve

from flexor.model import Model

Array = NDArray[np.float64]
ELEMENTS = {
    "exosuit (finger held)": (finger, (10, 20, 40, 80, 160, 320, 498)),
    "rod in space": (spatial_rod, (3, 7, 15, 31, 63, 127, 166)),
}
TOLERANCE = 1e-9


@dataclass(frozen=True)
class Generators:
    """H_ij = U_i W_{i+1} … W_{j-1} V_jᵀ for nodes i < j, and its diagonal blocks."""

    diagonal: list[Array]
    u: list[Array]
    w: list[Array]
    v: list[Array]

    @property
    def rank(self) -> int:
        """Largest rank of a block beyond the diagonal."""
        return max(u.shape[1] for u in self.u)

    @property
    def multiplications(self) -> int:
        """Multiplications of the recursion, by its products' sizes."""
        return sum(
            2 * m * r * r + 2 * m * m * r + m**3 // 3 + 2 * r**3
            for m, r in ((u.shape[0], max(u.shape[1], v.shape[1])) for u, v in self.blocks)
        )

    @property
    def blocks(self) -> list[tuple[Array, Array]]:
        """U and V of each node."""
        return list(zip(self.u, self.v, strict=True))


def main() -> None:
    """Measure, and print the table."""
    reading = argparse.ArgumentParser(description=__doc__)
    reading.add_argument("--runs", type=int, default=3, help="of which medians are shown")
    reading.add_argument("--quick", action="store_true", help="smaller sizes")
    asked = reading.parse_args()
    section = measure(asked.runs, quick=asked.quick)
    section.parts.insert(0, machine())
    section.show()


def measure(runs: int, *, quick: bool) -> Section:
    """Measure everything, and write it up."""
    made = table(
        *("model", "DOF", "rank", "dense / ms", "recursion / ms", "multiplications, dense"),
        *("recursion", "difference"),
    )
    fits = []
    for name, (make, elements) in ELEMENTS.items():
        chosen = elements[:-2] if quick else elements
        sizes, costs = [], []
        for i, count in enumerate(chosen):
            matrix, nodes = tangent(make(count))
            n, made_of = len(matrix), generators(matrix, nodes)
            load = np.random.default_rng(0).standard_normal(n)
            exact = cho_solve(cho_factor(matrix), load)
            found = solve(made_of, load)
            works = {
                "dense": lambda m=matrix, b=load: repeated(lambda: cho_solve(cho_factor(m), b)),
                "recursion": lambda g=made_of, b=load: repeated(lambda: solve(g, b)),
            }
            times = by_turns(works, runs, f"{name}, {n} DOF")
            dense, recursion = (times[key].median / REPEATS for key in works)
            sizes.append(n)
            costs.append(made_of.multiplications)
            made.add_row(
                "" if i else name,
                f"{n:,}",
                str(made_of.rank),
                f"{1e3 * dense:.3f}",
                f"{1e3 * recursion:.3f}",
                f"{n**3 / 6:,.0f}",
                f"{made_of.multiplications:,}",
                f"{np.abs(found - exact).max() / np.abs(exact).max():.0e}",
            )
        fits.append(f"{name}: ~ DOF^{exponent(sizes, costs):.2f}")
    section = Section("Structure of the tangent", "./dev bench structure" + " --quick" * quick)
    section.parts += [
        "The tangent of a rod is full: what acts on the tip is felt by every strain before it. But "
        "a strain acts on all that lies beyond it through one rigid motion, so blocks away from "
        "the diagonal have a small rank, that of a twist and of the strains of the node that two "
        "elements share. A recursion from node to node that carries a matrix of that size factors "
        "the same tangent, with the same pivots:",
        made,
        f"Multiplications of the recursion: {'; '.join(fits)}, against DOF^3 of the dense one. "
        "Times are those of LAPACK and of NumPy's small products, whose cost is the calls; "
        "the last column compares the solutions. The engine factorises densely, which is faster "
        "at the sizes of design studies.",
    ]
    return section


REPEATS = 5


def repeated(work: object) -> None:
    """Do a work a few times."""
    assert callable(work)
    for _ in range(REPEATS):
        work()


def tangent(model: Model) -> tuple[Array, int]:
    """Return the tangent of the rod's strains at 5 N, scaled, node by node, and the nodes."""
    path = model.equilibrium([0.0, 5.0])
    full = model.engine.tangent(model.parameters, path.q[-1], [5.0])
    names = model.engine.coordinates
    strains = [i for i, name in enumerate(names) if name.endswith("]")]
    strains.sort(key=lambda i: int(names[i].split("[")[1][:-1]))
    chosen = full[np.ix_(strains, strains)]
    scale = 1.0 / np.sqrt(np.diag(chosen))
    modes = len({names[i].split("[")[0] for i in strains})
    return np.asarray(scale[:, None] * chosen * scale), len(strains) // modes


def generators(matrix: Array, nodes: int) -> Generators:
    """Find the generators of a symmetric matrix by singular values from the first node outward."""
    m = len(matrix) // nodes
    u, w, v = [], [], [np.zeros((m, 0))]
    rest, rank = np.zeros((0, len(matrix))), 0
    for k in range(nodes):
        here = slice(k * m, (k + 1) * m)
        if k:
            v.append(rest[:, :m].T)
            rest = rest[:, m:]
        rows = np.vstack([rest, matrix[here, (k + 1) * m :]]) if k else matrix[here, m:]
        left, values, right = np.linalg.svd(rows, full_matrices=False)
        kept = int((values > TOLERANCE).sum())
        w.append(left[:rank, :kept])
        u.append(left[rank:, :kept])
        rest, rank = values[:kept, None] * right[:kept], kept
    blocks = [matrix[k * m : (k + 1) * m, k * m : (k + 1) * m] for k in range(nodes)]
    return Generators(blocks, u, w, v)


def solve(of: Generators, load: Array) -> Array:
    """Solve by block elimination, carrying the Schur complement's part of small rank.

    After the nodes before k are eliminated, H_ij has become H_ij - V_i … P … V_jᵀ.
    """
    m = len(of.diagonal[0])
    p, carried = np.zeros((0, 0)), np.zeros(0)
    steps = []
    for k, (block, u, w, v) in enumerate(zip(of.diagonal, of.u, of.w, of.v, strict=True)):
        vp = v @ p
        lower = np.linalg.cholesky(block - vp @ v.T)
        row = u - vp @ w
        right = load[k * m : (k + 1) * m] - v @ carried
        both = np.linalg.solve(lower, np.column_stack([row, right]))
        half, y = both[:, :-1], both[:, -1]
        p = w.T @ p @ w + half.T @ half
        carried = w.T @ carried + half.T @ y
        steps.append((lower, half, y))
    result = np.empty(len(load))
    beyond = np.zeros(0)
    for k in range(len(steps) - 1, -1, -1):
        lower, half, y = steps[k]
        x = np.linalg.solve(lower.T, y - half @ beyond)
        result[k * m : (k + 1) * m] = x
        beyond = of.v[k].T @ x + of.w[k] @ beyond
    return result


if __name__ == "__main__":
    main()
