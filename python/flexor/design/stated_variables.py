"""Design variables as they are given: fields of a model file, or patterns of several parts."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from fnmatch import fnmatchcase
from itertools import product
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from flexor.arrays import Array
from flexor.design.fields import constant_radius, keys_of, value_of
from flexor.design.load_variables import load_variable
from flexor.design.profiles import recorded_splines
from flexor.design.variables import NAME, Variables, field_variables, quantity_of
from flexor.errors import InputError, alternatives
from flexor.model.geometry import SlotValues
from flexor.model.quantity import infer_quantity
from flexor.model.schema import ModelFile

if TYPE_CHECKING:
    from flexor.model import Model
    from flexor.model.structure import Structure

_BRACES = re.compile(r"\{([^{}]*)\}")


@dataclass(frozen=True, eq=False)
class SharedVariables(Variables):
    """Design variables some of which are fields of several parts of a model.

    Attributes
    ----------
    inner : Variables
        All the fields.
    of : (m,) array
        Which of the k variables each of these follows.
    ratio : (m,) array
        In which ratio, that of the model file.
    """

    inner: Variables | None = None
    of: NDArray[np.intp] = field(default_factory=lambda: np.zeros(0, dtype=np.intp))
    ratio: Array = field(default_factory=lambda: np.zeros(0))

    def prepared(self, model: Model) -> Model:
        """Return the model that the designs are of; see `Variables.prepared`."""
        return self._inner.prepared(model)

    @property
    def fields(self) -> tuple[str, ...]:
        """Fields of the model file that the designs change."""
        return self._inner.labels

    @property
    def whole(self) -> tuple[tuple[str, ...], ...]:
        """The fields of each variable."""
        rows = list(zip(self.fields, self.of.tolist(), strict=True))
        return tuple(tuple(each for each, k in rows if k == i) for i in range(self.size))

    def field_values(self, p: Array) -> Array:
        """Return the values of these of n designs (n, k), (n, m), SI."""
        return self._designs(p)[:, self.of] * self.ratio

    def designs(self, p: Array, model: Structure) -> tuple[SlotValues, NDArray[np.bool_]]:
        """Return the engine's parameters of designs; see `ParameterSet.designs`."""
        return self._inner.designs(self.field_values(p), model)

    def slots(self, model: Structure) -> NDArray[np.intp]:
        """Return which of the engine's parameters the designs change; see `ParameterSet.slots`."""
        return self._inner.slots(model)

    def slot_jacobian(self, p: Array, model: Structure) -> Array:
        """Differentiate the engine's parameters that `designs` changes, (n, m, k)."""
        by_fields = self._inner.slot_jacobian(self.field_values(p), model)
        return by_fields @ self._by_variables

    def own_loads(self, p: Array, loads: Array, model: Structure) -> Array | None:
        """Return the loads of n designs, if these vary; see `ParameterSet.own_loads`."""
        return self._inner.own_loads(self.field_values(p), loads, model)

    def load_jacobian(self, loads: Array, model: Structure) -> Array | None:
        """Differentiate these by the variables; see `ParameterSet.load_jacobian`."""
        slopes = self._inner.load_jacobian(loads, model)
        return None if slopes is None else slopes @ self._by_variables

    @property
    def varied_inputs(self) -> tuple[str, ...]:
        """Inputs whose loads are among the fields; see `ParameterSet.varied_inputs`."""
        return self._inner.varied_inputs

    def keys(self, model: Structure) -> dict[str, tuple[str, ...]]:
        """Return the keys in the model file of each field that is no load, by its label."""
        return self._inner.keys(model)

    def changes(self, p: Array) -> dict[str, object]:
        """Return one design (k,) as changes of the model file, for `flexor.load`."""
        return self._inner.changes(self.field_values(p)[0])

    def extended(self, more: Variables) -> SharedVariables:
        """Return the set with more fields at its end, each of which is a variable."""
        count = np.arange(self.size, self.size + more.size, dtype=np.intp)
        return replace(
            super().extended(more),
            inner=self._inner.extended(more),
            of=np.concatenate([self.of, count]),
            ratio=np.concatenate([self.ratio, np.ones(more.size)]),
        )

    @property
    def _by_variables(self) -> Array:
        """Derivative of the fields by the variables, (m, k)."""
        return np.asarray(np.eye(self.size)[self.of] * self.ratio[:, None])

    @property
    def _inner(self) -> Variables:
        assert self.inner is not None
        return self.inner


