"""Levenberg-Marquardt on the vector behind the objective, the paper's other method ("LS")."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from flexor.optimizers.interface import FloatArray
from flexor.optimizers.method import Method, Run
from flexor.optimizers.options import require

LARGEST_DAMPING = 1e12


@dataclass
class Descent:
    """One start of the search: where it is, and how it steps.

    Attributes
    ----------
    point : (k,) array
        In the unit box.
    vector : (r,) array
        Its residual; NaN if it failed.
    damping : float
        Of the next step.
    jacobian : (r, k) array or None
        At the point, in the unit box; None until it is known.
    done : str
        Empty, or why it has ended.
    """

    point: FloatArray
    vector: FloatArray
    damping: float
    jacobian: FloatArray | None = None
    done: str = ""


@dataclass(frozen=True)
class LevenbergMarquardt(Method):
    """Least squares on the objective's vector, such as q_b of f_b (13).

    Each iteration solves (J^T J + damping I) step = -J^T r in the unit box for the parameters that
    are not held at a bound (Marquardt's damping times 1/10 after a step that lowers the norm and
    times 10 after one that does not, as in the paper's toolbox), clips the step to the bounds and
    evaluates it. J is the function's own Jacobian if it has one, else one-sided differences, turned
    inwards at an upper bound; a parameter whose difference fails is held for that iteration.

    Several starts descend side by side: their steps are one batch, and so are their differences.

    Attributes
    ----------
    starts : int
        Number of starts, the given ones included.
    difference : float
        Step of the differences as a fraction of the range of each parameter: above the square root
        of the solver's precision, below the width of the landscape's bumps.
    damping : float
        At first.
    tolerance : float
        A start is done when its step, as a fraction of the ranges, or the slope of its norm falls
        below this.
    iterations : int
        At most so many.
    """

    gradients: ClassVar[bool] = True

    starts: int = 1
    difference: float = 1e-6
    damping: float = 1e-2
    tolerance: float = 1e-6
    iterations: int = 400

    def __post_init__(self) -> None:
        """Check the options.

        Raises
        ------
        InputError
            If one is out of its range.
        """
        for option, inside, allowed in (
            ("starts", self.starts >= 1, "at least 1"),
            ("difference", 0.0 < self.difference <= 0.1, "above 0 and at most 0.1"),
            ("damping", 0.0 < self.damping < np.inf, "above 0"),
            ("tolerance", 0.0 < self.tolerance < 1.0, "between 0 and 1"),
            ("iterations", self.iterations >= 1, "at least 1"),
        ):
            require(self.name, option, getattr(self, option), inside, allowed)

    @property
    def name(self) -> str:
        """``"levenberg-marquardt"``."""
        return "levenberg-marquardt"

    def run(self, run: Run) -> str:
        """Descend from every start until each is done."""
        points = run.starts(self.starts, np.random.default_rng(run.seed))
        descents = [
            Descent(point, vector, self.damping, done="" if np.isfinite(vector).all() else "failed")
            for point, vector in zip(points, run.residuals(points), strict=True)
        ]
        run.step("start")
        for _ in range(self.iterations):
            active = [each for each in descents if not each.done]
            if not active:
                break
            self._differentiate(run, [each for each in active if each.jacobian is None])
            stepping = [(each, self._trial(each)) for each in active]
            going = [(each, trial) for each, trial in stepping if trial is not None]
            if going:
                vectors = run.residuals(np.array([trial for _, trial in going]))
                for (each, trial), vector in zip(going, vectors, strict=True):
                    self._move(each, trial, vector)
            run.step(f"damping {max(each.damping for each in active):.1g}")
        ends = [each.done or f"{self.iterations} iterations" for each in descents]
        if all(end == "failed" for end in ends):
            return "no start succeeded" if len(ends) > 1 else "the start failed"
        return "; ".join(dict.fromkeys(end for end in ends if end != "failed"))

    def _differentiate(self, run: Run, descents: list[Descent]) -> None:
        if not descents:
            return
        points = np.array([each.point for each in descents])
        exact = run.jacobian(points)
        if exact is None:
            k = run.size
            signs = np.where(points + self.difference > 1.0, -1.0, 1.0)
            shifted = points[:, None, :] + self.difference * signs[:, None, :] * np.eye(k)
            vectors = run.residuals(shifted.reshape(-1, k)).reshape(len(points), k, -1)
            change = vectors - np.array([each.vector for each in descents])[:, None, :]
            exact = np.swapaxes(change / (self.difference * signs[:, :, None]), 1, 2)
        for each, jacobian in zip(descents, exact, strict=True):
            each.jacobian = np.where(np.isfinite(jacobian).all(axis=0), jacobian, 0.0)

    def _trial(self, each: Descent) -> FloatArray | None:
        """Return where to step, or None (and done) if there is nowhere to."""
        assert each.jacobian is not None
        slope = each.jacobian.T @ each.vector
        held = ((each.point <= 0.0) & (slope > 0.0)) | ((each.point >= 1.0) & (slope < 0.0))
        free = np.flatnonzero(~held)
        steepness = np.linalg.norm(slope[free]) / max(float(np.linalg.norm(each.vector)), 1e-300)
        if steepness < self.tolerance:
            each.done = f"the slope is below {self.tolerance:g}"
            return None
        columns = each.jacobian[:, free]
        normal = columns.T @ columns + each.damping * np.eye(free.size)
        trial = each.point.copy()
        trial[free] = np.clip(trial[free] - np.linalg.solve(normal, slope[free]), 0.0, 1.0)
        if np.linalg.norm(trial - each.point) < self.tolerance or each.damping > LARGEST_DAMPING:
            each.done = f"the step is below {self.tolerance:g}"
            return None
        return trial

    def _move(self, each: Descent, trial: FloatArray, vector: FloatArray) -> None:
        # Not lower: also where the trial failed and its vector is NaN.
        if np.linalg.norm(vector) < np.linalg.norm(each.vector):
            each.point, each.vector, each.jacobian = trial, vector, None
            each.damping = max(each.damping / 10.0, 1e-12)
        else:
            each.damping *= 10.0
