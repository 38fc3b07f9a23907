"""Writing a design as a model file."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from flexor.cli.console import note
from flexor.errors import one_line

if TYPE_CHECKING:
    from flexor.study import Design


def save_model(design: Design, file: Path | None, what: str) -> None:
    """Write the model file of a design, with what it is in its first line, and print its path."""
    if file is None:
        return
    from flexor.store import write_text

    write_text(file, f"{one_line(f'# {what}: {design.text}')}\n\n{design.model.to_toml()}")
    note(f"model file: {file}")
