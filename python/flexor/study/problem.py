"""What a study evaluates: designs of a parameter set on a model, by an objective."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from flexor.design import Geometry, ParameterSet
from flexor.model.chunks import chunks
from flexor.model.results import Path, Paths
from flexor.objectives import Objective, evaluate_objective

if TYPE_CHECKING:
    from flexor.model import Model

FloatArray = NDArray[np.float64]


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

    def evaluate(self, designs: FloatArray, threads: int = 0, gradient: bool = False) -> Paths:
        """Follow the paths of n designs and evaluate the objective.

        Parameters
        ----------
        designs : (n, k) array
            Designs, SI.
        threads : int
            Threads of the engine, 0 for one per core. The results do not depend on it.
        gradient : bool
            Whether to differentiate as well, exactly.

        Returns
        -------
        Paths
            Those arrays that a study records, in the order of the designs. A design whose surface
            is not positive, or whose path did not converge, is marked failed with the reason.
        """
        parts = [self._evaluate(designs[c], threads, gradient) for c in chunks(len(designs))]
        return Paths.concatenate(parts)

    def residuals(self, paths: Paths) -> FloatArray:
        """Vectors whose norms are the objective's values, for least squares.

        Parameters
        ----------
        paths : Paths
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
        vectors = self.objective.residual(self._complete(paths))
        return np.where(np.isfinite(paths.value)[:, None], vectors, np.nan)

    def gradients(self, paths: Paths) -> FloatArray:
        """Gradients of the objective's values with respect to the parameters.

        Parameters
        ----------
        paths : Paths
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
        found = self.objective.gradient(self._complete(paths)).chained(paths.derivatives)
        return np.where(np.isfinite(paths.value)[:, None], found, np.nan)

    def jacobians(self, paths: Paths) -> FloatArray:
        """Jacobians of `residuals` with respect to the parameters.

        Parameters
        ----------
        paths : Paths
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
        found = self.objective.residual_gradient(self._complete(paths))
        chained = found.chained(paths.derivatives)
        return np.where(np.isfinite(paths.value)[:, None, None], chained, np.nan)

    def path(self, design: FloatArray) -> Path:
        """Follow the path of one design (k,) and keep all of it."""
        options: dict[str, Any] = dict(self.options)
        return self.model.equilibrium(self.force, design=self.geometry(design[None, :]), **options)

    def _complete(self, paths: Paths) -> Paths:
        """Give recorded paths the model and loads that objectives ask for."""
        return replace(paths, model=self.model, loads=self.force[:, None])

    def _evaluate(self, designs: FloatArray, threads: int, gradient: bool) -> Paths:
        geometry = self.geometry(designs)
        valid = np.isfinite(geometry.length) & (geometry.length > 0.0)
        valid &= np.all(np.isfinite(geometry.radius) & (geometry.radius > 0.0), axis=1)
        valid &= np.all(np.isfinite(geometry.slope), axis=1)
        every = Paths.failed(
            len(designs),
            self.force.size,
            len(self.model.joints),
            "has a length or radius that is not positive",
            self.parameters.size if gradient else None,
        )
        if not valid.any():
            return every
        chosen = Geometry(geometry.length[valid], geometry.radius[valid], geometry.slope[valid])
        paths = self.model.evaluate(chosen, self.force, threads, gradient=gradient, **self.options)
        evaluate_objective(self.objective, paths).scatter(every, np.flatnonzero(valid))
        if gradient:
            jacobian = self.parameters.jacobian(designs[valid], self.model.design.points)
            every.derivatives[valid] = paths.chained(jacobian)
        return every
