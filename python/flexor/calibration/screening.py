"""The global search: a Sobol sequence in the ranges, whose best points start local fits."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from flexor.arrays import Array
from flexor.calibration.evaluator import Evaluator
from flexor.errors import InputError

_BATCH = 256  # points evaluated before the threshold of the misfit is updated
_START_SEPARATION = 0.05  # in parts of a range, in at least one constant
_CANDIDATES_PER_START = 4  # candidates kept, so that enough of them are distinct


def default_samples(constants: int) -> int:
    """Return the default number of points for a number of constants."""
    return int(min(4096, 256 * 2**constants))


def screen(
    evaluator: Evaluator,
    samples: int,
    starts: int,
    seed: int,
    report: Callable[[int, float], None],
) -> Array:
    """Find good starts, (s, c) points of the unit cube that differ, the best first.

    The points are a Sobol sequence of `samples`, scrambled by `seed`; `report` is called with the
    number of points evaluated and the lowest misfit.

    Notes
    -----
    Paths are evaluated one after the other, and a point is dropped as soon as its misfit exceeds
    that of the points that can still become starts; no start is lost by this.
    """
    problem = evaluator.problem
    points = _sobol(samples, len(problem.constants), seed)
    paths = problem.path_runs
    optima = [run for run in problem.fitted_runs if run not in paths]
    misfit = np.full(samples, np.inf)
    for first in range(0, samples, _BATCH):
        rows = slice(first, first + _BATCH)
        known = np.sort(misfit[:first])[: _CANDIDATES_PER_START * starts]
        worst = float(known[-1]) if len(known) == _CANDIDATES_PER_START * starts else np.inf
        misfit[rows] = evaluator.misfit(points[rows], paths, worst)
        report(min(first + _BATCH, samples), float(misfit.min()))
    if optima:  # searched for at the points that are best without; the others are dropped
        order = np.argsort(misfit, kind="stable")[: 2 * starts]
        without, misfit = misfit, np.full(samples, np.inf)
        for row in order[np.isfinite(without[order])]:
            misfit[row] = without[row] + evaluator.misfit(points[[row]], optima)[0]
            report(samples, float(misfit.min()))
    order = np.argsort(misfit, kind="stable")
    chosen: list[int] = []
    for row in order[np.isfinite(misfit[order])]:
        if all(np.max(np.abs(points[row] - points[other])) > _START_SEPARATION for other in chosen):
            chosen.append(int(row))
        if len(chosen) == starts:
            break
    if not chosen:
        raise InputError(
            f"none of {samples} points in the ranges of the constants gives equilibria for all "
            "targets: change the ranges or try more samples."
        )
    return points[chosen]


def _sobol(samples: int, dimensions: int, seed: int) -> Array:
    from scipy.stats import qmc

    power = int(np.ceil(np.log2(max(samples, 1))))
    sobol = qmc.Sobol(dimensions, scramble=True, seed=np.random.default_rng(seed))
    return np.asarray(sobol.random_base2(power)[:samples])
