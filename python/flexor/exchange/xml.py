"""A reader of XML that takes elements and attributes only, without entities and within bounds."""

from __future__ import annotations

import pathlib
from dataclasses import dataclass, field
from typing import Any
from xml.parsers import expat

import numpy as np

from flexor.arrays import Array
from flexor.errors import InputError, shortened
from flexor.model.toml import is_special

# Far beyond any limb; what is larger is refused before it takes memory.
MAX_BYTES, MAX_ELEMENTS, MAX_DEPTH = 20_000_000, 200_000, 100


@dataclass(eq=False)
class Element:
    """An element with its attributes and what it contains; texts between elements are left out."""

    tag: str
    attributes: dict[str, str]
    where: str  # file and line, for messages
    children: list[Element] = field(default_factory=list)

    @property
    def title(self) -> str:
        """Its tag and its name, for messages."""
        name = self.attributes.get("name")
        return f"<{self.tag}>" if name is None else f'<{self.tag} name="{shortened(name)}">'

    def error(self, tail: str) -> InputError:
        """Return the error that says something about it."""
        return InputError(f"{self.where}: {self.title} {tail}.")

    def text(self, key: str) -> str:
        """Return an attribute that must be there."""
        if key not in self.attributes:
            raise self.error(f"has no {key}")
        return self.attributes[key]

    def numbers(self, key: str, count: int | None = None, default: str | None = None) -> Array:
        """Return the numbers of an attribute, so many or any number of them."""
        text = self.attributes.get(key, default)
        if text is None:
            text = self.text(key)
        try:
            found = np.array([float(word) for word in text.split()])
        except ValueError:
            found = np.array([np.nan])
        wanted = "numbers" if count is None else "a number" if count == 1 else f"{count} numbers"
        if not np.isfinite(found).all() or (count is not None and len(found) != count):
            raise self.error(f'has {key}="{shortened(text)}": expected {wanted}')
        return found

    def number(self, key: str, default: float | None = None) -> float:
        """Return the number of an attribute."""
        return float(self.numbers(key, 1, None if default is None else repr(default))[0])

    def children_of(self, tag: str) -> list[Element]:
        """Return the children with a tag."""
        return [child for child in self.children if child.tag == tag]


def read_xml(path: pathlib.Path) -> Element:
    """Read an XML file.

    Raises
    ------
    InputError
        If it cannot be read, is no XML, declares a document type or entities, or is too large.
    """
    if is_special(path):
        raise InputError(f'cannot read the file "{path}": it is not a regular file.')
    try:
        with path.open("rb") as file:
            content = file.read(MAX_BYTES + 1)
    except (OSError, ValueError) as error:
        why = getattr(error, "strerror", None) or str(error)
        raise InputError(f'cannot read the file "{path}": {why.lower()}.') from None
    if len(content) > MAX_BYTES:
        raise InputError(
            f'cannot read the file "{path}": it has more than {MAX_BYTES // 1_000_000} MB.'
        )
    return parse_xml(content, str(path))


def parse_xml(content: bytes, source: str) -> Element:
    """Parse XML; ``source`` is the file's name, for messages."""
    parser = expat.ParserCreate()
    open_elements: list[Element] = []
    roots: list[Element] = []
    count = 0

    def where() -> str:
        return f"{source}, line {parser.CurrentLineNumber}"

    def start(tag: str, attributes: dict[str, str]) -> None:
        nonlocal count
        count += 1
        if count > MAX_ELEMENTS:
            raise InputError(f"{where()}: the file has more than {MAX_ELEMENTS:,} elements.")
        if len(open_elements) >= MAX_DEPTH:
            raise InputError(f"{where()}: elements are nested more than {MAX_DEPTH} levels deep.")
        element = Element(tag, attributes, where())
        (open_elements[-1].children if open_elements else roots).append(element)
        open_elements.append(element)

    def end(_: str) -> None:
        open_elements.pop()

    def refuse(*_: Any) -> None:
        raise InputError(f"{where()}: document types and entities are not read: remove them.")

    parser.StartElementHandler, parser.EndElementHandler = start, end
    parser.StartDoctypeDeclHandler = parser.EntityDeclHandler = refuse
    try:
        parser.Parse(content, True)
    except expat.ExpatError as error:
        what = expat.ErrorString(error.code)
        raise InputError(f"{source}: not valid XML at line {error.lineno}: {what}.") from None
    return roots[0]
