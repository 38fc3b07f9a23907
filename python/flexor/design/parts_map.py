"""The engine's parameters of a model whose components do nothing to one another.

Fields of different components do not interact, so that the map of each is found on it alone.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Generic, Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray

from flexor.arrays import Array
from flexor.model.restricted import Restricted, entries_of_components, restricted, together
from flexor.model.structure import Structure

Keys = tuple[str, ...]


class Map(Protocol):
    """Parameters of the engine as functions of fields."""

    @property
    def indices(self) -> NDArray[np.intp]:
        """Which of the engine's parameters vary, (m,)."""

    def values(self, x: Array) -> Array:
        """Return the parameters (n, m) of designs (n, k), SI."""

    def jacobian(self, x: Array) -> Array:
        """Return the derivatives (n, m, k) of the parameters of designs (n, k)."""

    def valid(self, x: Array) -> NDArray[np.bool_]:
        """Return which designs (n, k) can be, (n,)."""


M = TypeVar("M", bound=Map)


@dataclass(frozen=True, eq=False)
class Group(Generic[M]):
    """Fields that belong to the same components, and the map of these."""

    fields: NDArray[np.intp]  # which of the k fields
    part: Restricted
    map: M


@dataclass(frozen=True, eq=False)
class PartsMap(Generic[M]):
    """Parameters of the engine as functions of k fields of several components.

    Attributes
    ----------
    indices : (m,) array
        Which of the engine's parameters vary.
    groups : tuple of Group
        Those of each field are of one group only.
    """

    indices: NDArray[np.intp]
    groups: tuple[Group[M], ...]
    _columns: tuple[NDArray[np.intp], ...]  # of each group among `indices`

    @classmethod
    def of(cls, groups: Sequence[Group[M]]) -> PartsMap[M] | None:
        """Join the maps of groups; None if a parameter depends on the fields of several."""
        slots = [each.part.slots[each.map.indices] for each in groups]
        every = np.concatenate(slots)
        indices = np.unique(every)
        if len(indices) < len(every):
            return None
        columns = tuple(np.searchsorted(indices, each) for each in slots)
        return cls(indices, tuple(groups), columns)

    def values(self, x: Array) -> Array:
        """Return the parameters (n, m) of designs (n, k), SI."""
        found = np.empty((len(x), len(self.indices)))
        for group, columns in zip(self.groups, self._columns, strict=True):
            found[:, columns] = group.map.values(np.ascontiguousarray(x[:, group.fields]))
        return found

    def jacobian(self, x: Array) -> Array:
        """Return the derivatives (n, m, k) of the parameters of designs (n, k)."""
        found = np.zeros((len(x), len(self.indices), x.shape[1]))
        for group, columns in zip(self.groups, self._columns, strict=True):
            slopes = group.map.jacobian(np.ascontiguousarray(x[:, group.fields]))
            found[:, columns[:, None], group.fields] = slopes
        return found

    def valid(self, x: Array) -> NDArray[np.bool_]:
        """Return which designs (n, k) can be, (n,)."""
        kept = np.ones(len(x), dtype=bool)
        for group in self.groups:
            kept &= group.map.valid(x[:, group.fields])
        return kept


def groups_of_fields(
    model: Structure, fields: Sequence[Keys]
) -> list[tuple[NDArray[np.intp], Restricted]]:
    """Divide fields by the components of the model that they belong to.

    Returns
    -------
    list of (array of int, Restricted)
        Which fields belong together, and the components that they are of; none if the model is not
        to be divided.
    """
    parts = entries_of_components(model)
    if not parts or not fields:
        return []
    touched = [_touched(keys, parts) for keys in fields]
    groups: list[tuple[set[int], set[int]]] = []  # fields, components
    for field, own in enumerate(touched):
        joined = [each for each in groups if each[1] & own]
        groups = [each for each in groups if not each[1] & own]
        groups.append(
            (
                {field}.union(*(each[0] for each in joined)),
                own.union(*(each[1] for each in joined)),
            )
        )
    found = []
    for members, components in groups:
        if len(components) == len(parts):
            return []
        part = restricted(model, together(model, [parts[i] for i in sorted(components)]))
        if part is None:
            return []
        found.append((np.array(sorted(members)), part))
    return sorted(found, key=lambda each: int(each[0][0]))


def _touched(keys: Keys, parts: Sequence[Mapping[str, object]]) -> set[int]:
    """Return the components that a field may change: all, if it is of no entry of some."""
    table, entry = (*keys, "")[:2]
    own = {i for i, part in enumerate(parts) if entry in part.get(table, ())}  # type: ignore[operator]
    return own or set(range(len(parts)))


def regrouped(like: PartsMap[M], model: Structure) -> list[Restricted] | None:
    """Return the same components of another model; None if it is made of others."""
    found = []
    for group in like.groups:
        part = restricted(model, group.part.entries)
        if part is None or not np.array_equal(part.slots, group.part.slots):
            return None
        found.append(part)
    return found
