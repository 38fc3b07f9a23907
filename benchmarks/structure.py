"""Semiseparable structure of a rod's tangent, and its use at many degrees of freedom.

The tangent of a rod is dense, as every strain moves all loads distal to it. But it moves them as
one rigid body, so blocks that couple non-adjacent parts of the rod have at most the rank of a
twist, independent of the number of elements. This benchmark measures the rank for the engine's
tangents (singular values above 1e-9, with a unit diagonal), and compares the time of a dense
factorisation and solution by LAPACK with that of a whole iteration of the engine, which exploits
the structure.
"""

from __future__ import annotations

import argparse
import statistics
from functools import partial
from typing import Any

import numpy as np
from _rods import finger, spatial_rod, two_designs
from _section import Section, table
from _timing import Times, by_turns, enough, exponent, repeated
from numpy.typing import NDArray
from scipy.linalg import cho_factor, cho_solve

from flexor.model import Model

Array = NDArray[np.float64]
ELEMENTS = {
    "finger and exosuit": (finger, (10, 20, 40, 80, 160, 320, 498)),
    "rod in space": (spatial_rod, (3, 7, 15, 31, 63, 127, 166)),
}
QUICK_ELEMENTS = 5  # sizes per model with --quick
FORCE = 5.0  # N
TOLERANCE = 1e-9
CUTS = 5  # positions along a rod at which the rank is computed


def main() -> None:
    """Run the benchmark and print its report."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--runs", type=int, default=3, help="number of runs; medians are reported")
    parser.add_argument("--quick", action="store_true", help="smaller sizes")
    arguments = parser.parse_args()
    measure(arguments.runs, quick=arguments.quick).report()


def measure(runs: int, *, quick: bool) -> Section:
    """Run the benchmark and return its report."""
    result = table("model", "DOF", "rank", "LAPACK / µs", "iteration / µs", "ratio")
    fits = []
    for name, (make, elements) in ELEMENTS.items():
        sizes, dense, whole = [], [], []
        for i, count in enumerate(elements[:QUICK_ELEMENTS] if quick else elements):
            model = make(count)
            matrix = tangent(model)
            times = _times(model, matrix, runs, f"{name}, {model.dof} DOF")
            sizes.append(model.dof)
            dense.append(times[0])
            whole.append(times[1])
            result.add_row(
                "" if i else name,
                f"{model.dof:,}",
                str(rank(model, matrix)),
                f"{1e6 * dense[-1]:,.1f}",
                f"{1e6 * whole[-1]:,.1f}",
                f"{dense[-1] / whole[-1]:,.2f}",
            )
        powers = [exponent(sizes[2:], costs[2:]) for costs in (dense, whole)]
        fits.append(f"{name}: DOF^{powers[0]:.2f} for LAPACK, DOF^{powers[1]:.2f} for the engine")
    section = Section("Structure of the tangent", "./dev bench structure" + " --quick" * quick)
    section.parts += [
        "The tangent of a rod is dense, as every strain moves all loads distal to it. But it moves "
        "them as one rigid body, so blocks that couple non-adjacent nodes have at most the *rank* "
        "of a twist (3 in the plane, 6 in space), independent of the number of elements. From 96 "
        "strains on the engine assembles the generators of this structure only, and factorises by "
        "a recursion over the nodes with matrices of this size, whose pivots also reveal a tangent "
        "that is not positive definite. Time of one dense factorisation and solution by LAPACK "
        "(SciPy), compared with a whole iteration of the engine including kinematics, residual, "
        "assembly, prediction and tests (wall time; LAPACK may use all cores):",
        result,
        f"From the third size on, the time grows as {'; '.join(fits)}.",
        "Coordinates of other bodies, such as the finger's joints, form a border of dense rows. A "
        "rod in self-contact or with springs to bodies that it carries is assembled and factorised "
        "densely; so are rods with global polynomials, which have few coordinates.",
    ]
    return section


def rank(model: Model, tangent: Array) -> int:
    """Return the largest rank of any block that couples strains beyond neighbouring nodes."""
    names = model.engine.coordinates
    strains = [i for i, name in enumerate(names) if name.endswith("]")]
    strains.sort(key=lambda i: int(names[i].split("[")[1][:-1]))
    modes = len({names[i].split("[")[0] for i in strains})
    matrix = tangent[np.ix_(strains, strains)]
    nodes = len(strains) // modes
    cuts = np.unique(np.linspace(1, nodes - 2, CUTS).astype(int)) * modes
    blocks = (matrix[:cut, cut + modes :] for cut in cuts)
    return max(int((np.linalg.svd(b, compute_uv=False) > TOLERANCE).sum()) for b in blocks)


def tangent(model: Model) -> Array:
    """Return the tangent at the largest force, with a diagonal of ones."""
    path = model.equilibrium([0.0, FORCE])
    full = model.engine.tangent(model.parameters, path.q[-1], [FORCE])
    scale = 1.0 / np.sqrt(np.diag(full))
    return np.asarray(scale[:, None] * full * scale)


def _times(model: Model, tangent: Array, runs: int, description: str) -> tuple[float, float]:
    """Return the time of a dense factorisation and solution, and of a whole iteration [s]."""
    load = np.ones(model.dof)

    def dense() -> Any:
        return cho_solve(cho_factor(tangent, check_finite=False), load, check_finite=False)

    whole = partial(model.evaluate, two_designs(model), threads=1)
    iterations = int(whole().iterations.sum())
    often = [enough(dense), enough(whole)]
    works = {"dense": repeated(dense, often[0]), "whole": repeated(whole, often[1])}
    times = by_turns(works, runs, description)

    def one(found: Times, repeats: int) -> float:
        return statistics.median(found.wall) / repeats

    return one(times["dense"], often[0]), one(times["whole"], often[1]) / iterations


if __name__ == "__main__":
    main()
