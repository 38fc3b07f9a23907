"""One evaluated design of a study."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from flexor.study.designed_model import designed_model
from flexor.study.problem import FloatArray, Problem
from flexor.study.sensitivity import Sensitivity
from flexor.study.verdict import Kept, Verdict, kept

if TYPE_CHECKING:
    from flexor.model import Model, Path, Paths


@dataclass(frozen=True, eq=False)
class Design:
    """A design and its results."""

    problem: Problem
    vector: FloatArray  # (k,), SI, in the order of the set's labels
    value: float  # the objective; +inf if the design failed
    shown: float  # its quantity for display; NaN if the design failed
    reason: str  # of the failure; empty if there is none
    joint_angles: FloatArray  # (steps, j), along the path [rad]
    tip_force: FloatArray  # (steps,), along the path [N]
    touching: FloatArray  # (steps,), spheres of the exosuit in contact
    events: int  # snaps and bifurcations along the path
    iterations: int  # Newton iterations along the path
    constraint_values: FloatArray  # (c,), worst along the path, SI
    violation: float  # how far constraints are exceeded; 0 if all are kept

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
            constraint_values=paths.constraint_values[row],
            violation=float(paths.violation[row]),
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
        """The complete path of equilibria, computed again."""
        return self.problem.path(self.vector)

    @cached_property
    def model(self) -> Model:
        """The model with this design in place of its own; ``model.to_toml()`` is its file."""
        return designed_model(self.problem, self.vector)

    @cached_property
    def sensitivity(self) -> Sensitivity:
        """Exact derivatives with respect to its parameters, evaluated again."""
        return Sensitivity.of(self.problem, self.vector)

    @property
    def feasible(self) -> bool:
        """Whether it keeps all constraints."""
        return self.violation == 0.0

    @cached_property
    def kept(self) -> tuple[Kept, ...]:
        """Its constraints as drawn, each where it is worst; evaluated again."""
        return tuple(kept(self))

    @property
    def has_verdict(self) -> bool:
        """Whether there is more to say of it than its value: of one observable it is the best."""
        return self.problem.objective.of_observable and not self.problem.objective.count

    @cached_property
    def verdict(self) -> Verdict:
        """Whether it can be worn and made, and how far to trust it; evaluated again."""
        return Verdict.of(self)

    def evaluate_verdict(self, progress: Callable[[str], None]) -> Verdict:
        """Evaluate the verdict, which takes a while, and call a function with each part of it."""
        if "verdict" not in self.__dict__:
            self.__dict__["verdict"] = Verdict.of(self, progress)
        return self.verdict

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
        problem = self.problem
        return self.reason or f"{problem.quantity} {self.shown:.4g} {problem.unit}".rstrip()

    def __repr__(self) -> str:
        return f"<Design {self.text}: {self.result}>"
