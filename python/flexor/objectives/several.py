"""Several objectives at once, between which a front of designs is a choice."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from flexor.arrays import Array
from flexor.errors import InputError
from flexor.model.results import Paths
from flexor.objectives.base import Objective

SEPARATOR = ", "


@dataclass(frozen=True)
class Several(Objective):
    """Several objectives of one path; made by `several`.

    Its own value is that of the first, by which designs are listed.

    Attributes
    ----------
    parts : tuple of m Objective
        The objectives.
    """

    parts: tuple[Objective, ...] = ()

    @property
    def count(self) -> int:
        """Number m of objectives."""
        return len(self.parts)

    @property
    def of_observable(self) -> bool:
        """Whether constraints hold by default: it is of designs that are to be made and worn."""
        return True

    def value(self, paths: Paths) -> Array:
        """Return the value of the first objective, (n,)."""
        return self.parts[0].value(paths)

    def shown(self, paths: Paths) -> Array:
        """Return the quantity of the first objective for display, (n,)."""
        return self.parts[0].shown(paths)

    def values(self, paths: Paths) -> Array:
        """Return the values of all objectives, (n, m)."""
        return np.stack([part.value(paths) for part in self.parts], axis=1)

    def displayed(self, value: Array) -> Array:
        """Return values of the first objective for tables and figures."""
        return self.parts[0].displayed(value)

    def at(self, loads: ArrayLike) -> Objective:
        """Return the same objectives at the end of other loads, (steps, inputs) [N or Pa]."""
        made = tuple(part.at(loads) for part in self.parts)
        return replace(self, loads=made[0].loads, parts=made)


def several(parts: Sequence[Objective]) -> Objective:
    """Make one objective of several; of one that itself.

    InputError if there is none, two are the same, or they are evaluated at different loads.
    """
    if len(parts) == 1:
        return parts[0]
    if not parts:
        raise InputError("name at least one objective.")
    names = [part.name for part in parts]
    quantities = [part.quantity for part in parts]
    for each in (names, quantities):
        twice = next((name for name in each if each.count(name) > 1), None)
        if twice is not None:
            raise InputError(f'"{twice}" is an objective twice: several must differ.')
    if len({part.loads for part in parts}) > 1:
        raise InputError("several objectives must be evaluated at the same loads.")
    first = parts[0]
    return Several(
        name=SEPARATOR.join(names),
        quantity=first.quantity,
        unit=first.unit,
        loads=first.loads,
        parts=tuple(parts),
    )
