"""The text of a model file as its author wrote it, in which values are changed in place."""

from __future__ import annotations

from collections.abc import Callable, Mapping, MutableMapping, MutableSequence
from dataclasses import dataclass
from typing import Any

from flexor.errors import InputError
from flexor.model.changes import changed
from flexor.model.quantity import infer_quantity
from flexor.model.reading import check
from flexor.model.schema import ModelFile
from flexor.model.toml import tables

Document = Mapping[str, Any]


@dataclass(frozen=True)
class Written:
    """The text of a model file, and the tables that it is to have.

    Attributes
    ----------
    text : str
        The text.
    document : dict
        Its tables, with the changes since.
    file : ModelFile or None
        What the text is as it stands, if that is known.
    """

    text: str
    document: Document
    file: ModelFile | None = None

    @classmethod
    def of(cls, text: str, source: str = "model") -> Written:
        """Return a text with its own tables; InputError if it is not valid TOML."""
        return cls(text, tables(text, source))

    def changed(self, change: Callable[[Document], Document]) -> Written | None:
        """Return the text with changed tables; None if the change does not apply to them."""
        try:
            return Written(self.text, change(self.document))
        except InputError:
            return None

    def with_fields(self, values: Mapping[str, object]) -> Written | None:
        """Return the text with other values of fields; see `flexor.model.changes.changed`."""

        def change(document: Document) -> Document:
            for path, value in values.items():
                document = changed(document, path, value, "model")
            return document

        return self.changed(change)

    def toml(self, file: ModelFile) -> str:
        """Return the text with its changes, which is that of a checked file to all digits.

        Comments, order and units stay. Where the text cannot be changed in this way it is the
        complete ``file.to_toml()``.
        """
        if file is self.file:
            return self.text
        import tomlkit
        from tomlkit.exceptions import TOMLKitError

        try:
            document = tomlkit.parse(self.text)
            _update(document, document.unwrap(), self.document)
            text = tomlkit.dumps(document)
            if check(tables(text, file.name), source=file.name) == file:
                return text
        except (InputError, TOMLKitError, RecursionError):
            pass
        return file.to_toml()


def _update(table: MutableMapping[str, Any], old: Document, new: Document) -> None:
    """Give a table of tomlkit the values ``new`` where they differ from the ``old``."""
    for key in [key for key in old if key not in new]:
        del table[key]
    for key, value in new.items():
        if key not in old:
            table[key] = _item(value)
        else:
            _replace(table, key, old[key], value)


def _replace(table: Any, key: Any, old: Any, new: Any) -> None:
    if type(old) is type(new) and old == new:
        return
    if isinstance(old, Mapping) and isinstance(new, Mapping):
        _update(table[key], old, new)
    elif _is_list(old) and _is_list(new) and len(old) == len(new):
        items: MutableSequence[Any] = table[key]
        for i, (before, after) in enumerate(zip(old, new, strict=True)):
            _replace(items, i, before, after)
    else:
        table[key] = _item(_in_unit(new, old))


def _is_list(value: object) -> bool:
    return isinstance(value, (list, tuple))


def _item(value: Any) -> Any:
    """Return a value for tomlkit, with tables in one line."""
    import tomlkit

    if isinstance(value, Mapping):
        inline = tomlkit.inline_table()
        for key, each in value.items():
            inline[key] = _item(each)
        return inline
    if _is_list(value):
        array = tomlkit.array()
        for each in value:
            array.append(_item(each))
        return array
    return tomlkit.item(value)


def _in_unit(new: object, old: object) -> object:
    """Return a quantity in the unit of another, with all digits."""
    if not (isinstance(new, str) and isinstance(old, str)):
        return new
    try:
        value, unit = infer_quantity(new, "value")
        _, own = infer_quantity(old, "value")
    except InputError:
        return new
    return own.digits(value) if own.si == unit.si else new
