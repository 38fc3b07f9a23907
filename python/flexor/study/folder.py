"""Study folders: made whole or not at all, opened with a clear answer if they are not studies.

settings.json   what decides the study's numbers (`Settings`)
model.toml      the model, as it was
record.sqlite   every evaluation (`Record`)
lock            held by the process that is running the study
"""

from __future__ import annotations

import os
import shutil
import tempfile
from pathlib import Path

from flexor.errors import InputError
from flexor.study.problem import Problem
from flexor.study.record import Record
from flexor.study.settings import Settings

RECORD = "record.sqlite"
MODEL = "model.toml"


def create(folder: Path, settings: Settings, problem: Problem) -> None:
    """Make a study folder.

    It is put together beside its place and then renamed, so that a process that dies on the way
    leaves no half study.

    Raises
    ------
    InputError
        If the place is taken or cannot be written.
    """
    if folder.exists() and (not folder.is_dir() or any(folder.iterdir())):
        if (folder / "settings.json").exists():
            raise InputError(
                f'"{folder}" holds a study already: resume it or choose another folder.'
            )
        raise InputError(f'"{folder}" is not an empty folder: choose another for the study.')
    try:
        folder.parent.mkdir(parents=True, exist_ok=True)
        draft = Path(tempfile.mkdtemp(prefix=f".{folder.name}-", dir=folder.parent))
    except OSError as error:
        raise _unwritable(folder, error) from error
    try:
        draft.chmod(0o755)
        settings.write(draft)
        (draft / MODEL).write_text(problem.model.file.to_toml(), encoding="utf-8")
        sizes = (problem.parameters.size, problem.force.size, len(problem.model.joints))
        Record(draft / RECORD, sizes).close()
        if folder.is_dir():
            folder.rmdir()
        os.rename(draft, folder)
    except OSError as error:
        raise _unwritable(folder, error) from error
    except InputError as error:
        why = error.__cause__ or error
        raise InputError(f'the study folder "{folder}" cannot be made: {why}.') from error
    finally:
        shutil.rmtree(draft, ignore_errors=True)


def keep_settings(folder: Path, settings: Settings) -> None:
    """Write the settings of a study in place of those that are there.

    Raises
    ------
    InputError
        If they cannot be written; those that are there stay.
    """
    try:
        settings.write(folder)
    except OSError as error:
        why = (error.strerror or str(error)).lower()
        raise InputError(f'the settings of "{folder}" cannot be written: {why}.') from error


def open_record(folder: Path, problem: Problem, write: bool) -> Record:
    """Open the record of a study folder.

    Raises
    ------
    InputError
        If it is missing, damaged or not of this problem's sizes.
    """
    path = folder / RECORD
    if not path.is_file():
        raise InputError(f'the study "{folder}" is damaged: it has no {RECORD}.')
    record = Record(path, write=write)
    sizes = [problem.parameters.size, problem.force.size, len(problem.model.joints)]
    if record.noted("sizes") != sizes:
        record.close()
        raise InputError(f'the study "{folder}" is damaged: its {RECORD} is of another study.')
    return record


def _unwritable(folder: Path, error: OSError) -> InputError:
    why = (error.strerror or str(error)).lower()
    return InputError(f'the study folder "{folder}" cannot be made: {why}.')
