"""Sequential quadratic programming in the unit box, with constraints."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from flexor.optimizers.interface import FloatArray
from flexor.optimizers.method import Run

# Constraints are kept with this margin, in units of their bounds, so that where they are active
# rounding does not break them.
MARGIN = 1e-7
# Value of a design that failed: worse than any.
FAILED = 1e6


@dataclass(frozen=True)
class Linearization:
    """Values of m functions and c excesses of constraints at a point (k,), with their slopes."""

    values: FloatArray  # (m,), FAILED where a design failed
    gradients: FloatArray  # (m, k), zero where unknown
    excesses: FloatArray  # (c,), kept where not above 0
    slopes: FloatArray  # (c, k)


Linearize = Callable[[FloatArray], Linearization]
Evaluate = Callable[[FloatArray], tuple[FloatArray, FloatArray]]


def differences(evaluate: Evaluate, point: FloatArray, difference: float) -> Linearization:
    """Linearize at a point (k,) by one batch of one-sided differences, backwards at upper bounds.

    ``evaluate`` maps points (n, k) to values (n,) or (n, m) and excesses (n, c).
    """
    steps = np.where(point + difference > 1.0, -difference, difference)
    values, excesses = evaluate(np.concatenate((point[None, :], point + np.diag(steps))))
    values = values[:, None] if values.ndim == 1 else values
    with np.errstate(invalid="ignore"):
        gradients = ((values[1:] - values[0]) / steps[:, None]).T
        slopes = ((excesses[1:] - excesses[0]) / steps[:, None]).T
    return Linearization(
        np.where(np.isfinite(values[0]), values[0], FAILED),
        _finite(gradients),
        np.nan_to_num(excesses[0], nan=1.0),
        _finite(slopes),
    )


def linearization(run: Run, point: FloatArray, difference: float) -> Linearization:
    """Linearize at a point (k,) exactly or, where something has no derivative, by differences."""
    return linearizations(run, [point], difference)[0]


def linearizations(
    run: Run, points: Sequence[FloatArray], difference: float
) -> list[Linearization]:
    """Linearize at several points (k,), exactly in one batch or each by differences."""
    exact = run.linearized(np.stack(points))
    if exact is None:
        return [differences(run.constrained, point, difference) for point in points]
    values, excesses, gradients, slopes = exact
    return [
        Linearization(
            np.where(np.isfinite(values[i : i + 1]), values[i : i + 1], FAILED),
            _finite(gradients[i : i + 1]),
            np.nan_to_num(excesses[i], nan=1.0),
            _finite(slopes[i]),
        )
        for i in range(len(points))
    ]


def minimize_slsqp(
    start: FloatArray,
    linearize: Linearize,
    iterations: int,
    tolerance: float = 1e-9,
    step: Callable[[str], None] = lambda _: None,
) -> FloatArray:
    """Minimise the first of the values from a point (k,) with SLSQP; return where it ends (k,).

    ``step`` is called after each iteration.
    """
    at = _remembered(linearize)
    first = at(start)
    # SLSQP compares the value with its tolerance and with the constraints, whatever its unit.
    sizes = (abs(float(first.values[0])), float(np.abs(first.gradients[0]).max(initial=0.0)))
    size = max(sizes) if 0.0 < max(sizes) < FAILED else 1.0

    def value(point: FloatArray) -> tuple[float, FloatArray]:
        found = float(at(point).values[0])
        return found if found == FAILED else found / size, at(point).gradients[0] / size

    return _slsqp(
        start,
        len(start),
        value,
        lambda point: (at(point).excesses, at(point).slopes),
        iterations,
        tolerance,
        step,
    )


def achieve(
    run: Run,
    start: FloatArray,
    linearize: Linearize,
    aim: FloatArray,
    scale: FloatArray,
    iterations: int,
    augmentation: float = 1e-3,
) -> FloatArray:
    """Go from a point (k,) as far beyond an aim (m,) as all values allow; return the end (k,).

    The achievement scalarising function (Wierzbicki 1980), max_i (f_i - aim_i) / scale_i plus a
    small share of the sum, is minimised in its smooth form: its maximum is a variable above all.
    """
    at = _remembered(linearize)

    def value(point: FloatArray) -> tuple[float, FloatArray]:
        found = at(point[:-1])
        share = augmentation / scale
        slope = np.append(share @ found.gradients, 1.0)
        return float(point[-1] + share @ (found.values - aim)), slope

    def bounds(point: FloatArray) -> tuple[FloatArray, FloatArray]:
        found = at(point[:-1])
        short = (found.values - aim) / scale - point[-1]
        slopes = np.column_stack((found.gradients / scale[:, None], -np.ones(len(aim))))
        kept = np.column_stack((found.slopes, np.zeros(len(found.excesses))))
        return np.concatenate((short, found.excesses)), np.concatenate((slopes, kept))

    first = float(np.max((at(start).values - aim) / scale))
    whole = np.append(start, first)
    end = _slsqp(whole, len(start), value, bounds, iterations, 1e-6, run.step)
    return end[:-1]


def _slsqp(
    start: FloatArray,
    k: int,
    value: Callable[[FloatArray], tuple[float, FloatArray]],
    bounds: Callable[[FloatArray], tuple[FloatArray, FloatArray]],
    iterations: int,
    tolerance: float,
    step: Callable[[str], None],
) -> FloatArray:
    """Run SLSQP (Kraft 1988); variables after the first k of the unit box are free."""
    from scipy.optimize import minimize

    inequality = {
        "type": "ineq",
        "fun": lambda point: -bounds(point)[0] - MARGIN,
        "jac": lambda point: -bounds(point)[1],
    }
    free = len(start) - k
    result = minimize(
        value,
        start,
        jac=True,
        method="SLSQP",
        bounds=[(0.0, 1.0)] * k + [(None, None)] * free,
        constraints=[inequality] if bounds(start)[0].size else [],
        options={"maxiter": iterations, "ftol": tolerance},
        callback=lambda _: step("SQP"),
    )
    end = np.asarray(result.x, dtype=np.float64)
    end[:k] = np.clip(end[:k], 0.0, 1.0)
    return end


def _remembered(linearize: Linearize) -> Linearize:
    seen: dict[bytes, Linearization] = {}

    def at(point: FloatArray) -> Linearization:
        inside = np.clip(point, 0.0, 1.0)
        key = inside.tobytes()
        if key not in seen:
            seen[key] = linearize(inside)
        return seen[key]

    return at


def _finite(slopes: FloatArray) -> FloatArray:
    return np.where(np.isfinite(slopes), slopes, 0.0)
