"""Study folders, and messages on interruption, shared by several commands."""

from __future__ import annotations

import re
import shlex
from pathlib import Path
from typing import TYPE_CHECKING

import typer

from flexor.cli.console import err, print_error
from flexor.errors import ClusterError, InputError

if TYPE_CHECKING:
    from matplotlib.figure import Figure

STUDIES = Path("studies")
INTERRUPTED, LOST = 130, 3  # exit codes


def new_folder(*words: str) -> Path:
    """Return an unused folder name in `studies/`.

    Parameters
    ----------
    *words : str
        Parts of the name, such as model, parameter set and objective.
    """
    name = re.sub(r"[^\w.+-]", "-", "-".join(words))
    names = [name, *(f"{name}-{count}" for count in range(2, 10_000))]
    return STUDIES / next(n for n in names if not (STUDIES / n).exists())


def reject_fixed_options(context: typer.Context, resume: Path, *free: str) -> None:
    """Reject options that are fixed by the study being resumed.

    Parameters
    ----------
    context : typer.Context
        Context of the command.
    resume : Path
        The folder.
    *free : str
        Parameters of the command that may be given.

    Raises
    ------
    InputError
        If any other parameter is given on the command line.
    """
    given = []
    for parameter in context.command.params:
        source = context.get_parameter_source(parameter.name or "")
        if parameter.name not in (*free, "resume") and source and source.name == "COMMANDLINE":
            given.append(max(parameter.opts, key=len))
    if given:
        raise InputError(
            f'{" and ".join(given)} cannot be changed: "{resume}" is resumed as it was begun.'
        )


def interrupted(place: Path | None, command: str, error: BaseException) -> int:
    """Report that a study was interrupted and how to resume it; return the exit code.

    Parameters
    ----------
    place : Path or None
        The study folder, if any.
    command : str
        The command that resumes it, without the folder.
    error : BaseException
        The cause.
    """
    begun = place is not None and (place / "settings.json").exists()
    resuming = f"{command} {shlex.quote(str(place))}" if begun else None
    return ended_early(error, "design evaluated so far", resuming)


def ended_early(error: BaseException, kept: str, command: str | None) -> int:
    """Report that work ended early and how to resume it; return the exit code.

    Parameters
    ----------
    error : BaseException
        The cause: an interruption, or the loss of a cluster.
    kept : str
        What has been saved.
    command : str or None
        The command that resumes the work; None if there is nothing to resume.
    """
    lost = isinstance(error, ClusterError)
    if command is None:
        print_error(str(error) if lost else "interrupted before anything was computed.")
        return LOST if lost else INTERRUPTED
    if lost:
        print_error(str(error))
    message = f"every {kept} is saved. To resume:\n  {command}"
    err.print(
        message[0].upper() + message[1:] if lost else f"interrupted; {message}",
        markup=False,
        soft_wrap=True,
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
