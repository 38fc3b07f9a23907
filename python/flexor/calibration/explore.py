"""The global search: an even cover of the ranges, from which the best places go on."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from flexor.calibration.evaluate import Evaluator
from flexor.errors import InputError

Array = NDArray[np.float64]
_PART = 256
_APART = 0.05  # of a range, by which starts must differ in at least one constant
_SPARE = 4  # so many times the starts are looked at to the end, to have different ones among them


def default_samples(free: int) -> int:
    """Return how many points to try for so many free constants."""
    return int(min(4096, 256 * 2**free))


def explore(
    evaluator: Evaluator,
    samples: int,
    starts: int,
    seed: int,
    told: Callable[[int, float], None],
) -> Array:
    """Find the best places of the unit cube.

    Parameters
    ----------
    evaluator : Evaluator
        Of the variant.
    samples : int
        How many points to try, a scrambled Sobol sequence.
    starts : int
        How many places to return at most.
    seed : int
        Of the scrambling.
    told : callable
        Told how many points have been tried, and the lowest misfit.

    Returns
    -------
    (s, f) array
        Different places, the best first.

    Raises
    ------
    InputError
        If no point gives equilibria for all targets.

    Notes
    -----
    Targets are evaluated one path after the other, and a point is dropped as soon as the misfit of
    those seen exceeds that of the points that could still become starts: nothing is lost by it.
    """
    variant = evaluator.variant
    points = _sobol(samples, len(variant.free), seed)
    paths = variant.path_runs
    optima = [run for run in variant.fitted_runs if run not in paths]
    misfit = np.full(samples, np.inf)
    for first in range(0, samples, _PART):
        rows = slice(first, first + _PART)
        known = np.sort(misfit[:first])[: _SPARE * starts]
        worst = float(known[-1]) if len(known) == _SPARE * starts else np.inf
        misfit[rows] = evaluator.misfit(points[rows], paths, worst)
        told(min(first + _PART, samples), float(misfit.min()))
    if optima:
        misfit = _with_optima(evaluator, points, misfit, optima, starts, told)
    order = [int(row) for row in np.argsort(misfit, kind="stable") if np.isfinite(misfit[row])]
    if not order:
        name = evaluator.variant.name
        raise InputError(
            f"none of {samples} points in the ranges of the constants gives equilibria for all "
            f"targets{f' ({name})' if name else ''}: change the ranges or try more samples."
        )
    chosen: list[int] = []
    for row in order:
        if all(np.max(np.abs(points[row] - points[other])) > _APART for other in chosen):
            chosen.append(row)
        if len(chosen) == starts:
            break
    return points[chosen]


def _with_optima(
    evaluator: Evaluator,
    points: Array,
    misfit: Array,
    optima: list[int],
    starts: int,
    told: Callable[[int, float], None],
) -> Array:
    """Add what optima contribute, to the points that are best without; the others are dropped."""
    order = np.argsort(misfit, kind="stable")[: 2 * starts]
    order = order[np.isfinite(misfit[order])]
    whole = np.full_like(misfit, np.inf)
    for row in order:
        whole[row] = misfit[row] + evaluator.misfit(points[[row]], optima)[0]
        told(len(points), float(whole.min()))
    return whole


def _sobol(samples: int, dimensions: int, seed: int) -> Array:
    from scipy.stats import qmc

    power = int(np.ceil(np.log2(max(samples, 1))))
    sobol = qmc.Sobol(dimensions, scramble=True, seed=np.random.default_rng(seed))
    return np.asarray(sobol.random_base2(power)[:samples])
