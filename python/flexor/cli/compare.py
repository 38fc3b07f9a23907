"""`flexor compare`: every search method from the same starts, seeds and budget."""

from __future__ import annotations

import csv
import io
import json
import math
import time
from pathlib import Path as FilePath
from typing import TYPE_CHECKING, Annotated, Any

import typer

from flexor.cli.changes import load_changed
from flexor.cli.comparison_progress import ComparisonBar
from flexor.cli.console import err, out
from flexor.cli.evaluation import executor_if
from flexor.cli.options import Cluster, Constants, JudgedForce, ModelUnlessResumed, Set
from flexor.cli.progress import duration
from flexor.cli.studies import free_folder, interrupted, refuse_settled, save_figure
from flexor.cli.table import number, show
from flexor.errors import ClusterError, InputError

if TYPE_CHECKING:
    from flexor.study.comparison import MethodComparison, Summary


def compare(
    context: typer.Context,
    model: ModelUnlessResumed = None,
    parameters: Annotated[
        str | None,
        typer.Option(
            "--parameters", "-p", help="Sets, such as `L,R01,L+R01`; the paper's seven by default."
        ),
    ] = None,
    objective: Annotated[
        str, typer.Option("--objective", "-o", help="What is wanted (see `flexor sets`).")
    ] = "bending",
    methods: Annotated[
        str | None,
        typer.Option(
            "--methods",
            "-m",
            help="Methods, such as `pattern-search,cma-es` (see `flexor methods`); by default "
            "all that are installed, without grid and surrogate.",
        ),
    ] = None,
    seeds: Annotated[int, typer.Option(help="So many searches of each, each from its start.")] = 10,
    budget: Annotated[int, typer.Option(help="Designs that each search may evaluate.")] = 500,
    force: JudgedForce = None,
    folder: Annotated[
        FilePath | None,
        typer.Option("--out", help="The folder to make; one in `studies/` by default."),
    ] = None,
    resume: Annotated[
        FilePath | None, typer.Option(help="Resume the comparison in this folder.")
    ] = None,
    workers: Annotated[
        int,
        typer.Option(min=0, help="Searches at a time; 0 for one per core, or thread of a cluster."),
    ] = 0,
    cluster: Cluster = None,
    constants: Constants = None,
    changes: Set = None,
    plot: Annotated[
        FilePath | None, typer.Option(help="Draw the profiles into this PNG, SVG or PDF as well.")
    ] = None,
    as_json: Annotated[
        bool, typer.Option("--json", help="Print one JSON object instead of the table.")
    ] = False,
) -> int:
    """Compare search methods: every one from the same starts, seeds and budget on each set.

    A search counts as a success once it has 99 % of the gain of the best design known of its set,
    gains being measured from the model's own exosuit. The table says what each method's searches
    ended at, how many succeeded, and how many evaluations that took: in the median of those that
    did (`to 1 %`), and to be expected if a search that ends without is begun anew (`expected`).

    Finished searches are kept in the folder and running ones recorded, so a comparison can be
    interrupted (Ctrl-C) and resumed. At the end the folder has `comparison.csv`, `searches.csv`
    and the performance and data profiles (`profiles.png`, `profiles.svg`).

    For example:

    * `flexor compare finger`
    * `flexor compare finger -p R01,L+R01 -m pattern-search,cma-es --seeds 20 --budget 1000`
    * `flexor compare --resume studies/finger-bending-comparison`
    """
    from flexor.study import comparison

    if plot is not None:
        from flexor.plot import writable

        writable(plot)
    if model is None and resume is None:
        raise InputError("give a MODEL, or --resume FOLDER to go on with a comparison.")
    if resume is not None and (folder is not None or model is not None):
        raise InputError("--resume needs only the folder: give no MODEL and no --out with it.")
    if resume is not None:
        refuse_settled(context, resume, "workers", "cluster", "plot", "as_json")
    began, place = time.monotonic(), resume
    try:
        with executor_if(cluster) as executor, ComparisonBar() as progress:
            if resume is not None:
                found = comparison.resume_comparison(
                    resume, progress=progress, executor=executor, workers=workers
                )
            else:
                assert model is not None
                from flexor.model import forces

                loaded = load_changed(model, constants, changes or [])
                place = folder or free_folder(loaded.name, objective, "comparison")
                found = comparison.compare(
                    loaded,
                    comparison.PAPER_SETS if parameters is None else parameters,
                    objective,
                    methods=methods,
                    seeds=seeds,
                    budget=budget,
                    force=None if force is None else forces(force),
                    folder=place,
                    progress=progress,
                    executor=executor,
                    workers=workers,
                )
    except (KeyboardInterrupt, ClusterError) as error:
        return interrupted(place, "flexor compare --resume", error)
    assert place is not None
    files = _keep(found, place, plot)
    seconds = time.monotonic() - began
    if as_json:
        print(json.dumps(_as_json(found, seconds, place, files), allow_nan=False))
    else:
        _tell(found, seconds, files)
    return 0