def variables(
    bounds: Mapping[str, Sequence[object]], model: Structure, source: str = "--vary"
) -> Variables:
    """Make design variables of fields of a model file.

    Parameters
    ----------
    bounds
        Lower and upper bound of each field by its dotted path, such as
        ``{"exosuit.length": ("8 cm", "12 cm"), "proximal.to.at": (0.4, 0.7)}``: texts with a unit,
        or plain numbers for what has none. With a third entry,
        ``{"exosuit.section.wall": ("1.5 mm", "3 mm", "spline 4")}``, a size of a rod varies along
        it as a spline of four control values. Of a model that is made of parts a field may be a
        pattern, ``"*.exosuit.length"`` or ``"{index,middle}.exosuit.length"``: the variable is then
        the first of its fields, and the others keep the ratio to it that they have in the file.
    model
        The model, whose own values are the starting design.
    source
        Where the bounds come from, for messages.

    Raises
    ------
    InputError
        If there is no such field or it cannot be varied, two bounds are for one field, a bound has
        no unit or one of another kind, bounds are not in order, a size cannot vary along a rod, or
        the fields of a pattern have no ratio.

    Examples
    --------
    >>> import flexor
    >>> model = flexor.load("pneumatic-finger")
    >>> varied = flexor.design.variables({"exosuit.length": ("8 cm", "11 cm")}, model)
    >>> varied.start
    array([0.1])
    """
    for label, ends in bounds.items():
        if not isinstance(label, str) or not isinstance(ends, Sequence | np.ndarray):
            raise InputError(
                f"{source}: {label} = {ends!r}: expected a field, and its lower and upper bound."
            )
    fields = {
        label: fields_of(label, model.file, source) if len(ends) < 3 else (label,)
        for label, ends in bounds.items()
    }
    if all(found == (label,) for label, found in fields.items()):
        return field_variables(bounds, model, source)
    for label, ends in bounds.items():
        if len(ends) > 2 and _is_pattern(label):
            tail = "fields of several parts together do not vary along a rod"
            raise InputError(f'{source}: "{label}": {tail}: name each part.')
    owner: dict[str, str] = {}
    for label, found in fields.items():
        for each in found:
            if each in owner:
                raise InputError(f'{source}: "{each}" is varied by "{owner[each]}" and "{label}".')
            owner[each] = label
    first = {label: found[0] for label, found in fields.items()}
    leading = field_variables({first[label]: ends for label, ends in bounds.items()}, model, source)
    of = np.repeat(np.arange(len(fields)), [len(found) for found in fields.values()])
    ratio = _ratios(fields, model, source)
    every = {
        each: tuple(_text(value * scale, each, model, False) for value in ends)
        for (each, k), scale in zip(_each(fields), ratio.tolist(), strict=True)
        for ends in [(float(leading.lower[k]), float(leading.upper[k]))]
    }
    return SharedVariables(
        name=NAME,
        labels=tuple(fields),
        units=leading.units,
        lower=leading.lower,
        upper=leading.upper,
        start=leading.start,
        kinds=leading.kinds,
        inner=field_variables(every, model, source),
        of=of,
        ratio=ratio,
    )


def _each(fields: Mapping[str, tuple[str, ...]]) -> Iterator[tuple[str, int]]:
    for k, found in enumerate(fields.values()):
        yield from ((each, k) for each in found)


