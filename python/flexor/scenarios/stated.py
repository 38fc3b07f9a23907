"""Reading tolerances of design parameters and of other fields of a model file."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING

from flexor.design import MappedVariables, ParameterSet, Variables
from flexor.design.fields import keys_of, value_of
from flexor.design.stated_variables import SharedVariables
from flexor.errors import InputError
from flexor.model.quantity import infer_quantity
from flexor.model.schema.profile import Spline
from flexor.model.validation import describe
from flexor.scenarios.tolerance import Tolerance, split

if TYPE_CHECKING:
    from flexor.model.structure import Structure


def tolerances(
    given: Mapping[str, object] | None,
    chosen: ParameterSet,
    model: Structure,
    source: str = "--tolerance",
) -> tuple[Tolerance, ...]:
    """Read tolerances.

    Parameters
    ----------
    given
        By label of a design parameter or, where these are fields, by any numeric field: the largest
        error with its unit such as ``"0.1 mm"``, or ``"0.1 mm normal"`` for a standard deviation.
        Of a size that varies along a rod it is that of each control value.
    chosen
        The design parameters.
    model
        The model.
    source
        Where they come from, for messages.

    Raises
    ------
    InputError
        If there is no such field, two are for one field, or an error has no unit, one of another
        kind, or is not above 0.
    """
    if given is not None and not isinstance(given, Mapping):
        raise InputError(f"{source} is {describe(given)}: it must be a table of errors by field.")
    found: dict[tuple[str, ...], Tolerance] = {}
    for name, value in _with_splines(given or {}, chosen, model, source):
        size, kind = split(value, f"{source}: {name}")
        keys, label = _place(name, chosen, model, source)
        if keys in found:
            raise InputError(f'{source}: "{name}" is the same field as "{found[keys].field}".')
        number = _size(name, label, size, chosen, model, source)
        if not number > 0.0:
            raise InputError(f"{source}: {name} is {describe(value)}: it must be above 0.")
        found[keys] = Tolerance(label, kind, number, str(value))
    return tuple(found.values())


def _with_splines(
    given: Mapping[str, object], chosen: ParameterSet, model: Structure, source: str
) -> Iterator[tuple[str, object]]:
    """Yield tolerances, those of a size that varies along a rod for each control value.

    Of a radius that was linear, those of base and tip for the first and the last, and the larger
    one for those between.
    """
    splines = chosen.splines if isinstance(chosen, Variables) else {}
    ends: dict[str, dict[int, object]] = {}
    for name, value in given.items():
        size, _, end = name.rpartition(".")
        count = splines.get(name) or _control_values(name, model)
        if count:
            yield from ((f"{name}.spline.{i}", value) for i in range(count))
        elif size in splines and end in ("base", "tip"):
            ends.setdefault(size, {})[0 if end == "base" else splines[size] - 1] = value
        else:
            yield name, value
    for size, values in ends.items():
        largest = max(values.values(), key=lambda value: _reach(value, f"{source}: {size}"))
        last = splines[size] - 1
        for i in range(last + 1):
            label = f"{size}.spline.{i}"
            if label not in given and (i in values or 0 < i < last):
                yield label, values.get(i, largest)


def _control_values(name: str, model: Structure) -> int:
    """Return the number of control values of a size that is a spline in the file; 0 if none."""
    path = f"{name}.spline.0"
    try:
        keys = keys_of(path, model.file)
    except InputError:
        return 0
    found = value_of(keys[:-2], model.file)
    return len(found.spline) if isinstance(found, Spline) else 0


def _reach(value: object, place: str) -> float:
    size, kind = split(value, place)
    number, _ = infer_quantity(size, place)
    return Tolerance("", kind, number, "").reach


def _place(
    name: str, chosen: ParameterSet, model: Structure, source: str
) -> tuple[tuple[str, ...], str]:
    """Return what identifies a field, and its label."""
    if name in chosen.labels and (
        not isinstance(chosen, Variables) or chosen.fields != chosen.labels
    ):
        return (name,), name
    if not isinstance(chosen, Variables) or isinstance(chosen, MappedVariables):
        raise InputError(
            f'{source}: "{name}" is none of the variables, which have the errors where they are '
            f"no fields: these are {', '.join(chosen.labels)}."
        )
    keys = keys_of(name, model.file)
    whole: list[tuple[str, ...]] = [(label,) for label in chosen.labels]
    if isinstance(chosen, SharedVariables):
        whole = list(chosen.whole)
    for label, fields in zip(chosen.labels, whole, strict=True):
        if any(keys_of(field, model.file) == keys for field in fields):
            if len(fields) > 1:
                raise InputError(
                    f'{source}: "{name}" is a part of the variable "{label}", which has the error.'
                )
            return keys, label
    return keys, name


def _size(
    name: str,
    label: str,
    size: object,
    chosen: ParameterSet,
    model: Structure,
    source: str,
) -> float:
    if label in chosen.labels and (isinstance(size, str) or not isinstance(chosen, Variables)):
        return chosen.parse(label, str(size), source)
    own = value_of(keys_of(name, model.file), model.file)
    _, unit = infer_quantity(getattr(own, "text", own), name)
    if isinstance(size, str) and not unit.si:
        try:
            size = float(size)
        except ValueError:
            raise InputError(
                f"{source}: {name} is {describe(size)}: expected a plain number."
            ) from None
    number, found = infer_quantity(size, f"{source}: {name}")
    if found.si != unit.si:
        wanted = f"a value with its unit, such as {unit.text}" if unit.si else "a plain number"
        raise InputError(f"{source}: {name} is {describe(size)}: expected {wanted}.")
    return number
