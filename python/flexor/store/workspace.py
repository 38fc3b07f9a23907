"""Work folders: created atomically, used by one process at a time, resumed as they were.

settings.json   everything that determines the results
record.sqlite   everything that was evaluated (`Database`)
lock            held by the process that uses the folder

and the files that the kind of work adds, such as the model.
"""

from __future__ import annotations

import os
import secrets
import shutil
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from flexor.errors import InputError
from flexor.store.database import Database
from flexor.store.files import check_regular, check_writable, reason, remove_drafts
from flexor.store.lock import Lock
from flexor.store.settings import (
    SETTINGS,
    Kind,
    check_versions,
    merged,
    new_settings,
    read_settings,
    write_settings,
)

RECORD = "record.sqlite"
# Endings of the files that are written when the work is done.
_OUTPUTS = (".csv", ".json", ".md", ".npz", ".png", ".svg", ".toml")


class Workspace:
    """A folder that this process works in, or the same in memory (a ``folder`` of None).

    A new folder gets the settings ``values`` (without their header), more ``files`` by name, and a
    record that begins with ``notes``. An old one is resumed if it is of this kind, not in use, made
    with the same versions of Flexor, its engine and the ``packages`` used, and its settings are
    these; ``settings`` are then those in the folder, with what may differ or grow as wanted.
    InputError says which of this does not hold.

    A context manager: at its end the lock is released, so outputs are written before; the record
    ``database`` stays open unless something was raised.
    """

    def __init__(
        self,
        kind: Kind,
        folder: str | Path | None,
        values: Mapping[str, Any],
        files: Mapping[str, str],
        resume: bool = False,
        notes: Mapping[str, Any] | None = None,
        packages: Iterable[str] = (),
    ) -> None:
        self.kind, self.resumed = kind, resume
        self.folder = None if folder is None else Path(folder)
        self._lock: Lock | None = None
        settings = new_settings(kind, values)
        if self.folder is None:
            if resume:
                raise InputError(f"resuming a {kind.name} needs its folder.")
            self.settings, self.database = settings, _new_record(None, kind, notes or {})
            return
        if resume:
            read_settings(kind, self.folder)  # check the kind before writing
            for path in self.folder.iterdir():
                if path.suffix in _OUTPUTS:
                    check_writable(path)
        else:
            _create(kind, self.folder, settings, files, notes or {})
        self._lock = Lock(self.folder, kind.name)
        try:
            if resume:
                kept = read_settings(kind, self.folder)
                check_versions(kind, self.folder, kept, packages)
                remove_drafts(self.folder)
                settings = merged(kind, self.folder, kept, settings)
            self.settings = settings
            self.database = open_record(kind, self.folder)
        except BaseException:
            self._lock.release()
            raise

    def check_reproduces(self, recorded: ArrayLike, found: ArrayLike) -> None:
        """Refuse to resume if what was recorded is now found to be something else.

        The settings cannot tell whether a user's own function is still the same.
        """
        then, now = np.asarray(recorded, dtype=np.float64), np.asarray(found, dtype=np.float64)
        differs = ~np.isclose(now, then, rtol=1e-9, atol=1e-12, equal_nan=True)
        if differs.any():
            raise InputError(
                f'the {self.kind.name} "{self.folder}" no longer reproduces: it recorded '
                f"{then[differs][0]:.9g}, which is now {now[differs][0]:.9g}, since a model, a "
                "function or the machine has changed: start a new one."
            )

    def save_settings(self) -> None:
        """Write the settings of resumed work in place of those in the folder."""
        if self.folder is not None and self.resumed:
            try:
                write_settings(self.folder, self.settings)
            except OSError as error:
                raise InputError(
                    f'the settings of "{self.folder}" cannot be written: {reason(error)}.'
                ) from error

    def __enter__(self) -> Workspace:
        return self

    def __exit__(self, kind: type[BaseException] | None, *_: object) -> None:
        if kind is not None:
            self.database.close()
        if self._lock is not None:
            self._lock.release()


def open_record(kind: Kind, folder: Path, write: bool = True) -> Database:
    """Open the record of a folder, for reading only unless ``write``."""
    if not check_regular(folder / RECORD):
        raise InputError(f'the {kind.name} "{folder}" is damaged: it has no {RECORD}.')
    return Database(folder / RECORD, write=write)


def _create(
    kind: Kind,
    folder: Path,
    settings: Mapping[str, Any],
    files: Mapping[str, str],
    notes: Mapping[str, Any],
) -> None:
    """Make a folder beside its place and rename it, so that nothing is ever left half made."""
    what = f'the {kind.name} folder "{folder}" cannot be made'
    try:
        if folder.exists() and (not folder.is_dir() or any(folder.iterdir())):
            if (folder / SETTINGS).exists():
                raise InputError(
                    f'"{folder}" holds recorded work already: resume it or choose another folder.'
                )
            raise InputError(f'"{folder}" is not an empty folder: choose another.')
        folder.parent.mkdir(parents=True, exist_ok=True)
        draft = folder.with_name(f".{folder.name}-{secrets.token_hex(4)}")
        draft.mkdir()  # the umask decides who may read it
    except OSError as error:
        raise InputError(f"{what}: {reason(error)}.") from error
    try:
        write_settings(draft, settings)
        for name, text in files.items():
            (draft / name).write_text(text, encoding="utf-8")
        _new_record(draft / RECORD, kind, notes).close()
        if folder.is_dir():
            folder.rmdir()
        os.rename(draft, folder)
    except OSError as error:
        raise InputError(f"{what}: {reason(error)}.") from error
    except InputError as error:
        raise InputError(f"{what}: {error.__cause__ or error}.") from error
    finally:
        shutil.rmtree(draft, ignore_errors=True)


def _new_record(path: Path | None, kind: Kind, notes: Mapping[str, Any]) -> Database:
    database = Database(path, kind.tables)
    for key, value in notes.items():
        database.note(key, value)
    return database