def _ratios(fields: Mapping[str, tuple[str, ...]], model: Structure, source: str) -> Array:
    """Return the ratio of each field to the first of its pattern, (m,)."""
    ratios = []
    for label, found in fields.items():
        values = [_own(each, model) for each in found]
        if len(found) > 1 and any(value * values[0] <= 0.0 for value in values):
            raise InputError(
                f'{source}: "{label}" has fields that are zero or of different signs, which have '
                "no ratio: name each."
            )
        ratios += [1.0 if len(found) == 1 else value / values[0] for value in values]
    return np.array(ratios)


def _own(label: str, model: Structure) -> float:
    load = load_variable(label, model)
    return float(value_of(keys_of(label, model.file), model.file) if load is None else load.start)


def fields_of(label: str, file: ModelFile, source: str) -> tuple[str, ...]:
    """Return the fields that a pattern stands for, in the order of the file; a field, itself.

    In a pattern ``*`` is any text without dots, ``{one,other}`` either of these. A radius that is
    the same from base to tip stands for both.

    Raises
    ------
    InputError
        If there is none.
    """
    if not _is_pattern(label):
        return constant_radius(label, file) or (label,)
    patterns = [(words, text.split(".")) for words, text in _without_braces(label.strip())]
    names = [name for table in file.named_tables() for name in getattr(file, table)]
    found: dict[str, int] = {}  # with the number of parts of the entry's name
    used: set[str] = set()
    for name in names:
        parts = name.split(".")
        for words, pattern in patterns:
            head, rest = pattern[: len(parts)], pattern[len(parts) :]
            if rest and all(map(fnmatchcase, parts, head)):
                found[".".join([name, *rest])] = len(parts)
                used.update(words)
    if not found:
        shown = alternatives(label, names)
        raise InputError(f"{source}: no entry of the model is like {shown}.")
    for words, _ in patterns:
        for word in words:
            if word not in used:
                parts_of = [part for name in names for part in name.split(".")]
                shown = alternatives(word, dict.fromkeys(parts_of))
                raise InputError(f'{source}: in "{label}" nothing is like {shown}.')
    numeric = tuple(each for each in found if _can_vary(each, file))
    if not numeric:
        keys_of(max(found, key=found.__getitem__), file)  # says why not
    return numeric


def _is_pattern(label: str) -> bool:
    return any(sign in label for sign in "*{")


def _can_vary(field: str, file: ModelFile) -> bool:
    try:
        keys_of(field, file)
    except InputError:
        return False
    return True


def _without_braces(pattern: str) -> Iterator[tuple[tuple[str, ...], str]]:
    """Yield the alternatives in braces that are chosen, and the pattern with them."""
    pieces = _BRACES.split(pattern)
    choices = [piece.split(",") if i % 2 else [piece] for i, piece in enumerate(pieces)]
    for chosen in product(*choices):
        stripped = [part.strip() for part in chosen]
        yield tuple(stripped[1::2]), "".join(stripped)


def recorded_variables(table: Mapping[str, Any], model: Structure) -> Variables:
    """Return the variables that a study's settings describe, with bounds in SI units."""
    labels = table["labels"]
    ends = zip(table["lower"], table["upper"], strict=True)
    made = variables_in_si(dict(zip(labels, ends, strict=True)), model, "the recorded variables")
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
        splines=recorded_splines(labels, model.file),
    )


def variables_in_si(
    bounds: Mapping[str, Sequence[Any]], model: Structure, source: str
) -> Variables:
    """Make design variables with bounds that are SI numbers; see `variables`."""
    given = {
        label: (
            *(_text(value, label, model, len(ends) > 2) for value in ends[:2]),
            *ends[2:],
        )
        for label, ends in bounds.items()
    }
    return variables(given, model, source)


def _text(value: float, label: str, model: Structure, along: bool) -> object:
    if along:
        return f"{value!r} m"
    load = load_variable(label, model)
    label = fields_of(label, model.file, "the variables")[0]
    keys = () if load is not None else keys_of(label, model.file)
    own = value_of(keys, model.file) if load is None else quantity_of(load)
    _, unit = infer_quantity(getattr(own, "text", own), label)
    return unit.exact(value)
