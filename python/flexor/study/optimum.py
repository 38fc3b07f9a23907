"""The best design of a study, or that of each of several objectives, as a model file."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from flexor.errors import InputError, one_line
from flexor.store import write_text
from flexor.store.files import reason

if TYPE_CHECKING:
    from flexor.study.design import Design
    from flexor.study.study import Study

OPTIMUM = "optimum.toml"
# How a file with a design in place of the model's own begins: it may be written again.
MARK = "# Saved by flexor: "


def designed_text(design: Design, what: str) -> str:
    """Return the model file of a design, with what it is in its first line.

    InputError if the design is none of a model file, as that of a user's parameter set may be.
    """
    return f"{one_line(f'{MARK}{what}: {design.text}')}\n\n{design.model.to_toml()}"


def save_optimum(study: Study) -> None:
    """Write the best design into the folder of a study, of several objectives that of each.

    Without a design that succeeded, and for parameter sets that no model file can express, there
    is nothing to write.
    """
    if study.folder is None:
        return
    for path, design, what in _optima(study, study.folder):
        save_design(path, design, f"{what} of the study {study.folder.name}")


def save_design(path: Path, design: Design, what: str) -> None:
    """Write the model file of a design where it is one; InputError if it cannot be written."""
    try:
        text = designed_text(design, what)
    except InputError:
        return
    try:
        write_text(path, text)
    except OSError as error:
        raise InputError(f'"{path}" cannot be written: {reason(error)}.') from error


def called(best: Design, robust: bool | None) -> str:
    """Return what the best design of a study is called in its file, which may go elsewhere."""
    if any(each.state == "BROKEN" for each in best.kept):
        return "the least infeasible design, NOT FEASIBLE,"
    return "the best design found, NOT ROBUST," if robust is False else "the optimum"


def optimum_files(folder: Path) -> list[Path]:
    """Return the model files of the best designs that a folder has."""
    return sorted(folder.glob(f"{Path(OPTIMUM).stem}*.toml"))


def _optima(study: Study, folder: Path) -> Iterator[tuple[Path, Design, str]]:
    if study.problem.objective.count:
        front = study.front
        for column, wanted in enumerate(front.objectives if len(front) else ()):
            best = front[int(front.values[:, column].argmin())]
            name = re.sub(r"[^\w.+-]", "-", wanted.quantity)
            yield folder / f"optimum-{name}.toml", best, f"the best design to {wanted.name}"
    elif study.record.best() is not None:
        best = study.best
        yield folder / OPTIMUM, best, called(best, study.robust)
