"""Writing a design as a model file."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from flexor.cli.console import note
from flexor.errors import InputError

if TYPE_CHECKING:
    from flexor.study import Design


def check_model_file(file: Path | None) -> Path | None:
    """Reject a file that cannot or should not be written, before anything is computed."""
    if file is None:
        return None
    from flexor.store import check_regular, check_writable
    from flexor.study.optimum import MARK

    if file.suffix != ".toml":
        raise InputError(f'--save is "{file}": a model file must end in .toml.')
    check_writable(file)
    if check_regular(file):
        with file.open(encoding="utf-8", errors="replace") as opened:
            if opened.readline(len(MARK)) != MARK:
                raise InputError(
                    f'--save is "{file}", which exists and was not saved by flexor: choose '
                    "another name."
                )
    return file


def save_model(design: Design, file: Path | None, what: str) -> None:
    """Write the model file of a design, with what it is in its first line, and print its path."""
    if file is None:
        return
    from flexor.store import write_text
    from flexor.study.optimum import designed_text

    write_text(file, designed_text(design, what))
    note(f"model file: {file}")
