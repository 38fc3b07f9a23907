"""Reading model files and presets, the model files shipped with Flexor."""

from __future__ import annotations

import os
import pathlib
import warnings
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

from pydantic import ValidationError

from flexor.errors import InputError, ModelWarning, shortened, unknown_name
from flexor.model import composition, variants
from flexor.model.changes import changed
from flexor.model.schema import ModelFile
from flexor.model.schema.inclusion import Inclusion
from flexor.model.toml import check_depth, read_text, tables
from flexor.model.validation import first_error

_FOLDER = pathlib.Path(__file__).resolve().parent.parent / "examples"


def presets() -> tuple[str, ...]:
    """Return the names of the shipped models."""
    files = (file.stem for file in _FOLDER.glob("*.toml"))
    return tuple(sorted(name for name in files if not name.endswith("-targets")))


def locate(model: str | os.PathLike[str]) -> pathlib.Path:
    """Locate the file of a model."""
    path, text = pathlib.Path(model), os.fspath(model)
    if not text.strip():
        raise InputError("MODEL is empty: give the name of a preset, or the path of a model file.")
    if path.is_file():
        return path
    shipped = presets()
    if text in shipped:
        return _FOLDER / f"{text}.toml"
    known = path.parent.name == "examples" and path.suffix == ".toml" and path.stem in shipped
    if known and not os.path.lexists(path):
        return _FOLDER / path.name
    if path.suffix == ".toml" or path.exists() or path.name != text:
        kinds = {path.is_dir(): "it is a folder", not path.exists(): "no such file"}
        why = kinds.get(True, "it is not a regular file")
        raise InputError(f'cannot read the model file "{text}": {why}.')
    raise InputError(f"{unknown_name('preset', text, shipped)}, or the path of a model file.")


def read(
    path: pathlib.Path, use: str | None = None, changes: Mapping[str, object] | None = None
) -> ModelFile:
    """Read and check a model file.

    Parameters
    ----------
    path
        The file.
    use
        Variant to apply instead of the file's own choice.
    changes
        Values that override those of the file, by dotted path; see `flexor.model.changes`.

    Raises
    ------
    InputError
        If it cannot be read, is not valid TOML, or is not a valid model.
    """
    text = read_text(path, "model file")
    return check(tables(text, str(path)), use=use, changes=changes, source=str(path), place=path)


def parse(
    text: str,
    use: str | None = None,
    changes: Mapping[str, object] | None = None,
    source: str = "model",
) -> ModelFile:
    """Read and check the text of a model file.

    Parameters
    ----------
    text
        The text.
    use, changes
        As for `read`.
    source
        The file's name, for messages.

    Raises
    ------
    InputError
        If it is not valid TOML or not a valid model.
    """
    return check(tables(text, source), use=use, changes=changes, source=source)


def check(
    document: Mapping[str, Any],
    use: str | None = None,
    changes: Mapping[str, object] | None = None,
    source: str = "model",
    place: pathlib.Path | None = None,
) -> ModelFile:
    """Validate a parsed model file with each of its variants.

    The files of its parts are beside it; where its place is not known they can only be presets.
    """
    parts = _Parts(None) if place is None else _Parts(place.parent, (place.resolve(),))
    file = _checked(document, use, changes or {}, source, parts)
    if "gravity" not in document and not any(file.gravity.components):
        _warn_of_gravity(parts, source)
    return file


def _warn_of_gravity(parts: _Parts, source: str) -> None:
    """Warn that parts have gravity by themselves, which a model does not have from them."""
    heavy = [key for key, file in parts.known.items() if any(file.gravity.components)]
    if heavy:
        names = ", ".join(dict.fromkeys(f'"{pathlib.Path(path).name}"' for path, *_ in heavy))
        what = f"{names} {'has' if len(heavy) == 1 else 'have'} gravity, which a part leaves behind"
        how = 'gravity = { z = "-9.81 m/s^2" }, or zero for a model without weight'
        warnings.warn(f"{source}: {what}: state it in this file, such as {how}.", ModelWarning, 3)


def _checked(
    document: Mapping[str, Any],
    use: str | None,
    changes: Mapping[str, object],
    source: str,
    parts: _Parts,
) -> ModelFile:
    check_depth(document, source)
    of_parts = {path: value for path, value in changes.items() if path.startswith("parts.")}
    for path, value in of_parts.items():
        document = changed(document, path, value, source)
    document = composition.expanded(document, source, parts.read)
    for path, value in changes.items():
        if path not in of_parts:
            document = changed(document, path, value, source)
    chosen = variants.choose(document, use, source)
    for name in variants.names(document, source):
        if name != chosen:
            _validated(document, name, source)
    return _validated(document, chosen, source)


