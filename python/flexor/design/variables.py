"""Design variables: any numeric fields of a model file."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import zip_longest
from typing import TYPE_CHECKING, Any
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from flexor.arrays import Array
from flexor.design.bounds import check_bounds, check_fractions, number_of, read_bounds, wanted
from flexor.design.field_map import FieldMap, field_map, field_map_again
from flexor.design.fields import keys_of, value_of
from flexor.design.load_variables import LoadVariable, check_force, largest_of, load_variable
from flexor.design.parameter_set import ParameterSet
from flexor.design.profiles import SPLINE, control_values, with_splines
from flexor.design.slot_map_cache import cached
from flexor.design.span_map import is_span
from flexor.design.strap_places import check_place, is_place, with_moving_straps
from flexor.errors import InputError
from flexor.model.geometry import DesignSpace, SlotValues
from flexor.model.quantity import Unit, infer_quantity
from flexor.model.units import Quantity

if TYPE_CHECKING:
    from typing_extensions import Self

    from flexor.model import Model
    from flexor.model.structure import Structure

NAME = "fields"


@dataclass(frozen=True, eq=False)
class Variables(ParameterSet):
    """Design parameters that are fields of a model file; made by `field_variables`.

    Its labels are the fields as they were given. Everything that follows from a field follows:
    straps keep their slack, contacts the stiffness of their layers.

    Attributes
    ----------
    kinds : tuple of k Unit
        Units in which the fields are shown.
    load_fields : tuple of k LoadVariable or None
        What those fields are that are loads.
    splines : dict
        Number of control values of each size that varies along a rod, by its field.
    spans : dict
        Of labels that are an end of the span of a pressure, the span, which end, and both ends in
        the file.
    """

    kinds: tuple[Unit, ...] = ()
    load_fields: tuple[LoadVariable | None, ...] = ()
    splines: Mapping[str, int] = field(default_factory=dict)
    spans: Mapping[str, tuple[str, int, tuple[float, ...]]] = field(default_factory=dict)

    def prepared(self, model: Model) -> Model:
        """Return the model that the designs are of.

        Sizes that vary are splines in it, and straps whose places vary can be moved.
        """
        rows = zip(self.labels, self._loads, strict=True)
        fields = [label for label, load in rows if load is None]
        return with_moving_straps(with_splines(model, self.splines), fields)

    def _check_units(self) -> None:
        """All units of model files are allowed."""

    @property
    def scale(self) -> Array:
        """SI value of one display unit of each parameter, (k,)."""
        return np.array([kind.factor for kind in self.kinds])

    @property
    def si_units(self) -> tuple[str, ...]:
        """SI unit of each parameter, ``"1"`` for plain numbers."""
        return tuple(kind.si or "1" for kind in self.kinds)

    @property
    def fields(self) -> tuple[str, ...]:
        """Fields of the model file that the designs change."""
        return self.labels

    def field_values(self, p: Array) -> Array:
        """Return the values of these of n designs (n, k), (n, m), SI."""
        return self._designs(p)

    def extended(self, more: Variables) -> Self:
        """Return the set with more fields, which are no loads, at its end."""
        return replace(
            self,
            labels=(*self.labels, *more.labels),
            units=(*self.units, *more.units),
            lower=np.concatenate([self.lower, more.lower]),
            upper=np.concatenate([self.upper, more.upper]),
            start=np.concatenate([self.start, more.start]),
            kinds=(*self.kinds, *more.kinds),
        )

    def on(self, rod: DesignSpace) -> Variables:
        """Return the same set, as fields belong to no exosuit."""
        return self

    def on_model(self, model: Structure) -> Variables:
        """Return the same set, also for a model without ``[design]``."""
        return self

    def parse(self, label: str, text: str, option: str) -> float:
        """Read the value of a field, SI; see `ParameterSet.parse`."""
        own = self.kinds[self.labels.index(label)]
        value, unit = infer_quantity(text if own.si else number_of(text), f"{option}: {label}")
        if unit.si != own.si:
            raise InputError(f'{option} has {label} = "{text}": expected {wanted(own)}.')
        return value

    def designs(self, p: Array, model: Structure) -> tuple[SlotValues, NDArray[np.bool_]]:
        """Return the engine's parameters of designs; see `ParameterSet.designs`."""
        p = self._designs(p)
        found, x = self._map(model), np.ascontiguousarray(p[:, ~self._of_loads])
        return SlotValues(found.indices, found.values(x)), found.valid(x)

    @property
    def varied_inputs(self) -> tuple[str, ...]:
        """Inputs whose loads are among the fields; see `ParameterSet.varied_inputs`."""
        return tuple(each.name for each in self.load_fields if each is not None)

    def own_loads(self, p: Array, loads: Array, model: Structure) -> Array | None:
        """Return the loads of n designs, (n, s, u), if these vary; see `ParameterSet.own_loads`."""
        slopes = self.load_jacobian(loads, model)
        if slopes is None:
            return None
        varied = slopes.any(axis=(0, 2))
        found = np.repeat(loads[None], len(p), axis=0)
        found[:, :, varied] = 0.0
        for k in np.flatnonzero(self._of_loads):
            found += self._designs(p)[:, k, None, None] * slopes[:, :, k]
        return found

    def load_jacobian(self, loads: Array, model: Structure) -> Array | None:
        """Differentiate these by the fields, (s, u, k); see `ParameterSet.load_jacobian`."""
        if not self._of_loads.any():
            return None
        found = np.zeros((*loads.shape, self.size))
        for k, each in enumerate(self._loads):
            if each is not None:
                index = model.inputs.index(each.name)
                found[:, index, k] = loads[:, index] / largest_of(loads[:, index], each.name)
        return found

    @property
    def _loads(self) -> tuple[LoadVariable | None, ...]:
        """The loads among the fields; None for others and for those appended."""
        return self.load_fields + (None,) * (self.size - len(self.load_fields))

    @property
    def _of_loads(self) -> NDArray[np.bool_]:
        return np.array([each is not None for each in self._loads], dtype=bool)

    def slots(self, model: Structure) -> NDArray[np.intp]:
        """Return which of the engine's parameters the designs change; see `ParameterSet.slots`."""
        return self._map(model).indices

    def slot_jacobian(self, p: Array, model: Structure) -> Array:
        """Differentiate the engine's parameters that `designs` changes, (n, m, k)."""
        found, of_file = self._map(model), ~self._of_loads
        slopes = found.jacobian(np.ascontiguousarray(self._designs(p)[:, of_file]))
        if of_file.all():
            return slopes
        whole = np.zeros((*np.shape(p), len(found.indices)))
        whole[:, of_file] = slopes.swapaxes(1, 2)
        return whole.swapaxes(1, 2)

    def changes(self, p: Array) -> dict[str, object]:
        """Return one design (k,) as changes of the model file, for `flexor.load`."""
        rows = zip(self.labels, self.kinds, np.asarray(p).tolist(), strict=True)
        made: dict[str, object] = {}
        for (label, kind, value), load in zip(rows, self._loads, strict=True):
            size, _, index = label.rpartition(f".{SPLINE}.")
            if load is not None:
                made |= load.changes(value)
            elif label in self.spans:
                span, end, own = self.spans[label]
                whole = made.setdefault(span, list(own))
                whole[end] = value  # type: ignore[index]
            elif size in self.splines and index.isdigit():
                # The whole size: the file may not have it as a spline yet.
                whole = made.setdefault(size, {SPLINE: []})
                whole[SPLINE].append(kind.exact(value))  # type: ignore[index]
            else:
                made[label] = kind.exact(value)
        return made

    def keys(self, model: Structure) -> dict[str, tuple[str, ...]]:
        """Return the keys in the model file of each field that is no load, by its label."""
        found = self._keys.get(model)
        if found is None:
            own = zip_longest(self.fields, self.load_fields)
            found = {label: keys_of(label, model.file) for label, load in own if load is None}
            self._keys[model] = found
        return found

    def _map(self, model: Structure) -> FieldMap:
        found = self._maps.get(model)
        if found is None:
            of_labels = self.keys(model)
            labels, keys = list(of_labels), list(of_labels.values())
            found = self._refitted(model, keys)
            if found is None:
                found = self._found(model, keys, labels)
            self._maps[model] = found
        return found

    def _found(self, model: Structure, keys: list[tuple[str, ...]], labels: list[str]) -> FieldMap:
        """Return the map of a model on its own, which depends on its file and on the bounds.

        Files with the same text may have other descriptions: copies keep points of quadrature.
        """
        chosen = ~self._of_loads
        lower, upper = self.lower[chosen], self.upper[chosen]
        text = model.file.to_toml()
        question = (model.digest, text, tuple(keys), lower.tobytes(), upper.tobytes())
        return cached(question, lambda: field_map(model, keys, labels, lower, upper))

    def _refitted(self, model: Structure, keys: list[tuple[str, ...]]) -> FieldMap | None:
        """Return the map of another model with other numbers: models differ in values only."""
        other = next(iter(list(self._maps.items())), None) if keys else None
        return None if other is None else field_map_again(other[1], other[0], model, keys)

    @cached_property
    def _maps(self) -> WeakKeyDictionary[Structure, FieldMap]:
        return WeakKeyDictionary()

    @cached_property
    def _keys(self) -> WeakKeyDictionary[Structure, dict[str, tuple[str, ...]]]:
        return WeakKeyDictionary()

    def __getstate__(self) -> dict[str, Any]:
        cached = ("_maps", "_keys")
        return {key: value for key, value in self.__dict__.items() if key not in cached}


