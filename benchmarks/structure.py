"""What the tangent of a rod is made of, and what using it would give at many degrees of freedom.

The twist of every section adds to that of all sections beyond it, so each strain acts on all loads
further out and the tangent is full. But it acts on them through one rigid motion of the rest of the
rod: a block of the tangent that couples the strains of one part with those of the part beyond it
has a small rank, whatever the number of elements. Measured here are that rank (singular values
above 1e-9, with a diagonal of ones), and the time of one factorisation and solution of the engine's
own tangents: densely, as the engine does it, against a recursion from node to node that carries a
matrix of that rank outward. Both are compiled from `_recursion.c` and need a C compiler.
"""

from __future__ import annotations

import argparse
import ctypes
import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Callable
from functools import partial
from pathlib import Path

import numpy as np
from _rods import finger, spatial_rod
from _section import Missing, Section, table
from _timing import by_turns, enough, exponent
from numpy.typing import NDArray

from flexor.model import Model

Array = NDArray[np.float64]
ELEMENTS = {
    "exosuit, finger held": (finger, (10, 20, 40, 80, 160, 320, 498)),
    "rod in space": (spatial_rod, (3, 7, 15, 31, 63, 127, 166)),
}
QUICK_ELEMENTS = 5  # of each
TOLERANCE = 1e-9
MANY = 5
SOURCE = Path(__file__).with_name("_recursion.c")


def main() -> int:
    """Measure, and print the table."""
    reading = argparse.ArgumentParser(description=__doc__)
    reading.add_argument("--runs", type=int, default=3, help="of which medians are shown")
    reading.add_argument("--quick", action="store_true", help="smaller sizes")
    asked = reading.parse_args()
    try:
        section = measure(asked.runs, quick=asked.quick)
    except Missing as missing:
        print(f"error: {missing}", file=sys.stderr)
        return 2
    section.report()
    return 0


def measure(runs: int, *, quick: bool) -> Section:
    """Measure everything, and write it up."""
    made = table("model", "DOF", "rank", "dense / µs", "recursion / µs", "ratio", "difference")
    fits = []
    for name, (make, elements) in ELEMENTS.items():
        sizes, slow, fast = [], [], []
        for i, count in enumerate(elements[:QUICK_ELEMENTS] if quick else elements):
            matrix, nodes = tangent(make(count))
            n, chain, rank = len(matrix), *packed(matrix, nodes)
            dense, recursion = compiled(matrix, chain, nodes, rank)
            often = [MANY * enough(partial(work, MANY)) for work in (dense, recursion)]
            works = {
                "dense": partial(dense, often[0]),
                "recursion": partial(recursion, often[1]),
            }
            times = by_turns(works, runs, f"{name}, {n} DOF")
            exact, found = dense(1), recursion(1)
            sizes.append(n)
            slow.append(times["dense"].median / often[0])
            fast.append(times["recursion"].median / often[1])
            made.add_row(
                "" if i else name,
                f"{n:,}",
                str(rank),
                f"{1e6 * slow[-1]:,.2f}",
                f"{1e6 * fast[-1]:,.2f}",
                f"{slow[-1] / fast[-1]:,.1f}",
                f"{np.abs(found - exact).max() / np.abs(exact).max():.0e}",
            )
        powers = [exponent(sizes[2:], costs[2:]) for costs in (slow, fast)]
        fits.append(f"{name}: DOF^{powers[0]:.2f} densely, DOF^{powers[1]:.2f} by the recursion")
    section = Section("Structure of the tangent", "./dev bench structure" + " --quick" * quick)
    section.parts += [
        "The tangent of a rod is full: what acts on its tip is felt by every strain before it. But "
        "a strain acts on all that lies beyond it through one rigid motion, so the blocks beyond "
        "its diagonal have a small *rank*, whatever the number of elements: at most that of a "
        "twist (3 in the plane, 6 in space) and of the strains of the node that two elements share "
        "(2 and 6 here), less where the loads leave some twists free. A "
        "recursion from node to node that carries a matrix of that size factorises the same matrix "
        "with the same pivots, so it tells a tangent that is not positive definite just as well. "
        "One factorisation and solution of the engine's own tangents at 5 N, densely as the engine "
        "does it and by the recursion:",
        made,
        f"From the third size on the time grows as {'; '.join(fits)}. The *difference* is that of "
        "the solutions.",
        "The engine assembles and factorises densely. The numbers the recursion takes are "
        "there before the assembly multiplies them out: the columns of each Magnus step, and sums "
        "of wrenches and stiffness forms over all that each step carries. Contact with another "
        "chain adds as many dense columns as that chain has coordinates; contact of a rod with "
        "itself adds up to 2 (3 in space) to the rank for each touching pair. Polynomials along "
        "the whole rod have no such structure, and few coordinates.",
    ]
    return section


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


