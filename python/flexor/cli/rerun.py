"""`flexor rerun`: a study again from its folder, compared to the last bit."""

from __future__ import annotations

import json
import math
import time
from pathlib import Path as FilePath
from typing import TYPE_CHECKING, Annotated, Any

import typer

from flexor.cli.console import err, out
from flexor.cli.evaluation import executor_for
from flexor.cli.options import Cluster, Threads
from flexor.cli.progress import SearchProgress, duration
from flexor.cli.table import show

if TYPE_CHECKING:
    from flexor.study import Difference, Rerun


def rerun(
    study: Annotated[FilePath, typer.Argument(metavar="STUDY", help="A study folder.")],
    folder: Annotated[
        FilePath | None,
        typer.Option("--out", help="Keep the new study in this folder; not kept by default."),
    ] = None,
    threads: Threads = 0,
    cluster: Cluster = None,
    as_json: Annotated[
        bool, typer.Option("--json", help="Print one JSON object instead of sentences.")
    ] = False,
) -> int:
    """Run a study again from its folder, and say whether every bit is the same.

    A study folder holds all that decides its numbers: the model with its constants, the parameter
    set with its bounds, objective, forces, method with its options, start, seed, solver options and
    budget; and with what it was made: versions of Flexor, Python and the packages that compute, the
    hash of the compiled engine, the system. This command does it all again without touching the
    folder and compares designs, outcomes and derivatives in their order. A study that was
    interrupted, or ended by time, is compared as far as it went.

    On the same machine with the same versions the answer is yes, with any number of threads; with
    `--cluster` it tells whether other machines give the same bits. The exit code is then 0.
    Otherwise it is 1: the first difference is shown, how far apart the values of the designs are
    that both studies have, and which versions have changed.

    For example:

    * `flexor optimize finger -p R01 --out studies/r01` and then `flexor rerun studies/r01`
    * `flexor rerun studies/r01 --out studies/r01-again`, to look at what has changed
    * `flexor rerun studies/r01 --json`
    """
    from flexor import study as studies

    began = time.monotonic()
    try:
        with executor_for(threads, cluster) as executor, SearchProgress() as progress:
            found = studies.rerun(study, into=folder, progress=progress, executor=executor)
    except KeyboardInterrupt:
        err.print(f"interrupted; {study} is as it was.", markup=False, soft_wrap=True)
        return 130
    seconds = time.monotonic() - began
    if as_json:
        print(json.dumps(_as_json(found, seconds), allow_nan=False))
    else:
        _tell(found, seconds)
    return 0 if found.same else 1


def _tell(found: Rerun, seconds: float) -> None:
    count = f"{found.evaluations:,} designs"
    if found.difference is None:
        _say(f"The same to the last bit: {count} again in {duration(seconds)}.")
    else:
        _say(_first(found.difference))
        _say(f"{_apart(found)} ({count} recorded, again in {duration(seconds)}).")
    if found.changed:
        rows = [(each.what, each.then or "not recorded", each.now) for each in found.changed]
        show(("changed", "then", "now"), rows, left=3)
    elif not found.same:
        _say("Versions and system are those of the study: the processor or its files differ.")


def _first(difference: Difference) -> str:
    where = f"Evaluation {difference.evaluation:,}" if difference.evaluation else "The study"
    return (
        f"{where} differs first: {difference.what} was {_short(difference.then)}, "
        f"is now {_short(difference.now)}."
    )


def _apart(found: Rerun) -> str:
    if not found.common:
        return "No design was evaluated by both studies"
    many = f"The values of the {found.common:,} designs that both evaluated"
    if found.deviation == 0.0:
        return f"{many} are the same"
    if math.isinf(found.deviation):
        return f"{many} differ: one failed in one study only"
    return f"{many} differ by at most {found.deviation:.1e}"


def _short(text: str) -> str:
    return text if len(text) <= 120 else f"{text[:117]}..."


def _say(sentence: str) -> None:
    out.print(sentence, markup=False, soft_wrap=True)


def _as_json(found: Rerun, seconds: float) -> dict[str, Any]:
    """Return the verdict, the first difference, and what has changed."""
    from dataclasses import asdict

    return {
        "same": found.same,
        "evaluations": found.evaluations,
        "difference": None if found.difference is None else asdict(found.difference),
        "common": found.common,
        "deviation": found.deviation if math.isfinite(found.deviation) else None,
        "changed": [asdict(each) for each in found.changed],
        "seconds": seconds,
        "folder": None if found.study.folder is None else str(found.study.folder),
    }
