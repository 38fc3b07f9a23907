"""Sensitivity of a design to small changes of its parameters and to manufacturing errors."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexor.study.problem import FloatArray, Problem

# Change of one parameter in a workshop unit, by its display unit: the text, and SI.
STEPS = {
    "m": ("1 mm", 1e-3),
    "cm": ("1 mm", 1e-3),
    "mm": ("0.1 mm", 1e-4),
    "rad": ("1°", np.pi / 180.0),
    "deg": ("1°", np.pi / 180.0),
    "1": ("0.01", 0.01),
}


def _step(unit: str, size: float) -> tuple[str, float]:
    """Return the change of a parameter with a unit: the text, and SI."""
    return STEPS.get(unit, (f"1 {unit}", size))


@dataclass(frozen=True, eq=False)
class Sensitivity:
    """Exact derivatives at a design, and its performance if a parameter is off."""

    labels: tuple[str, ...]  # of the k parameters
    steps: tuple[str, ...]  # changes in workshop units, for example ``"1 mm"``
    step: FloatArray  # (k,), the same in SI
    joint_angles: FloatArray  # (j, k), derivatives at the last load [rad per SI unit]
    tip_force: FloatArray  # (k,), derivative at the last load [N per SI unit]
    value: FloatArray | None  # (k,), of the objective; None if it has no gradient
    # Whether the derivatives hold; see `flexor.model.Paths`. The designs of `off` were evaluated
    # and hold in any case.
    regularity: str
    # (k, 2), the sum of the joint angles [rad] if one parameter is smaller, and if it is greater,
    # by its step; NaN where that design fails
    off: FloatArray
    bending: float  # the same for the design itself [rad]

    @classmethod
    def of(cls, problem: Problem, design: FloatArray) -> Sensitivity:
        """Evaluate a design (k,), SI, and those around it."""
        problem = problem.nominal
        chosen = problem.parameters
        texts, sizes = zip(*map(_step, chosen.units, chosen.scale), strict=True)
        step = np.array(sizes)
        here = problem.evaluate(design[None, :], gradient=True)
        # Manufacturing errors are not limited by the bounds of the search.
        around = design + np.concatenate((-np.diag(step), np.diag(step)))
        off = problem.evaluate(around)
        angles = off.joint_angles[:, -1].sum(axis=1)
        angles = np.where(np.isfinite(off.value), angles, np.nan)
        return cls(
            labels=chosen.labels,
            steps=texts,
            step=step,
            joint_angles=here.derivatives[0, :-1],
            tip_force=here.derivatives[0, -1],
            value=problem.gradients(here)[0] if problem.differentiable else None,
            regularity=str(here.regularity[0]),
            off=angles.reshape(2, -1).T,
            bending=float(here.joint_angles[0, -1].sum()),
        )

    @property
    def tolerance(self) -> FloatArray:
        """Largest loss of bending if one parameter is off by its step, either way, (k,) [rad].

        Zero where both ways gain; NaN where a design that is off fails.
        """
        return np.asarray(np.maximum((self.bending - self.off).max(axis=1), 0.0))
