"""An objective as a plain function of the parameters, with its exact gradient."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from os import PathLike
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from flexor.design import ParameterSet
from flexor.errors import InputError
from flexor.objectives import Objective
from flexor.study.problem import FloatArray, Problem

if TYPE_CHECKING:
    from flexor.model import Model


@dataclass(frozen=True, eq=False)
class ObjectiveGradients:
    """Objective values of n designs with their gradients, and how far these hold."""

    value: FloatArray  # (n,); +inf where the design failed
    gradient: FloatArray  # (n, k), per SI unit; NaN where the design failed
    # (n,), ``"regular"`` or why the gradient is less; see `flexor.model.Paths`
    regularity: NDArray[np.object_]
    reason: NDArray[np.object_]  # (n,), of the failure; empty if there is none

    @property
    def meaningful(self) -> NDArray[np.bool_]:
        """Where the value is smooth and the gradient is its slope, (n,).

        Elsewhere the path snapped (the gradient is that of the branch on which it ended), a sphere
        is at the threshold of contact, the stiffness is nearly singular, or the design failed.
        """
        return np.asarray((self.regularity == "regular") & np.isfinite(self.value))


@dataclass(frozen=True, eq=False)
class ObjectiveFunction:
    """From parameters to value and gradient, as ``scipy.optimize`` takes it with ``jac=True``.

    Made by `objective_function`.
    """

    problem: Problem
    failed: float  # value of designs that fail, with a gradient of zero

    def __call__(self, p: ArrayLike) -> tuple[float, FloatArray]:
        """Value and gradient (k,) at parameters (k,), SI; InputError if there are not k."""
        found = self.evaluate(np.atleast_1d(np.asarray(p, dtype=np.float64))[None, :])
        if not np.isfinite(found.value[0]):
            return self.failed, np.zeros(found.gradient.shape[1])
        return float(found.value[0]), found.gradient[0]

    def evaluate(self, designs: ArrayLike, threads: int = 0) -> ObjectiveGradients:
        """Evaluate designs (n, k), SI: values, gradients and their regularity.

        The engine uses one thread per core if ``threads`` is 0. InputError if there are not k
        columns.
        """
        vectors = np.atleast_2d(np.asarray(designs, dtype=np.float64))
        paths = self.problem.evaluate(vectors, threads, gradient=True)
        gradient = self.problem.gradients(paths)
        return ObjectiveGradients(paths.value, gradient, paths.regularity, paths.reason)

    @property
    def start(self) -> FloatArray:
        """Where the parameter set starts, (k,), SI."""
        return self.problem.parameters.start

    @property
    def bounds(self) -> list[tuple[float, float]]:
        """Lower and upper bound of each parameter, SI."""
        chosen = self.problem.parameters
        return list(zip(chosen.lower.tolist(), chosen.upper.tolist(), strict=True))


def objective_function(
    model: Model | str | PathLike[str],
    parameters: str | ParameterSet = "L+R01",
    objective: str | Objective = "bending",
    *,
    force: Any = None,
    failed: float = 1e3,
    engine_options: Mapping[str, float] | None = None,
) -> ObjectiveFunction:
    """Make a function with an exact gradient, for any optimiser.

    Parameters
    ----------
    model, parameters, objective, force, engine_options
        As for `flexor.optimize`; f_bc is differentiated with its count of contacts held.
    failed : float
        Value returned for designs that fail.

    Returns
    -------
    ObjectiveFunction
        To be called with (k,) parameters; `ObjectiveFunction.evaluate` takes many designs at once
        and reports the regularity of their gradients. Designs outside `ObjectiveFunction.bounds`
        are evaluated like any other.

    Raises
    ------
    InputError
        If a name is not known or the objective has no gradient.

    Examples
    --------
    >>> import flexor
    >>> from scipy.optimize import minimize
    >>> function = flexor.objective_function(flexor.load("finger"), "L", "f_b")
    >>> found = minimize(function, function.start, jac=True, bounds=function.bounds)
    >>> bool(found.fun < function(function.start)[0])
    True
    >>> function.evaluate([[0.09], [0.10]]).gradient.shape
    (2, 1)
    """
    problem = Problem.of(model, parameters, objective, force, options=engine_options)
    if not problem.objective.differentiable:
        raise InputError(f'objective "{problem.objective.name}" has no gradient.')
    return ObjectiveFunction(problem, float(failed))
