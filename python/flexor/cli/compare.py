"""`flexor compare`: benchmark search methods with equal starts, seeds and budget."""

from __future__ import annotations

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
from flexor.cli.options import Cluster, Constants, EvaluationForce, OptionalModel, Set, Solver
from flexor.cli.progress import duration
from flexor.cli.studies import interrupted, new_folder, reject_fixed_options, save_figure
from flexor.cli.table import number, show
from flexor.cli.values import numbers
from flexor.errors import ClusterError, InputError

if TYPE_CHECKING:
    from flexor.study.comparison import MethodComparison, Summary


def compare(
    context: typer.Context,
    model: OptionalModel = None,
    parameters: Annotated[
        str | None,
        typer.Option(
            "--parameters",
            "-p",
            help="Parameter sets, such as `L,R01,L+R01`; the paper's seven by default.",
        ),
    ] = None,
    objective: Annotated[
        str, typer.Option("--objective", "-o", help="Objective (see `flexor sets`).")
    ] = "bending",
    methods: Annotated[
        str | None,
        typer.Option(
            "--methods",
            "-m",
            help="Methods, such as `pattern-search,cma-es` (see `flexor methods`); by default all "
            "installed methods except grid and surrogate.",
        ),
    ] = None,
    seeds: Annotated[
        int, typer.Option(help="Number of searches per method and set, each with its own seed.")
    ] = 10,
    budget: Annotated[int, typer.Option(help="Maximum number of designs per search.")] = 500,
    force: EvaluationForce = None,
    folder: Annotated[
        FilePath | None,
        typer.Option("--out", help="Output folder; by default a new one in `studies/`."),
    ] = None,
    resume: Annotated[
        FilePath | None, typer.Option(help="Resume the comparison in this folder.")
    ] = None,
    workers: Annotated[
        int,
        typer.Option(
            min=0, help="Concurrent searches; 0 for one per core, or per thread of the cluster."
        ),
    ] = 0,
    cluster: Cluster = None,
    constants: Constants = None,
    changes: Set = None,
    solver: Solver = None,
    plot: Annotated[
        FilePath | None, typer.Option(help="Also save the figure to this PNG, SVG or PDF file.")
    ] = None,
    as_json: Annotated[
        bool, typer.Option("--json", help="Print a JSON object instead of the table.")
    ] = False,
) -> int:
    """Compare search methods with the same starts, seeds and budget on each parameter set.

    A search succeeds when it reaches 99 % of the improvement of the best known design of its set
    over the model's own exosuit. The table lists the best and the median final value of each
    method, its success rate, the median number of evaluations of successful searches (`to 1 %`)
    and the expected number with restarts of unsuccessful ones (`expected`).

    All evaluations are recorded in the folder, so a comparison can be interrupted (Ctrl-C) and
    resumed. The completed folder contains `comparison.csv`, `searches.csv` and the performance and
    data profiles (`profiles.png`, `profiles.svg`).

    Examples
    --------
    * `flexor compare finger`
    * `flexor compare finger -p R01,L+R01 -m pattern-search,cma-es --seeds 20 --budget 1000`
    * `flexor compare --resume studies/finger-bending-comparison`
    """
    from flexor.study import comparison

    if plot is not None:
        from flexor.plot import writable

        writable(plot)
    if model is None and resume is None:
        raise InputError("give a MODEL, or --resume FOLDER to resume a comparison.")
    if resume is not None and (folder is not None or model is not None):
        raise InputError("--resume takes only the folder: omit MODEL and --out.")
    if resume is not None:
        reject_fixed_options(context, resume, "workers", "cluster", "plot", "as_json")
    began, place = time.monotonic(), resume
    try:
        with executor_if(cluster) as executor, ComparisonBar() as progress:
            if resume is not None:
                result = comparison.resume_comparison(
                    resume, progress=progress, executor=executor, workers=workers
                )
            else:
                assert model is not None
                from flexor.model import forces

                loaded = load_changed(model, constants, changes or [])
                place = folder or new_folder(loaded.name, objective, "comparison")
                result = comparison.compare(
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
                    engine_options=numbers("--solver", solver or []),
                )
    except (KeyboardInterrupt, ClusterError) as error:
        return interrupted(place, "flexor compare --resume", error)
    assert place is not None
    files = _keep(result, place, plot)
    seconds = time.monotonic() - began
    if as_json:
        print(json.dumps(_as_json(result, seconds, place, files), allow_nan=False))
    else:
        _print_summary(result, seconds, files)
    return 0


def _print_summary(result: MethodComparison, seconds: float, files: list[FilePath]) -> None:
    headings = ("", "best", "median", "success", "to 1 %", "expected", "time")
    for name in result.sets:
        summaries = [result.summary(name, method) for method in result.methods]
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
        first, best = result.reference[name], result.best_known(name)
        out.print(
            f"{name}: objective {result.objective.name} {number(first, 5)} for the model's own "
            f"exosuit, {number(best, 5)} for the best known design",
            markup=False,
            soft_wrap=True,
        )
        show((name, *headings[1:]), rows)
    searches = len(result.runs)
    out.print(
        f"{searches} searches of at most {result.budget} designs, {len(result.seeds)} per "
        "method and "
        f"set, in {duration(seconds)}.",
        markup=False,
        soft_wrap=True,
    )
    for file in files:
        out.print(f"file: {file}", markup=False, soft_wrap=True)


def _rank(each: Summary) -> tuple[float, float]:
    return (each.expected_evaluations, each.median)


def _count(evaluations: float) -> str:
    return f"{evaluations:.0f}" if math.isfinite(evaluations) else "-"


def _keep(result: MethodComparison, place: FilePath, also: FilePath | None) -> list[FilePath]:
    from dataclasses import asdict

    from flexor import plot
    from flexor.store import csv_text, write_text

    summaries = [asdict(each) for each in result.summaries()]
    searches = result.table()
    rows = [
        dict(zip(searches, row, strict=True))
        for row in zip(*(column.tolist() for column in searches.values()), strict=True)
    ]
    files = [place / "comparison.csv", place / "searches.csv"]
    for file, lines in zip(files, (summaries, rows), strict=True):
        write_text(file, csv_text([list(lines[0]), *(line.values() for line in lines)]))
    with err.status("drawing the profiles"):
        figure = plot.profiles(result)
        files += save_figure(figure, place, "profiles")
        if also is not None:
            files.append(plot.save(figure, also))
    return files


def _as_json(
    result: MethodComparison, seconds: float, place: FilePath, files: list[FilePath]
) -> dict[str, Any]:
    """Return every summary, and for each set the best design (SI) and the target."""
    from dataclasses import asdict

    def plain(value: Any) -> Any:
        return None if isinstance(value, float) and not math.isfinite(value) else value

    return {
        "objective": result.objective.name,
        "budget": result.budget,
        "seeds": list(result.seeds),
        "sets": {
            name: {
                "reference": plain(result.reference[name]),
                "best": plain(result.best_known(name)),
                "design": result.best(name).result.design.tolist(),
                "method": result.best(name).method,
                "target": plain(result.target(name)),
            }
            for name in result.sets
        },
        "summaries": [
            {key: plain(value) for key, value in asdict(each).items()}
            for each in result.summaries()
        ],
        "seconds": seconds,
        "folder": str(place),
        "files": [str(file) for file in files],
    }