def field_variables(
    bounds: Mapping[str, Sequence[object]], model: Structure, source: str = "--vary"
) -> Variables:
    """Make design variables of fields of a model file.

    See `flexor.design.variables`, whose fields may be patterns.
    """
    if not bounds:
        raise InputError(f"{source}: name at least one field and its bounds.")
    bounds, splines = control_values(bounds, model, source)
    model = _prepared(model, splines)
    file, seen = model.file, dict[tuple[str, ...], str]()
    lower, upper, start, kinds, loads = [], [], [], [], []
    spans: dict[str, tuple[str, int, tuple[float, ...]]] = {}
    for label, pair in bounds.items():
        load = load_variable(label, model)
        keys = keys_of(label, file) if load is None else ("load", load.name)
        if keys in seen:
            raise InputError(f'{source}: "{label}" is the same field as "{seen[keys]}".')
        seen[keys] = label
        value = value_of(keys, file) if load is None else quantity_of(load)
        _, own = infer_quantity(getattr(value, "text", value), label)
        ends, shown = read_bounds(pair, label, own, isinstance(value, Quantity), source)
        if load is None and is_span(keys):
            check_fractions(label, ends, source)
            own_span = file.actuators[keys[1]].span  # type: ignore[union-attr]
            spans[label] = (".".join(keys[:3]), int(keys[3]), tuple(map(float, own_span)))
        if load is None and is_place(keys):
            check_fractions(label, ends, source)
            check_place(label, keys[1], file, source)
        if load is None:
            check_force(label, keys, file, source)
            check_bounds(pair, ends, own, label, keys, file, source)
        lower.append(ends[0])
        upper.append(ends[1])
        kinds.append(shown)
        start.append(float(value))
        loads.append(load)
    return Variables(
        name=NAME,
        labels=tuple(bounds),
        units=tuple(kind.text or "1" for kind in kinds),
        lower=np.array(lower),
        upper=np.array(upper),
        start=np.array(start),
        kinds=tuple(kinds),
        load_fields=tuple(loads),
        splines=splines,
        spans=spans,
    )


def _prepared(model: Structure, splines: Mapping[str, int]) -> Structure:
    return with_splines(model, splines) if splines else model  # type: ignore[arg-type]


def quantity_of(load: LoadVariable) -> float:
    """Return the largest load of an input, with its unit if it has one."""
    return Quantity(load.start, f"{load.start!r} {load.unit}") if load.unit else load.start
