"""What evaluating a batch of designs gives, and everything that is recorded of it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields
from typing import Any

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Outcomes:
    """Outcomes of n designs over the load steps of their paths.

    Attributes
    ----------
    value : (n,) array
        Value of the objective; +inf where the design failed, never NaN.
    shown : (n,) array
        The objective's quantity for display; NaN where the design failed.
    reason : (n,) array of str
        Empty, or why the design failed.
    joint_angles : (n, steps, j) array
        [rad].
    tip_force : (n, steps) array
        [N].
    touching : (n, steps) array
        Spheres of the exosuit that touch.
    converged, stable : (n, steps) bool arrays
        How each step ended.
    events : (n,) array
        Snaps along the path.
    iterations : (n,) array
        Newton iterations along the path.
    derivatives : (n, j + 1, k) array or None
        If they were asked for: of the joint angles and, last, of the tip force at the last step
        with respect to the parameters; NaN where there is no equilibrium.
    regularity : (n,) array of str or None
        What these are worth, in the words of `flexor.model.Batch`.
    """

    value: FloatArray
    shown: FloatArray
    reason: NDArray[np.object_]
    joint_angles: FloatArray
    tip_force: FloatArray
    touching: NDArray[np.int32]
    converged: NDArray[np.bool_]
    stable: NDArray[np.bool_]
    events: NDArray[np.int64]
    iterations: NDArray[np.int64]
    derivatives: FloatArray | None = None
    regularity: NDArray[np.object_] | None = None

    @classmethod
    def failed(
        cls, n: int, steps: int, joints: int, reason: str, parameters: int | None = None
    ) -> Outcomes:
        """Outcomes of n designs of which nothing is known but why.

        With room for derivatives with respect to ``parameters`` of them, if that is given.
        """
        differentiated = parameters is not None
        return cls(
            value=np.full(n, np.inf),
            shown=np.full(n, np.nan),
            reason=np.full(n, reason, dtype=object),
            joint_angles=np.full((n, steps, joints), np.nan),
            tip_force=np.full((n, steps), np.nan),
            touching=np.zeros((n, steps), dtype=np.int32),
            converged=np.zeros((n, steps), dtype=np.bool_),
            stable=np.zeros((n, steps), dtype=np.bool_),
            events=np.zeros(n, dtype=np.int64),
            iterations=np.zeros(n, dtype=np.int64),
            derivatives=np.full((n, joints + 1, parameters or 0), np.nan)
            if differentiated
            else None,
            regularity=np.full(n, "no-equilibrium", dtype=object) if differentiated else None,
        )

    @classmethod
    def joined(cls, parts: Sequence[Outcomes]) -> Outcomes:
        """Outcomes one after another; all with derivatives or none."""
        columns: dict[str, Any] = {}
        for field in fields(cls):
            column = [getattr(part, field.name) for part in parts]
            columns[field.name] = None if column[0] is None else np.concatenate(column)
        return cls(**columns)

    def __len__(self) -> int:
        return int(self.value.size)

    def fill(self, rows: NDArray[np.intp], part: Outcomes) -> None:
        """Write the outcomes of some designs into their rows."""
        for field in fields(self):
            mine = getattr(self, field.name)
            if mine is not None:
                mine[rows] = getattr(part, field.name)
