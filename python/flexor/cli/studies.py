"""What the commands that make studies share: where they go, and what is said if interrupted."""

from __future__ import annotations

import re
import shlex
from pathlib import Path
from typing import TYPE_CHECKING

import typer

from flexor.cli.console import complain, err
from flexor.errors import ClusterError, InputError

if TYPE_CHECKING:
    from matplotlib.figure import Figure

STUDIES = Path("studies")
INTERRUPTED, LOST = 130, 3  # exit codes


def free_folder(*words: str) -> Path:
    """Return a folder in `studies/` that is named after words and does not exist yet.

    Parameters
    ----------
    *words : str
        Such as model, parameter set and objective.
    """
    name = re.sub(r"[^\w.+-]", "-", "-".join(words))
    names = [name, *(f"{name}-{count}" for count in range(2, 10_000))]
    return STUDIES / next(n for n in names if not (STUDIES / n).exists())


def refuse_settled(context: typer.Context, resume: Path, *free: str) -> None:
    """Refuse options whose values the folder that is resumed has already.

    Parameters
    ----------
    context : typer.Context
        Of the command.
    resume : Path
        The folder.
    *free : str
        Parameters of the command that may be given all the same.

    Raises
    ------
    InputError
        If others stand in the command line.
    """
    given = []
    for parameter in context.command.params:
        source = context.get_parameter_source(parameter.name or "")
        if parameter.name not in (*free, "resume") and source and source.name == "COMMANDLINE":
            given.append(max(parameter.opts, key=len))
    if given:
        raise InputError(
            f'{" and ".join(given)} beside --resume: "{resume}" goes on as it was begun.'
        )


def interrupted(place: Path | None, command: str, error: BaseException) -> int:
    """Say that a study has ended early and how to go on, and return the exit code.

    Parameters
    ----------
    place : Path or None
        The study folder, if it was made.
    command : str
        What resumes it, up to the folder.
    error : BaseException
        What ended it.
    """
    begun = place is not None and (place / "settings.json").exists()
    resuming = f"{command} {shlex.quote(str(place))}" if begun else None
    return ended_early(error, "design evaluated so far", resuming)


def ended_early(error: BaseException, kept: str, command: str | None) -> int:
    """Say that work has ended early and how to go on, and return the exit code.

    Parameters
    ----------
    error : BaseException
        What ended it: an interruption, or the loss of a cluster.
    kept : str
        Of what every one is kept.
    command : str or None
        What goes on with it; None if nothing was begun.
    """
    lost = isinstance(error, ClusterError)
    if command is None:
        complain(str(error) if lost else "interrupted before anything was computed.")
        return LOST if lost else INTERRUPTED
    if lost:
        complain(str(error))
    said = f"every {kept} is kept. To go on:\n  {command}"
    err.print(
        said[0].upper() + said[1:] if lost else f"interrupted; {said}", markup=False, soft_wrap=True
    )
    return LOST if lost else INTERRUPTED


def save_figure(figure: Figure, folder: Path, name: str) -> list[Path]:
    """Write a figure into a folder of work as PNG and SVG, following no link there.

    Parameters
    ----------
    figure : matplotlib.figure.Figure
        The figure.
    folder : Path
        The folder.
    name : str
        The files' name without its ending.

    Returns
    -------
    list of Path
        The files.
    """
    from flexor import plot
    from flexor.store import replaced

    files = [folder / f"{name}{ending}" for ending in (".png", ".svg")]
    for file in files:
        with replaced(file) as draft:
            plot.save(figure, draft)
    return files