@dataclass(frozen=True)
class _Parts:
    """Where the files of parts are, and those that have been read.

    A file names its parts by their place beside it or in a folder there, never elsewhere, so that a
    stranger's file reads nothing else; other names are those of presets.
    """

    folder: pathlib.Path | None
    above: tuple[pathlib.Path, ...] = ()
    known: dict[tuple[str, ...], ModelFile] = field(default_factory=dict)

    def read(self, part: Inclusion, source: str) -> ModelFile:
        """Read and check the file of a part; see `composition.expanded`."""
        path = self._locate(part.file, source)
        if path in self.above:
            ring = [each.name for each in (*self.above[self.above.index(path) :], path)]
            raise InputError(
                f'{source}.file is "{part.file}": a model cannot be a part of itself '
                f"({' -> '.join(ring)})."
            )
        if len(self.above) >= composition.MAX_DEPTH:
            most = composition.MAX_DEPTH
            raise InputError(f"{source}: parts are nested more than {most} levels deep.")
        key = (str(path), str(part.variant), repr(part.set))
        if key not in self.known:
            if len(self.known) >= composition.MAX_PARTS:
                most = composition.MAX_PARTS
                raise InputError(f"{source}: the model has more than {most} parts.")
            document = tables(read_text(path, "file of a part"), str(path))
            inner = replace(self, folder=path.parent, above=(*self.above, path))
            place = f"{source}, {path.name}"
            self.known[key] = _checked(document, part.variant, part.set, place, inner)
        return self.known[key]

    def _locate(self, name: str, source: str) -> pathlib.Path:
        given = pathlib.PurePath(name)
        inside = not (given.is_absolute() or given.drive or ".." in given.parts or "\\" in name)
        place = f'{source}.file is "{name}"'
        if not inside:
            tail = "the file of a part must be in the folder of the model file, or in one within it"
            raise InputError(f"{place}: {tail}.")
        if self.folder is not None and name.strip():
            path = (self.folder / given).resolve()
            within = path.is_relative_to(self.folder.resolve())
            if path.is_file() and within:
                return path
            if os.path.lexists(self.folder / given):  # rather than a preset of that name
                leads = "leads out of the folder of the model file" if not within else "is no file"
                tail = "leads to a file that does not exist" if not path.exists() else leads
                raise InputError(f"{place}, which {tail}.")
        stem = given.stem if given.suffix == ".toml" and len(given.parts) == 1 else name
        if stem in presets():
            return _FOLDER / f"{stem}.toml"
        beside = sorted(each.name for each in (self.folder or _FOLDER).glob("*.toml"))
        what = unknown_name("file", name, [*beside, *presets()])
        raise InputError(f"{source}.file refers to the {what}.")


def with_changes(file: ModelFile, values: Mapping[str, Any], source: str) -> ModelFile:
    """Return a file with changes such as those of a variant, and no variants of its own.

    InputError, beginning with ``source``, if it is then no valid model.
    """
    document = file.to_document()
    return _validated(variants.with_changes(document, values), None, source)


def _validated(document: Mapping[str, Any], chosen: str | None, source: str) -> ModelFile:
    complete = variants.applied(document, chosen)
    try:
        return ModelFile.model_validate(complete)
    except ValidationError as error:
        path, tail = first_error(error, complete)
    found = variants.place(document, chosen, path)
    if found == path and chosen in document.get("variants", {}):
        source = _blamed(document, chosen, (path, tail), source)
    path = shortened(found, 200)
    raise InputError(f"{source}: {path} {tail}." if path else f"{source}: it {tail}.")


def _blamed(
    document: Mapping[str, Any], chosen: str | None, found: tuple[str, str], source: str
) -> str:
    """Return the source of an error with the variant that causes it.

    An error that is also there without the variant, or with another one, is not its own.
    """
    every = [name for name in document["variants"] if name != chosen]
    usual = document.get("use")
    others = [usual] if usual in every else every[:1]
    for other in (variants.without(document), *(variants.applied(document, o) for o in others)):
        try:
            ModelFile.model_validate(other)
        except ValidationError as error:
            if first_error(error, other) == found:
                return source
    return f"{source}: variants.{chosen}"
