"""A user's own objective: one function of the path."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, fields, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from flexor.arrays import Array
from flexor.errors import InputError
from flexor.model.results import Paths
from flexor.objectives.base import Objective


@dataclass(frozen=True)
class Custom(Objective):
    """An objective from a function of one path; made by `custom`."""

    function: Callable[[Any], float] = float
    sense: Callable[[Any], float] | None = None

    def value(self, paths: Paths) -> Array:
        """Value of the function for each path, (n,)."""
        return self._each(self.function, paths)

    def shown(self, paths: Paths) -> Array:
        """Quantity for display, (n,): the value unless another was given."""
        return self._each(self.sense or self.function, paths)

    def _each(self, function: Callable[[Any], float], paths: Paths) -> Array:
        try:
            return np.array([float(function(path)) for path in _read_only(paths)])
        except (TypeError, ValueError) as error:
            if isinstance(error, InputError):
                raise
            raise InputError(
                f'objective "{self.name}" must give one number for a path, but failed: {error}.'
            ) from error


def custom(
    name: str,
    function: Callable[[Any], float],
    *,
    force: ArrayLike | None = None,
    quantity: str = "value",
    unit: str = "",
    shown: Callable[[Any], float] | None = None,
) -> Objective:
    """Make an objective of one function of the path.

    Parameters
    ----------
    name : str
        Name of the objective.
    function : callable
        From the `flexor.Path` of one design to a number to minimise. It is not called for designs
        that failed; a design for which it returns NaN counts as failed.
    force : (steps,) array, optional
        Actuation forces [N] of the path; by default those of the model's ``[evaluation]``.
    quantity, unit : str
        Name and unit of the displayed quantity.
    shown : callable, optional
        Computes that quantity from the path; the value itself by default.

    Returns
    -------
    Objective
        To be given to `flexor.optimize`.
    """
    made = Custom(name=name, quantity=quantity, unit=unit, function=function, sense=shown)
    return made if force is None else made.at(force)


def _read_only(paths: Paths) -> Paths:
    """Return the same paths, of which a function cannot change what is recorded."""
    views: dict[str, Any] = {}
    for each in fields(paths):
        value = getattr(paths, each.name)
        if isinstance(value, np.ndarray):
            views[each.name] = value.view()
            views[each.name].flags.writeable = False
    return replace(paths, **views)
