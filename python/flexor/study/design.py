"""One evaluated design of a study."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from flexor.study.problem import FloatArray, Problem
from flexor.study.sensitivity import Sensitivity

if TYPE_CHECKING:
    from flexor.model import Path, Paths


@dataclass(frozen=True, eq=False)
class Design:
    """A design and its results.

    Attributes
    ----------
    problem : Problem
        The design problem.
    vector : (k,) array
        Parameters, SI, in the order of the set's labels.
    value, shown : float
        The objective, +inf if the design failed, and its quantity for display, NaN then.
    reason : str
        Reason of the failure; empty if there is none.
    joint_angles : (steps, j) array
        Along the path [rad].
    tip_force, touching : (steps,) arrays
        Tip force along the path [N], and spheres of the exosuit in contact.
    events, iterations : int
        Snaps and Newton iterations along the path.
    """

    problem: Problem
    vector: FloatArray
    value: float
    shown: float
    reason: str
    joint_angles: FloatArray
    tip_force: FloatArray
    touching: FloatArray
    events: int
    iterations: int

    @classmethod
    def of(cls, problem: Problem, vector: FloatArray, paths: Paths, row: int = 0) -> Design:
        """Take one design out of recorded paths."""
        return cls(
            problem=problem,
            vector=vector,
            value=float(paths.value[row]),
            shown=float(paths.shown[row]),
            reason=str(paths.reason[row]),
            joint_angles=paths.joint_angles[row],
            tip_force=paths.tip_force[row],
            touching=paths.touching[row].astype(np.float64),
            events=int(paths.event_count[row]),
            iterations=int(paths.total_iterations[row]),
        )

    @property
    def parameters(self) -> dict[str, float]:
        """Parameters by label, SI."""
        return dict(zip(self.problem.parameters.labels, self.vector.tolist(), strict=True))

    @property
    def bending(self) -> float:
        """Sum of the joint angles at the last load [rad]."""
        return float(sum(self.joint_angles[-1].tolist()))

    @cached_property
    def path(self) -> Path:
        """The complete path of equilibria, computed anew."""
        return self.problem.path(self.vector)

    @cached_property
    def sensitivity(self) -> Sensitivity:
        """Exact derivatives with respect to its parameters, evaluated anew."""
        return Sensitivity.of(self.problem, self.vector)

    @property
    def text(self) -> str:
        """Parameters in display units, such as ``"L = 8 cm, R_0 = 0.7 cm"``."""
        chosen = self.problem.parameters
        units = ["" if unit == "1" else f" {unit}" for unit in chosen.units]
        values = (self.vector / chosen.scale).tolist()
        cells = zip(chosen.labels, values, units, strict=True)
        return ", ".join(f"{label} = {value:.4g}{unit}" for label, value, unit in cells)

    @property
    def result(self) -> str:
        """The reason of its failure, or the displayed quantity such as ``"bending 0.8 rad"``."""
        objective = self.problem.objective
        return self.reason or f"{objective.quantity} {self.shown:.4g} {objective.unit}".rstrip()

    def __repr__(self) -> str:
        return f"<Design {self.text}: {self.result}>"
