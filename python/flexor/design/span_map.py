"""The engine's parameters where the span of a pressure varies, besides other fields.

What the span decides are the shares of Gauss points, which are polynomials of its ends between
element boundaries; nothing else depends on it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from flexor.arrays import Array
from flexor.design.slot_map import SlotMap
from flexor.design.spline_map import SplineMap
from flexor.model.schema import Rod
from flexor.model.schema.cavity import shares
from flexor.model.structure import Structure

Keys = tuple[str, ...]


def is_span(keys: Sequence[str]) -> bool:
    """Return whether a field is an end of the span of a pressure."""
    return len(keys) == 4 and keys[0] == "actuators" and keys[2] == "span"


@dataclass(frozen=True, eq=False)
class _Span:
    """The span of one pressure."""

    rod: Rod
    own: tuple[float, float]  # of the file
    variables: tuple[int | None, int | None]  # which variables its ends are
    columns: NDArray[np.intp]  # (g,), of the map

    def ends(self, x: Array) -> Array:
        """Return begin and end in designs (n, k), (n, 2)."""
        chosen = zip(self.variables, self.own, strict=True)
        ends = [np.full(len(x), own) if i is None else x[:, i] for i, own in chosen]
        return np.stack(ends, axis=1)


@dataclass(frozen=True, eq=False)
class SpanMap:
    """Parameters of the engine as functions of k fields, some of them ends of spans.

    Attributes
    ----------
    indices : (m,) array
        Which of the engine's parameters vary.
    others : SlotMap or SplineMap
        The map of the other fields.
    """

    indices: NDArray[np.intp]
    others: SlotMap | SplineMap
    _chosen: NDArray[np.bool_]  # (k,), which fields are the others
    _columns: NDArray[np.intp]  # of the others among `indices`
    _spans: tuple[_Span, ...]

    @classmethod
    def of(cls, others: SlotMap | SplineMap, model: Structure, fields: Sequence[Keys]) -> SpanMap:
        """Add the spans among k fields to the map of those that are none."""
        chosen = np.array([not is_span(keys) for keys in fields])
        names = list(dict.fromkeys(keys[1] for keys in fields if is_span(keys)))
        slots = [np.arange(*model.engine.slots[f"{name}.share"]) for name in names]
        every = np.concatenate([others.indices, *slots])
        order = np.argsort(every, kind="stable")
        place = np.empty_like(order)
        place[order] = np.arange(len(order))
        first, spans = len(others.indices), []
        for name, slot in zip(names, slots, strict=True):
            table = model.file.actuators[name]
            ends = [("actuators", name, "span", end) for end in ("0", "1")]
            found = [fields.index(keys) if keys in fields else None for keys in ends]
            columns = place[first : first + len(slot)]
            rod = model.file.rod(table.rod)
            spans.append(_Span(rod, table.span, (found[0], found[1]), columns))  # type: ignore[union-attr]
            first += len(slot)
        return cls(every[order], others, chosen, place[: len(others.indices)], tuple(spans))

    def values(self, x: Array) -> Array:
        """Return the parameters (n, m) of designs (n, k), SI."""
        found = np.zeros((len(x), len(self.indices)))
        found[:, self._columns] = self.others.values(np.ascontiguousarray(x[:, self._chosen]))
        for each in self._spans:
            found[:, each.columns] = shares(each.rod, each.ends(x))[0]
        return found

    def jacobian(self, x: Array) -> Array:
        """Return the derivatives (n, m, k) of the parameters of designs (n, k)."""
        found = np.zeros((*x.shape, len(self.indices)))
        slopes = self.others.jacobian(np.ascontiguousarray(x[:, self._chosen]))
        for j, other in enumerate(np.flatnonzero(self._chosen)):
            found[:, other, self._columns] = slopes[..., j]
        for each in self._spans:
            slopes = shares(each.rod, each.ends(x))[1]
            for end, variable in enumerate(each.variables):
                if variable is not None:
                    found[:, variable, each.columns] = slopes[..., end]
        return found.swapaxes(1, 2)

    def valid(self, x: Array) -> NDArray[np.bool_]:
        """Return which designs (n, k) have spans that end after their begin, (n,)."""
        kept = np.ones(len(x), dtype=bool)
        for each in self._spans:
            begin, end = each.ends(x).T
            kept &= begin < end
        return kept
