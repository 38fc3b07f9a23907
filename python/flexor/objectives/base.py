"""Interface of objectives: a number to minimise for each of n paths."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from flexor.arrays import Array
from flexor.errors import InputError
from flexor.model.derivatives import Differential
from flexor.model.results import Paths
from flexor.objectives.gradient import PathGradient


@dataclass(frozen=True)
class Objective(ABC):
    """An objective, evaluated at the last of its loads.

    Attributes
    ----------
    name : str
        As written on the command line.
    quantity, unit : str
        Displayed quantity, for example ``"bending"`` in ``"rad"``; `shown` computes it.
    loads : tuple of tuples of float, or None
        Loads [N or Pa] of the path that is to be followed, a row a step and one for each input;
        None for those of the model's ``[evaluation]``, which are the paper's unless the file says
        otherwise: 0 to 5 N by 1 N.
    """

    name: str
    quantity: str
    unit: str
    loads: tuple[tuple[float, ...], ...] | None = None

    @abstractmethod
    def value(self, paths: Paths) -> Array:
        """Value to minimise, (n,); meaningless where `evaluate_objective` finds a failure."""

    @abstractmethod
    def shown(self, paths: Paths) -> Array:
        """Quantity for display, (n,), in `unit`."""

    @property
    def count(self) -> int:
        """How many objectives these are, if they are several; 0 for one."""
        return 0

    def values(self, paths: Paths) -> Array:
        """Return the values of several objectives, (n, m); (n, 0) for one."""
        return np.zeros((len(paths), 0))

    def displayed(self, value: Array) -> Array:
        """Return values for tables and figures: the quantity in `unit` where it alone decides."""
        return value

    def residual(self, paths: Paths) -> Array:
        """Vector (n, r) whose norm is the value, for least squares; InputError without one."""
        raise InputError(
            f'objective "{self.name}" is not the norm of a vector, which least squares needs.'
        )

    @property
    def of_observable(self) -> bool:
        """Whether it maximises or minimises an observable, of a design that is to be made and worn.

        Constraints hold by default then, and there is a verdict. The paper's objectives are stated
        without constraints, and so are users' own.
        """
        return False

    @property
    def is_norm(self) -> bool:
        """Whether it is the norm of a vector, a `residual`."""
        return type(self).residual is not Objective.residual

    @property
    def differentiable(self) -> bool:
        """Whether it has a `gradient`."""
        return type(self).gradient is not Objective.gradient

    @property
    def residual_differentiable(self) -> bool:
        """Whether it is the norm of a vector that has a `residual_gradient`."""
        return type(self).residual_gradient is not Objective.residual_gradient

    def gradient(self, paths: Paths) -> PathGradient:
        """Differentiate the value: joint angles (n, steps, j), tip force (n, steps).

        InputError if the objective has no derivative.
        """
        raise InputError(f'objective "{self.name}" has no gradient.')

    def differential(self, paths: Paths) -> Differential:
        """Return the first-order change of the values with what the engine differentiates.

        InputError if the objective has no derivative.
        """
        return self.gradient(paths).differential(paths.model)

    def residual_gradient(self, paths: Paths) -> PathGradient:
        """Differentiate the residual: joint angles (n, r, steps, j), tip force (n, r, steps).

        InputError if the objective is not the norm of a vector with a derivative.
        """
        raise InputError(f'objective "{self.name}" has no gradient of a residual vector.')

    def at(self, loads: ArrayLike) -> Objective:
        """Return the same objective at the end of other loads, (steps, inputs) [N or Pa]."""
        rows = np.asarray(loads, dtype=float)
        rows = rows if rows.ndim == 2 else rows.reshape(-1, 1)
        return replace(self, loads=tuple(tuple(row) for row in rows.tolist()))


def norm(vectors: Array) -> Array:
    """Euclidean norm of the rows of (n, r).

    Added component by component, so that a row's result never depends on how many rows there are.
    """
    total = np.zeros(vectors.shape[0])
    for component in range(vectors.shape[1]):
        total += vectors[:, component] ** 2
    return np.sqrt(total)
