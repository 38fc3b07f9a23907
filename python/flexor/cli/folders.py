"""What commands that work in a folder share: options, executors, interruption and figures."""

from __future__ import annotations

import logging
import re
import shlex
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

import typer

from flexor.cli.console import err, note, print_error
from flexor.errors import ClusterError, InputError

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from flexor.study import Executor

STUDIES = Path("studies")
INTERRUPTED, LOST = 130, 3  # exit codes


def new_folder(*words: str, parent: Path = STUDIES) -> Path:
    """Return an unused folder name, made of words such as model, parameter set and objective."""
    name = re.sub(r"[^\w.+-]", "-", "-".join(words))
    names = [name, *(f"{name}-{count}" for count in range(2, 10_000))]
    return parent / next(n for n in names if not (parent / n).exists())


def check_resumable(
    context: typer.Context,
    kind: str,
    model: str | None,
    folder: Path | None,
    resume: Path | None,
    *free: str,
) -> None:
    """Require a model, or a folder to resume and no options but those that may differ."""
    if model is None and resume is None:
        raise InputError(f"give a MODEL, or --resume FOLDER to resume a {kind}.")
    if resume is not None and (folder is not None or model is not None):
        raise InputError("--resume takes only the folder: omit MODEL and --out.")
    if resume is None:
        return
    given = []
    for parameter in context.command.params:
        source = context.get_parameter_source(parameter.name or "")
        if parameter.name not in (*free, "resume") and source and source.name == "COMMANDLINE":
            given.append(max(parameter.opts, key=len))
    if given:
        raise InputError(
            f'{" and ".join(given)} cannot be changed: "{resume}" is resumed as it was begun.'
        )


@contextmanager
def executor_for(threads: int, cluster: str | None) -> Iterator[Executor]:
    """Provide the executor selected by `--threads` and `--cluster`."""
    from flexor.study import Threads

    if threads and cluster is not None:
        raise InputError("--threads and --cluster exclude each other: give one of them.")
    with cluster_at(cluster) as found:
        yield Threads(threads) if found is None else found


@contextmanager
def cluster_at(address: str | None) -> Iterator[Executor | None]:
    """Connect to the cluster at an address, if one is given."""
    if address is None:
        yield None
        return
    from flexor.study import Cluster

    with err.status(f"connecting to {address}"):
        executor = Cluster(address)
    # Errors are reported as exceptions.
    for name in logging.getLogger().manager.loggerDict:
        if name.split(".")[0] in ("distributed", "tornado"):
            logging.getLogger(name).setLevel(logging.CRITICAL + 1)
    with executor:
        yield executor


def interrupted(place: Path | None, command: str, error: BaseException) -> int:
    """Report an interruption or the loss of a cluster, and how to resume; return the exit code."""
    lost = isinstance(error, ClusterError)
    if place is None or not (place / "settings.json").exists():
        print_error(str(error) if lost else "interrupted before anything was computed.")
    else:
        if lost:
            print_error(str(error))
        begin = "Every" if lost else "interrupted; every"
        again = f"{command} {shlex.quote(str(place))}"
        note(f"{begin} design evaluated so far is saved. To resume:\n  {again}")
    return LOST if lost else INTERRUPTED


def save_figure(figure: Figure, folder: Path, name: str, also: Path | None = None) -> list[Path]:
    """Write a figure into a folder as PNG and SVG, and to another file; return the files."""
    from flexor import plot

    files = [folder / f"{name}.png", folder / f"{name}.svg", *([] if also is None else [also])]
    return [plot.save(figure, file) for file in files]
