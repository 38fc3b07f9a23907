"""Discrete choices of a design: values of fields from a list, and entries with or without."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from typing import TYPE_CHECKING, Any

from flexor.errors import InputError
from flexor.materials import library
from flexor.model.changes import changed, path_of, removed
from flexor.model.reading import check
from flexor.model.schema.material import own_keys
from flexor.model.validation import describe

if TYPE_CHECKING:
    from flexor.model import Model

WITH, WITHOUT = "with", "without"
MOST = 64


@dataclass(frozen=True)
class Combination:
    """One value for each choice.

    Attributes
    ----------
    values : dict
        By the field, or by what there is or is not: ``"with"`` or ``"without"``.
    model : Model
        The model that has them.
    """

    values: Mapping[str, object]
    model: Model

    @property
    def name(self) -> str:
        """Such as ``"exosuit.material ecoflex-00-30, without middle"``."""
        return named(self.values)


def named(values: Mapping[str, object]) -> str:
    """Return a name for values of choices."""
    return ", ".join(
        f"{value} {field}" if value in (WITH, WITHOUT) else f"{field} {value}"
        for field, value in values.items()
    )


def combinations(
    choices: Mapping[str, Sequence[object]], model: Model, source: str = "choices"
) -> tuple[Combination, ...]:
    """Return the models of all combinations of choices.

    Parameters
    ----------
    choices
        Two or more values for each field, ``{"exosuit.material": ["ecoflex-00-30", "paper"]}``,
        or ``["with", "without"]`` for an entry such as a strap or a table such as a layer.
    model
        The model; its title then says the combination, and its ``[design]`` has no choices, nor
        variables and tolerances of what there is not.
    source
        Where the choices come from, for messages.

    Raises
    ------
    InputError
        If there is no such field, a choice has fewer than two values or two that are the same,
        there are too many combinations, or one is no valid model.
    """
    for field, values in choices.items():
        if isinstance(values, str) or not isinstance(values, Sequence) or len(values) < 2:
            raise InputError(
                f"{source}: {field} is {describe(values)}: give a list of two or more values."
            )
        shown = [str(value) for value in values]
        if len(set(shown)) < len(shown):
            twice = next(each for each in shown if shown.count(each) > 1)
            raise InputError(f'{source}: {field} has "{twice}" twice.')
        if set(shown) & {WITH, WITHOUT} and set(shown) != {WITH, WITHOUT}:
            raise InputError(f'{source}: {field}: "with" and "without" go together, and alone.')
    total = 1
    for values in choices.values():
        total *= len(values)
    if total > MOST:
        raise InputError(f"{source}: there are {total:,} combinations: at most {MOST}.")
    rows = (dict(zip(choices, row, strict=True)) for row in product(*choices.values()))
    return tuple(Combination(row, _model(row, model, source)) for row in rows)


def check_chosen(
    choices: Mapping[str, Sequence[object]],
    bounds: Mapping[str, object],
    model: Model,
    source: str = "choices",
) -> None:
    """Raise InputError if a field has both choices and bounds."""
    document = model.file.to_document()
    for field in choices:
        keys = path_of(document, field, source)
        if any(_path_or_none(document, each) == keys for each in bounds):
            raise InputError(f'{source}: "{field}" has bounds too: give it either of them.')


def without_fields(
    given: Mapping[str, Any], combination: Mapping[str, object], model: Model
) -> dict[str, Any]:
    """Leave out those of some fields that a combination is without.

    Parameters
    ----------
    given
        By field.
    combination
        Values of the choices.
    model
        The model with everything.
    """
    document = model.file.to_document()
    gone = [path_of(document, each, "choices") for each in _gone(combination)]
    return {field: value for field, value in given.items() if not _is_in(document, field, gone)}


def _gone(values: Mapping[str, object]) -> Iterator[str]:
    return (field for field, value in values.items() if value == WITHOUT)


def _is_in(document: Mapping[str, Any], field: str, gone: Sequence[list[str]]) -> bool:
    keys = _path_or_none(document, field)
    return keys is not None and any(keys[: len(each)] == each for each in gone)


def _path_or_none(document: Mapping[str, Any], field: str) -> list[str] | None:
    try:
        return path_of(document, field, field)
    except InputError:  # of other fields it is said where they are used
        return None


def _model(values: Mapping[str, object], model: Model, source: str) -> Model:
    from flexor.model import Model as Built

    place = f"{source}: {named(values)}"
    document = _document(model.file.to_document(), values, model, source)
    written = model.written
    if written is not None:
        written = written.changed(lambda tables: _document(tables, values, model, source))
    return Built(check(document, source=place), place, written)


def _document(
    document: Mapping[str, Any], values: Mapping[str, object], model: Model, source: str
) -> dict[str, Any]:
    """Return the tables of a model file with values of choices."""
    whole = document
    document = dict(document)
    for field, value in values.items():
        if value in (WITH, WITHOUT):
            path_of(document, field, source)  # it has to be there
        else:
            document, value = _with_thread(document, field, value, source)
            document = changed(document, field, value, source)
    for field in _gone(values):
        document = removed(document, field, source)
    if document.get("design"):
        document = {**document, "design": _design(document["design"], values, whole)}
    return {**document, "title": f"{model.title or model.name} ({named(values)})"}


def _with_thread(
    document: dict[str, Any], field: str, value: object, source: str
) -> tuple[dict[str, Any], object]:
    """Let a material of the library that takes the place of a wound one be wound likewise.

    Thread belongs to what is made of a material, and the library has materials only.
    """
    if field.rpartition(".")[2] != "material" or not isinstance(value, str):
        return document, value
    keys = path_of(document, field, source)
    node: Any = document
    for key in keys:
        node = node[int(key)] if isinstance(node, (list, tuple)) else node[key]
    materials = document.get("materials", {})
    winding = materials.get(node, {}).get("winding", "none")
    own = own_keys(materials.get(value, {"library": value}))
    if winding == "none" or "skin" in keys or value not in library() or set(own) != {"library"}:
        return document, value
    name = f"{value}-{winding}"
    wound = {"library": value, "winding": winding}
    return {**document, "materials": {**materials, name: wound}}, name


def _design(
    table: Mapping[str, Any], values: Mapping[str, object], document: Mapping[str, Any]
) -> dict[str, Any]:
    gone = [path_of(document, each, "choices") for each in _gone(values)]
    made = dict(table)
    made["variable"] = [
        each
        for each in table.get("variable", ())
        if not each.get("choices") and not _is_in(document, each["field"], gone)
    ]
    made["tolerance"] = {
        field: size
        for field, size in table.get("tolerance", {}).items()
        if not _is_in(document, field, gone)
    }
    return {key: value for key, value in made.items() if value not in ([], {})}
