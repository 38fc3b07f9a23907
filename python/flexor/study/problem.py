"""What a study evaluates: designs of a parameter set on a model, judged by an objective."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from flexor.design import Geometry, ParameterSet
from flexor.objectives import Objective, PathArrays, judge
from flexor.study.outcomes import FloatArray, Outcomes

if TYPE_CHECKING:
    from flexor.model import Batch, Model, Path

# Designs are evaluated and recorded in parts of this size: states and geometry are kept for no more
# of them, an interruption costs little, and each part still keeps every core busy.
PART = 1024


@dataclass(frozen=True, eq=False)
class Problem:
    """A model, what may be changed of it, and what is wanted.

    Searches, grids and comparisons all evaluate designs through this one function; an `Executor`
    says where that happens.

    Attributes
    ----------
    model : Model
        The model.
    parameters : ParameterSet
        What is designed, on the model's own rod.
    objective : Objective
        What is minimised.
    options : dict
        Settings of the engine's solver.
    """

    model: Model
    parameters: ParameterSet
    objective: Objective
    options: Mapping[str, float] = field(default_factory=dict)

    @property
    def force(self) -> FloatArray:
        """Actuation forces [N] of every path, (steps,): the objective's or else the model's."""
        if self.objective.force is not None:
            return np.array(self.objective.force)
        return np.asarray(self.model.evaluation_forces, dtype=np.float64)

    @property
    def sizes(self) -> tuple[int, int, int]:
        """Numbers of parameters, steps and joints."""
        return self.parameters.size, self.force.size, len(self.model.joints)

    def geometry(self, designs: FloatArray) -> Geometry:
        """Geometry of designs (n, k) at the model's sample points."""
        return self.parameters.geometry(designs, self.model.design.points)

    @property
    def differentiable(self) -> bool:
        """Whether the objective has a gradient."""
        return self.objective.differentiable

    def evaluate(self, designs: FloatArray, threads: int = 0, gradient: bool = False) -> Outcomes:
        """Follow and judge the paths of n designs.

        Parameters
        ----------
        designs : (n, k) array
            Designs, SI.
        threads : int
            Threads of the engine, 0 for one per core. The outcomes do not depend on it.
        gradient : bool
            Whether to differentiate as well, exactly.

        Returns
        -------
        Outcomes
            In the order of the designs. A design whose surface is not positive, or whose path
            did not converge, is marked failed with the reason.
        """
        outcomes = Outcomes.failed(
            len(designs),
            self.force.size,
            len(self.model.joints),
            "has a length or radius that is not positive",
            self.parameters.size if gradient else None,
        )
        for first in range(0, len(designs), PART):
            vectors = designs[first : first + PART]
            geometry = self.geometry(vectors)
            sound = np.isfinite(geometry.length) & (geometry.length > 0.0)
            sound &= np.all(np.isfinite(geometry.radius) & (geometry.radius > 0.0), axis=1)
            sound &= np.all(np.isfinite(geometry.slope), axis=1)
            rows = np.flatnonzero(sound)
            if rows.size:
                part = Geometry(geometry.length[rows], geometry.radius[rows], geometry.slope[rows])
                to_be_differentiated = vectors[rows] if gradient else None
                outcomes.fill(first + rows, self._follow(part, threads, to_be_differentiated))
        return outcomes

    def residuals(self, outcomes: Outcomes) -> FloatArray:
        """Vectors whose norms are the objective's values, for least squares.

        Parameters
        ----------
        outcomes : Outcomes
            Of n designs.

        Returns
        -------
        (n, r) array
            NaN where a design failed.

        Raises
        ------
        InputError
            If the objective is not the norm of a vector.
        """
        vectors = self.objective.residual(self._paths(outcomes))
        return np.where(np.isfinite(outcomes.value)[:, None], vectors, np.nan)

    def gradients(self, outcomes: Outcomes) -> FloatArray:
        """Gradients of the objective's values with respect to the parameters.

        Parameters
        ----------
        outcomes : Outcomes
            Of n designs, with their derivatives.

        Returns
        -------
        (n, k) array
            NaN where a design failed.

        Raises
        ------
        InputError
            If the objective has no gradient.
        """
        assert outcomes.derivatives is not None
        found = self.objective.gradient(self._paths(outcomes)).chained(outcomes.derivatives)
        return np.where(np.isfinite(outcomes.value)[:, None], found, np.nan)

    def jacobians(self, outcomes: Outcomes) -> FloatArray:
        """Jacobians of `residuals` with respect to the parameters.

        Parameters
        ----------
        outcomes : Outcomes
            Of n designs, with their derivatives.

        Returns
        -------
        (n, r, k) array
            NaN where a design failed.

        Raises
        ------
        InputError
            If the objective is not the norm of a vector with a gradient.
        """
        assert outcomes.derivatives is not None
        found = self.objective.residual_gradient(self._paths(outcomes))
        chained = found.chained(outcomes.derivatives)
        return np.where(np.isfinite(outcomes.value)[:, None, None], chained, np.nan)

    def path(self, design: FloatArray) -> Path:
        """Follow the path of one design (k,) and keep all of it."""
        return self.model.equilibrium(
            self.force, design=self.geometry(design[None, :]), **self.options
        )

    def _paths(self, outcomes: Outcomes) -> PathArrays:
        return PathArrays(
            force=self.force,
            joint_angles=outcomes.joint_angles,
            tip_force=outcomes.tip_force,
            touching=outcomes.touching,
            spheres=self.model.first_spheres,
            converged=outcomes.converged,
            stable=outcomes.stable,
        )

    def _follow(self, geometry: Geometry, threads: int, designs: FloatArray | None) -> Outcomes:
        """Follow and judge; differentiate with respect to the designs (n, k), if they are given."""
        differentiate = designs is not None
        batch: Batch = self.model.evaluate(
            geometry, self.force, threads, gradient=differentiate, **self.options
        )
        derivatives = None
        if designs is not None:
            points = self.model.design.points
            derivatives = batch.chained(self.parameters.jacobian(designs, points))
        paths = PathArrays.of(batch)
        judged = judge(self.objective, paths, lambda design, step: batch[design].status[step])
        return Outcomes(
            value=judged.value,
            shown=judged.shown,
            reason=np.array(judged.reason, dtype=object),
            joint_angles=paths.joint_angles,
            tip_force=paths.tip_force,
            touching=paths.touching.astype(np.int32),
            converged=paths.converged,
            stable=paths.stable,
            events=np.bincount(batch.events["design"], minlength=len(paths)).astype(np.int64),
            iterations=np.asarray(batch.iterations).sum(axis=1).astype(np.int64),
            derivatives=derivatives,
            regularity=batch.regularity if differentiate else None,
        )