def _tell(found: MethodComparison, seconds: float, files: list[FilePath]) -> None:
    headings = ("", "best", "median", "success", "to 1 %", "expected", "time")
    for name in found.sets:
        summaries = [found.summary(name, method) for method in found.methods]
        rows = [
            (
                each.method,
                number(each.best, 5),
                number(each.median, 5),
                f"{100.0 * each.success:.0f} %",
                _count(each.evaluations),
                _count(each.expected_evaluations),
                "" if math.isnan(each.seconds) else f"{number(each.seconds, 2)} s",
            )
            for each in sorted(summaries, key=_rank)
        ]
        first, best = found.reference[name], found.best_known(name)
        out.print(
            f"{name}: objective {found.objective.name} {number(first, 5)} for the model's own "
            f"exosuit, {number(best, 5)} for the best design known",
            markup=False,
            soft_wrap=True,
        )
        show((name, *headings[1:]), rows)
    searches = len(found.runs)
    out.print(
        f"{searches} searches of at most {found.budget} designs each, {len(found.seeds)} for each "
        f"method and set, in {duration(seconds)}.",
        markup=False,
        soft_wrap=True,
    )
    for file in files:
        out.print(f"file: {file}", markup=False, soft_wrap=True)


def _rank(each: Summary) -> tuple[float, float]:
    return (each.expected_evaluations, each.median)


def _count(evaluations: float) -> str:
    return f"{evaluations:.0f}" if math.isfinite(evaluations) else "-"


def _keep(found: MethodComparison, place: FilePath, also: FilePath | None) -> list[FilePath]:
    from dataclasses import asdict

    from flexor import plot
    from flexor.store import write_text

    summaries = [asdict(each) for each in found.summaries()]
    searches = found.table()
    rows = [
        dict(zip(searches, row, strict=True))
        for row in zip(*(column.tolist() for column in searches.values()), strict=True)
    ]
    files = [place / "comparison.csv", place / "searches.csv"]
    for file, lines in zip(files, (summaries, rows), strict=True):
        target = io.StringIO()
        writer = csv.DictWriter(target, list(lines[0]), lineterminator="\n")
        writer.writeheader()
        writer.writerows(lines)
        write_text(file, target.getvalue())
    with err.status("drawing the profiles"):
        figure = plot.profiles(found)
        files += save_figure(figure, place, "profiles")
        if also is not None:
            files.append(plot.save(figure, also))
    return files


def _as_json(
    found: MethodComparison, seconds: float, place: FilePath, files: list[FilePath]
) -> dict[str, Any]:
    """Return every summary, and for each set the best design (SI) and the target."""
    from dataclasses import asdict

    def plain(value: Any) -> Any:
        return None if isinstance(value, float) and not math.isfinite(value) else value

    return {
        "objective": found.objective.name,
        "budget": found.budget,
        "seeds": list(found.seeds),
        "sets": {
            name: {
                "reference": plain(found.reference[name]),
                "best": plain(found.best_known(name)),
                "design": found.best(name).result.design.tolist(),
                "method": found.best(name).method,
                "target": plain(found.target(name)),
            }
            for name in found.sets
        },
        "summaries": [
            {key: plain(value) for key, value in asdict(each).items()} for each in found.summaries()
        ],
        "seconds": seconds,
        "folder": str(place),
        "files": [str(file) for file in files],
    }