def packed(matrix: Array, nodes: int) -> tuple[Array, int]:
    """Find H_ij = U_i W_{i+1} … W_{j-1} V_jᵀ (i < j) by singular values, from the first node on.

    Returns
    -------
    chain : (nodes, numbers) array
        What `_recursion.c` calls a node, of each.
    rank : int
        The largest of any block beyond the diagonal.
    """
    m = len(matrix) // nodes
    u, w, v = [], [], [np.zeros((m, 0))]
    rest, rank = np.zeros((0, len(matrix))), 0
    for k in range(nodes):
        if k:
            v.append(rest[:, :m].T)
            rest = rest[:, m:]
        rows = matrix[k * m : (k + 1) * m, (k + 1) * m :]
        left, values, right = np.linalg.svd(
            np.vstack([rest, rows]) if k else rows, full_matrices=False
        )
        kept = int((values > TOLERANCE).sum())
        w.append(left[:rank, :kept])
        u.append(left[rank:, :kept])
        rest, rank = values[:kept, None] * right[:kept], kept
    most = max(part.shape[1] for part in u)
    chain = np.zeros((nodes, 2 * m * m + 3 * m * most + most * most + m))
    for k, row in enumerate(chain):
        place = 0
        for part, shape in (
            (matrix[k * m : (k + 1) * m, k * m : (k + 1) * m], (m, m)),
            (u[k], (m, most)),
            (w[k], (most, most)),
            (v[k], (m, most)),
        ):
            block = row[place : place + shape[0] * shape[1]].reshape(shape)
            block[: part.shape[0], : part.shape[1]] = part
            place += block.size
    return chain, most


def compiled(
    matrix: Array, chain: Array, nodes: int, rank: int
) -> tuple[Callable[[int], Array], Callable[[int], Array]]:
    """Compile both ways; each solves so many times and returns the solution."""
    n = len(matrix)
    library = _library(n // nodes, rank)
    load = np.random.default_rng(0).standard_normal(n)
    found, factor, inverse = np.zeros(n), np.zeros((n, n)), np.zeros(n)
    matrix = np.ascontiguousarray(matrix)

    def at(array: Array) -> ctypes.c_void_p:
        return ctypes.c_void_p(array.ctypes.data)

    def dense(times: int) -> Array:
        work = at(matrix), at(factor), at(inverse), at(load), at(found)
        if not library.denses(times, n, *work):
            raise RuntimeError("the tangent is not positive definite")
        return found.copy()

    def recursion(times: int) -> Array:
        if not library.recursions(times, nodes, at(chain), at(load), at(found)):
            raise RuntimeError("the tangent is not positive definite")
        return found.copy()

    return dense, recursion


def _library(strains: int, rank: int) -> ctypes.CDLL:
    names = [os.environ.get("CC", "cc"), "cc", "gcc", "clang"]
    compiler = next((name for name in names if shutil.which(name)), None)
    if compiler is None:
        raise Missing("no C compiler found (cc, gcc or clang), with which both ways are compiled.")
    with tempfile.TemporaryDirectory() as folder:
        made = Path(folder) / f"recursion_{strains}_{rank}.so"
        sizes = (f"-DM={strains}", f"-DR={rank}")
        options = ("-O3", "-march=native", "-ffast-math", "-shared", "-fPIC")
        subprocess.run([compiler, *options, *sizes, SOURCE, "-o", made, "-lm"], check=True)
        return ctypes.CDLL(str(made))


if __name__ == "__main__":
    sys.exit(main())
