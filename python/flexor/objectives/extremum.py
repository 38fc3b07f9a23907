"""Objectives that maximise or minimise an observable at the last load."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexor.arrays import Array
from flexor.model.derivatives import Differential
from flexor.model.results import Paths
from flexor.model.structure import Structure
from flexor.objectives.base import Objective
from flexor.observables import Observable, observable

SENSES = {"maximise": -1.0, "minimise": 1.0}


@dataclass(frozen=True)
class Extremum(Objective):
    """The largest or smallest value of an observable; made by `extremum`.

    Attributes
    ----------
    sign : float
        -1 to maximise, 1 to minimise.
    factor : float
        SI value of the unit.
    differentiable_observable : bool
        Whether the observable has exact derivatives.
    """

    sign: float = 1.0
    factor: float = 1.0
    differentiable_observable: bool = False

    @property
    def of_observable(self) -> bool:
        """True."""
        return True

    @property
    def differentiable(self) -> bool:
        """Whether the observable has derivatives."""
        return self.differentiable_observable

    def value(self, paths: Paths) -> Array:
        """Return the observable with its sign, SI, (n,)."""
        return self.sign * self._observable(paths.model).last(paths) + 0.0

    def shown(self, paths: Paths) -> Array:
        """Return the observable in its unit, (n,)."""
        return self._observable(paths.model).last(paths) / self.factor

    def displayed(self, value: Array) -> Array:
        """Return values of this objective as the observable in its unit."""
        return self.sign * value / self.factor + 0.0

    def differential(self, paths: Paths) -> Differential:
        """Return the first-order change of the value; InputError if there is none."""
        last = np.full(len(paths), paths.loads.shape[0] - 1)
        return self._observable(paths.model).differential(paths, last) * self.sign

    def _observable(self, model: Structure) -> Observable:
        return observable(self.quantity, model)


def extremum(sense: str, name: str, model: Structure) -> Extremum:
    """Make the objective to maximise or minimise an observable of a model.

    Parameters
    ----------
    sense
        ``"maximise"`` or ``"minimise"``.
    name
        Name of the observable, such as ``"range-of-motion"``.
    model
        The model.

    Raises
    ------
    InputError
        If the model has no such observable.
    """
    found = observable(name, model)
    return Extremum(
        name=f"{sense} {found.name}",
        quantity=found.name,
        unit=found.unit[1],
        sign=SENSES[sense],
        factor=found.unit[0],
        differentiable_observable=found.differentiable,
    )
