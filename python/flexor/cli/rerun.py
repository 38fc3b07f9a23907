"""`flexor rerun`: repeat a study from its folder and compare bitwise."""

from __future__ import annotations

import math
import time
from pathlib import Path as FilePath
from typing import TYPE_CHECKING, Annotated, Any

import typer

from flexor.cli import options
from flexor.cli.console import note, print_json, say
from flexor.cli.folders import INTERRUPTED, executor_for, study_folder
from flexor.cli.progress import SearchProgress, duration
from flexor.cli.table import show

if TYPE_CHECKING:
    from flexor.study import Difference, Rerun


def rerun(
    study: Annotated[FilePath, typer.Argument(metavar="STUDY", help="Study folder.")],
    folder: Annotated[
        FilePath | None,
        typer.Option("--out", help="Save the new study to this folder; by default discarded."),
    ] = None,
    which: options.OneOf = None,
    threads: options.Threads = 0,
    cluster: options.Cluster = None,
    as_json: options.Json = False,
) -> int:
    """Repeat a study from its folder and check that the results are bit-identical.

    A study folder contains everything that determines its results (model and variant, parameter
    set and bounds, objective, forces, method and options, start, seed, solver options, budget)
    and its provenance (versions of Flexor, Python and numerical packages, hash of the compiled
    engine, system). This command repeats the study without modifying the folder and compares
    designs, results and derivatives in order. A study that was interrupted, or stopped by a time
    limit, is compared up to that point.

    On the same machine with the same versions the results are identical for any number of threads,
    and the exit code is 0; with `--cluster` the command checks other machines. Otherwise the exit
    code is 1, and the first difference, the largest deviation between the values of common designs
    and the changed versions are printed.

    Examples
    --------
    * `flexor optimize finger -p R01 --out studies/r01`, then `flexor rerun studies/r01`
    * `flexor rerun studies/r01 --out studies/r01-again`, to inspect the differences
    * `flexor rerun studies/r01 --json`
    """
    from flexor import study as studies

    study, began = study_folder(study, which), time.monotonic()
    try:
        with executor_for(threads, cluster) as executor, SearchProgress() as progress:
            result = studies.rerun(study, into=folder, progress=progress, executor=executor)
    except KeyboardInterrupt:
        note(f"interrupted; {study} is unchanged.")
        return INTERRUPTED
    seconds = time.monotonic() - began
    if as_json:
        print_json(_as_json(result, seconds))
    else:
        _print_summary(result, seconds)
    return 0 if result.same else 1


def _print_summary(result: Rerun, seconds: float) -> None:
    count = f"{result.evaluations:,} designs"
    if result.difference is None:
        say(f"Bit-identical: {count} re-evaluated in {duration(seconds)}.")
    else:
        say(_first_difference(result.difference))
        say(f"{_deviation(result)} ({count} recorded, repeated in {duration(seconds)}).")
    if result.changed:
        rows = [(each.what, each.then or "not recorded", each.now) for each in result.changed]
        show(("changed", "then", "now"), rows, left=3)
    elif not result.same:
        say("Versions and system are unchanged: the processor or the study's files differ.")


def _first_difference(difference: Difference) -> str:
    where = f"evaluation {difference.evaluation:,}" if difference.evaluation else "the study"
    return (
        f"First difference: {where}, where {difference.what} was {_truncated(difference.then)} "
        f"and is now {_truncated(difference.now)}."
    )


def _deviation(result: Rerun) -> str:
    if not result.common:
        return "The studies have no common designs"
    values = f"The values of the {result.common:,} common designs"
    if result.deviation == 0.0:
        return f"{values} are identical"
    if math.isinf(result.deviation):
        return f"{values} differ: one failed in one study only"
    return f"{values} differ by at most {result.deviation:.1e}"


def _truncated(text: str) -> str:
    return text if len(text) <= 120 else f"{text[:117]}..."


def _as_json(result: Rerun, seconds: float) -> dict[str, Any]:
    """Return the result, the first difference, and the changed versions."""
    return {
        "same": result.same,
        "evaluations": result.evaluations,
        "difference": result.difference,
        "common": result.common,
        "deviation": result.deviation,
        "changed": result.changed,
        "seconds": seconds,
        "folder": result.study.folder,
    }
