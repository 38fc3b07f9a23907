"""Common parts of commands that work in a folder: options, executors, interruption, figures."""

from __future__ import annotations

import logging
import re
import shlex
import time
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol, runtime_checkable

import typer

from flexor.cli.console import err, note, print_error
from flexor.errors import ClusterError, InputError

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from flexor.cli.progress import LiveLine
    from flexor.study import DesignEvaluator

STUDIES = Path("studies")
INTERRUPTED, LOST = 130, 3  # exit codes


@runtime_checkable
class _Open(Protocol):
    def close(self) -> None: ...


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
            f'{" and ".join(given)} cannot be changed: "{resume}" is resumed with its own settings.'
        )


def study_folder(folder: Path, which: str | None) -> Path:
    """Return a study folder, or of one with several studies the best, or that of `--design`."""
    from flexor.study import has_members, member

    if has_members(folder):
        return member(folder, which)
    if which is not None:
        raise InputError(
            f'--design is for a folder of --choose or --sizes, and "{folder}" is none.'
        )
    return folder


@contextmanager
def executor_for(threads: int, cluster: str | None) -> Iterator[DesignEvaluator]:
    """Provide the executor selected by `--threads` and `--cluster`."""
    from flexor.study import Threads

    if threads and cluster is not None:
        raise InputError("--threads and --cluster exclude each other: give one of them.")
    with cluster_at(cluster) as found:
        yield Threads(threads) if found is None else found


@contextmanager
def cluster_at(address: str | None) -> Iterator[DesignEvaluator | None]:
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


def carry_out(
    resuming: str,
    place: Path,
    executor: AbstractContextManager[Any],
    bar: LiveLine,
    work: Callable[..., object],
    report: Callable[[Any, float], int],
) -> int:
    """Do the work of a command in a folder; return the exit code.

    ``work`` is called with an executor, the progress bar and a function that it calls with its
    result while the folder is locked. That function calls ``report``, which writes the outputs,
    given the result and the time [s], and returns the exit code. ``resuming`` is the command that
    resumes, without the folder.
    """
    began, code = time.monotonic(), 0

    def finish(result: Any) -> None:
        nonlocal code
        bar.stop()
        code = report(result, time.monotonic() - began)

    try:
        with executor as where, bar:
            done = work(executor=where, progress=bar, finish=finish)
            if isinstance(done, _Open):
                done.close()
    except (KeyboardInterrupt, ClusterError) as error:
        return interrupted(place, resuming, error, (place / "settings.json").exists())
    return code


def carry_out_searches(
    executor: AbstractContextManager[Any],
    work: Callable[..., Any],
    report: Callable[[Any, float], None],
    stopped: Callable[[BaseException], int],
) -> int:
    """Do the work of a command that makes several searches; return the exit code.

    ``work`` is called with an executor and the progress, ``report`` with its result, which is then
    closed, and the time [s], ``stopped`` with an interruption or the loss of the cluster.
    """
    from flexor.cli.progress import SearchProgress

    began = time.monotonic()
    try:
        with executor as where, SearchProgress() as progress:
            found = work(executor=where, progress=progress)
    except (KeyboardInterrupt, ClusterError) as error:
        return stopped(error)
    report(found, time.monotonic() - began)
    found.close()
    return 0


def interrupted(place: Path, resuming: str, error: BaseException, begun: bool) -> int:
    """Report an interruption or the loss of a cluster, and how to resume work that has begun.

    Returns the exit code.
    """
    lost = isinstance(error, ClusterError)
    begin = "Everything" if lost else "interrupted; everything"
    if lost:
        print_error(str(error))
    if begun:
        note(
            f"{begin} evaluated so far is saved. To resume:\n  {resuming} {shlex.quote(str(place))}"
        )
    elif not lost:
        print_error("interrupted before anything was computed.")
    return LOST if lost else INTERRUPTED


def save_figure(
    figure: Figure,
    folder: Path,
    name: str,
    also: Path | None = None,
    progress: Callable[[str], None] | None = None,
) -> list[Path]:
    """Write a figure into a folder as PNG and SVG, and to another file; return the files.

    ``progress`` is called with the name of each file before it is written.
    """
    from flexor import plot

    files = [folder / f"{name}.png", folder / f"{name}.svg", *([] if also is None else [also])]
    saved = []
    for file in files:
        if progress is not None:
            progress(file.name)
        saved.append(plot.save(figure, file))
        figure.set_layout_engine(None)  # it is laid out
    return saved
