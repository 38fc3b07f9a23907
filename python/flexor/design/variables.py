"""Design variables: any numeric fields of a model file."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from flexor.arrays import Array
from flexor.design.fields import keys_of, value_of
from flexor.design.parameter_set import ParameterSet
from flexor.design.slot_map import SlotMap, refitted, slot_map
from flexor.errors import InputError
from flexor.model.geometry import DesignSpace, SlotValues
from flexor.model.quantity import Unit, infer_quantity
from flexor.model.units import Quantity

if TYPE_CHECKING:
    from flexor.model.structure import Structure

NAME = "fields"


@dataclass(frozen=True, eq=False)
class Variables(ParameterSet):
    """Design parameters that are fields of a model file; made by `variables`.

    Its labels are the fields as they were given. Everything that follows from a field follows:
    straps keep their slack, contacts the stiffness of their layers.

    Attributes
    ----------
    kinds : tuple of k Unit
        Units in which the fields are shown.
    """

    kinds: tuple[Unit, ...] = ()

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

    def on(self, rod: DesignSpace) -> Variables:
        """Return the same set, as fields belong to no exosuit."""
        return self

    def parse(self, label: str, text: str, option: str) -> float:
        """Read the value of a field, SI; see `ParameterSet.parse`."""
        own = self.kinds[self.labels.index(label)]
        value, unit = infer_quantity(text if own.si else _number(text), f"{option}: {label}")
        if unit.si != own.si:
            raise InputError(f'{option} has {label} = "{text}": expected {_wanted(own)}.')
        return value

    def designs(self, p: Array, model: Structure) -> tuple[SlotValues, NDArray[np.bool_]]:
        """Return the engine's parameters of designs; see `ParameterSet.designs`."""
        p = self._designs(p)
        found = self._map(model)
        return SlotValues(found.indices, found.values(p)), np.ones(len(p), dtype=bool)

    def slots(self, model: Structure) -> NDArray[np.intp]:
        """Return which of the engine's parameters the designs change; see `ParameterSet.slots`."""
        return self._map(model).indices

    def slot_jacobian(self, p: Array, model: Structure) -> Array:
        """Differentiate the engine's parameters that `designs` changes, (n, m, k)."""
        return self._map(model).jacobian(self._designs(p))

    def changes(self, p: Array) -> dict[str, object]:
        """Return one design (k,) as changes of the model file, for `flexor.load`."""
        rows = zip(self.labels, self.kinds, np.asarray(p).tolist(), strict=True)
        return {label: kind.exact(value) for label, kind, value in rows}

    def _map(self, model: Structure) -> SlotMap:
        found = self._maps.get(model)
        if found is None:
            keys = [keys_of(label, model.file) for label in self.labels]
            # Models that differ in values have the same polynomials.
            known = next(iter(list(self._maps.values())), None)
            found = refitted(known, model, keys) if known is not None else None
            if found is None:
                found = slot_map(model, keys, self.labels, self.lower, self.upper)
            self._maps[model] = found
        return found

    @cached_property
    def _maps(self) -> WeakKeyDictionary[Structure, SlotMap]:
        return WeakKeyDictionary()

    def __getstate__(self) -> dict[str, Any]:
        return {key: value for key, value in self.__dict__.items() if key != "_maps"}


def variables(
    bounds: Mapping[str, Sequence[object]], model: Structure, source: str = "--vary"
) -> Variables:
    """Make design variables of fields of a model file.

    Parameters
    ----------
    bounds
        Lower and upper bound of each field by its dotted path, such as
        ``{"exosuit.length": ("8 cm", "12 cm"), "proximal.to.at": (0.4, 0.7)}``: texts with a unit,
        or plain numbers for what has none.
    model
        The model, whose own values are the starting design.
    source
        Where the bounds come from, for messages.

    Raises
    ------
    InputError
        If there is no such field or it cannot be varied, two bounds are for one field, a bound has
        no unit or one of another kind, or bounds are not in order.

    Examples
    --------
    >>> import flexor
    >>> model = flexor.load("pneumatic-finger")
    >>> varied = flexor.design.variables({"exosuit.length": ("8 cm", "11 cm")}, model)
    >>> varied.start
    array([0.1])
    """
    if not bounds:
        raise InputError(f"{source}: name at least one field and its bounds.")
    file, seen = model.file, dict[tuple[str, ...], str]()
    lower, upper, start, kinds = [], [], [], []
    for label, pair in bounds.items():
        keys = keys_of(label, file)
        if keys in seen:
            raise InputError(f'{source}: "{label}" is the same field as "{seen[keys]}".')
        seen[keys] = label
        value = value_of(keys, file)
        _, own = infer_quantity(getattr(value, "text", value), label)
        ends, shown = _ends(pair, label, own, isinstance(value, Quantity), source)
        lower.append(ends[0])
        upper.append(ends[1])
        kinds.append(shown)
        start.append(float(value))
    return Variables(
        name=NAME,
        labels=tuple(bounds),
        units=tuple(kind.text or "1" for kind in kinds),
        lower=np.array(lower),
        upper=np.array(upper),
        start=np.array(start),
        kinds=tuple(kinds),
    )


def recorded_variables(table: Mapping[str, Any], model: Structure) -> Variables:
    """Return the variables that a study's settings describe, with bounds in SI units."""
    made = variables(
        {
            label: tuple(_text(value, label, model) for value in (low, high))
            for label, low, high in zip(
                table["labels"], table["lower"], table["upper"], strict=True
            )
        },
        model,
        "the recorded variables",
    )
    kinds = []
    for kind, unit in zip(made.kinds, table["units"], strict=True):
        text = "" if unit == "1" else unit
        kinds.append(kind if not text else infer_quantity(f"1 {text}", "unit")[1])
    return replace(
        made,
        units=tuple(table["units"]),
        kinds=tuple(kinds),
        lower=np.array(table["lower"]),
        upper=np.array(table["upper"]),
    )


def _text(value: float, label: str, model: Structure) -> object:
    own = value_of(keys_of(label, model.file), model.file)
    _, unit = infer_quantity(getattr(own, "text", own), label)
    return unit.exact(value)


def _ends(
    pair: Sequence[object], label: str, own: Unit, with_unit: bool, source: str
) -> tuple[tuple[float, float], Unit]:
    if isinstance(pair, str) or len(pair) != 2:
        raise InputError(f"{source}: {label} = {pair!r}: expected a lower and an upper bound.")
    found = []
    for end in pair:
        value = _number(end) if not with_unit and isinstance(end, str) else end
        number, unit = infer_quantity(value, f"{source}: {label}")
        if unit.si != own.si:
            raise InputError(f'{source}: {label} has the bound "{end}": expected {_wanted(own)}.')
        found.append((number, unit))
    (low, _), (high, shown) = found
    if not low < high:
        raise InputError(
            f"{source}: {label} = {_shown(pair)}: the lower bound must be below the upper one."
        )
    return (low, high), shown


def _wanted(own: Unit) -> str:
    return f"a value with its unit, such as {own.text}" if own.si else "a plain number"


def _shown(pair: Sequence[object]) -> str:
    return ":".join(str(end) for end in pair)


def _number(text: str) -> object:
    try:
        return float(text)
    except ValueError:
        return text
