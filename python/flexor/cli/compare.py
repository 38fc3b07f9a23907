"""`flexor compare`: benchmark search methods with equal starts, seeds and budget."""

from __future__ import annotations

import math
from dataclasses import asdict
from functools import partial
from pathlib import Path as FilePath
from typing import TYPE_CHECKING, Annotated, Any

import typer

from flexor.cli import options
from flexor.cli.console import print_json, say
from flexor.cli.design_problem import stated
from flexor.cli.folders import carry_out, check_resumable, cluster_at, new_folder, save_figure
from flexor.cli.progress import ComparisonBar, duration, working
from flexor.cli.table import number, show
from flexor.cli.values import load_changed, numbers, one_or_assignments

if TYPE_CHECKING:
    from flexor.study.comparison import MethodComparison


def compare(
    context: typer.Context,
    model: options.OptionalModel = None,
    parameters: Annotated[
        str | None,
        typer.Option(
            "--parameters",
            "-p",
            help="Parameter sets, such as `L,R01,L+R01`; by default the built-in ones, alone and "
            "with `L`.",
        ),
    ] = None,
    objective: options.Objective = "bending",
    vary: options.Vary = None,
    maximise: options.Maximise = None,
    minimise: options.Minimise = None,
    subject_to: options.SubjectTo = None,
    without: options.Without = None,
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
        int,
        typer.Option(
            callback=options.at_least(1),
            help="Number of searches per method and set, each with its own seed.",
        ),
    ] = 10,
    budget: Annotated[
        int,
        typer.Option(callback=options.at_least(1), help="Maximum number of designs per search."),
    ] = 500,
    force: options.Load = None,
    folder: options.Folder = None,
    resume: options.Resume = None,
    workers: Annotated[
        int,
        typer.Option(
            callback=options.at_least(0),
            help="Concurrent searches; 0 for one per core, or per thread of the cluster.",
        ),
    ] = 0,
    cluster: options.Cluster = None,
    variant: options.Variant = None,
    changes: options.Set = None,
    solver: options.Solver = None,
    plot: options.Plot = None,
    as_json: options.Json = False,
) -> int:
    """Compare search methods with the same starts, seeds and budget on each parameter set.

    With --vary, or variables in the model file, they are compared on these. Designs that keep the
    constraints come before all others; "infeasible by" is what the others exceed them by in all.

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
    * `flexor compare pneumatic-finger -m auto,cma-es,de --seeds 5 --budget 1000`
    * `flexor compare --resume studies/finger-bending-comparison`
    """
    from flexor.study import comparison

    free = ("workers", "cluster", "plot", "as_json")
    check_resumable(context, "comparison", model, folder, resume, *free)
    if resume is not None:
        place, work = resume, partial(comparison.resume_comparison, resume, workers=workers)
    else:
        assert model is not None
        loaded = load_changed(model, variant, changes)
        problem = stated(context, loaded, objective, vary, maximise, minimise, subject_to, without)
        sets = comparison.BUILT_IN_SETS if parameters is None else parameters
        place = folder or new_folder(loaded.name, problem.aim.replace(" ", "-"), "comparison")
        work = partial(
            comparison.compare,
            loaded,
            sets if problem.varied is None else [problem.varied],
            problem.aim,
            subject_to=problem.subject_to,
            without=problem.without,
            methods=methods,
            seeds=seeds,
            budget=budget,
            force=one_or_assignments("--load", force, "chamber=0:5:1"),
            folder=place,
            workers=workers,
            engine_options=numbers("--solver", solver or []),
        )

    def report(result: MethodComparison, seconds: float) -> int:
        files = _keep(result, place, plot)
        if as_json:
            print_json(_as_json(result, seconds, place, files))
        else:
            _print_summary(result, seconds, files)
        return 0

    where = cluster_at(cluster)
    return carry_out("flexor compare --resume", place, where, ComparisonBar(), work, report)


def _print_summary(result: MethodComparison, seconds: float, files: list[FilePath]) -> None:
    from flexor.constraints import INFEASIBLE

    headings = ("best", "median", "success", "to 1 %", "expected", "time")
    for name in result.sets:
        summaries = [result.summary(name, method) for method in result.methods]
        rows = [
            (
                each.method,
                _value(result, each.best),
                _value(result, each.median),
                f"{100.0 * each.success:.0f} %",
                _count(each.evaluations),
                _count(each.expected_evaluations),
                "" if math.isnan(each.seconds) else f"{number(each.seconds, 2)} s",
            )
            for each in sorted(summaries, key=lambda each: (each.expected_evaluations, each.median))
        ]
        first, best = result.reference[name], result.best_known(name)
        say(
            f"{name}: {_quantity(result)} {_value(result, first)} for the model's own exosuit, "
            f"{_value(result, best)} for the best known design"
        )
        show((name, *headings), rows)
        if best >= INFEASIBLE:
            say(
                f"NOT FEASIBLE: no search of {name} found a design that keeps the constraints, so "
                'none is a success; "infeasible by" is what these are exceeded by in all, as '
                "shares of the bounds."
            )
    searches = len(result.runs)
    say(
        f"{searches} searches of at most {result.budget} designs, {len(result.seeds)} per method "
        f"and set, in {duration(seconds)}."
    )
    say(
        "success: share of searches within 1 % of the best known improvement; to 1 %: designs they "
        "needed, median; expected: designs with restarts of the others."
    )
    for file in files:
        say(f"file: {file}")


def _quantity(result: MethodComparison) -> str:

    objective = result.objective
    if objective.of_observable:
        return f"{objective.quantity} / {objective.unit}".removesuffix(" / ")
    return f"objective {objective.name}"


def _value(result: MethodComparison, value: float) -> str:
    """Format a value, or by how much an infeasible design exceeds its constraints."""
    import numpy as np

    from flexor.constraints import INFEASIBLE

    if math.isfinite(value) and value >= INFEASIBLE:
        return f"infeasible by {number(value / INFEASIBLE - 1.0, 2)}"
    return number(float(result.objective.displayed(np.array(value))), 5)


def _count(evaluations: float) -> str:
    return f"{evaluations:.0f}" if math.isfinite(evaluations) else "-"


def _keep(result: MethodComparison, place: FilePath, also: FilePath | None) -> list[FilePath]:
    from flexor import plot
    from flexor.store import csv_text, write_text

    summaries = [asdict(each) for each in result.summaries()]
    searches = result.table()
    columns = [column.tolist() for column in searches.values()]
    tables = {
        place / "comparison.csv": [summaries[0], *(each.values() for each in summaries)],
        place / "searches.csv": [searches, *zip(*columns, strict=True)],
    }
    for file, rows in tables.items():
        write_text(file, csv_text(rows))
    files = list(tables)
    with working("drawing the profiles", at_once=False):
        figure = plot.profiles(result)
        files += save_figure(figure, place, "profiles", also)
    return files


def _as_json(
    result: MethodComparison, seconds: float, place: FilePath, files: list[FilePath]
) -> dict[str, Any]:
    """Return every summary, and for each set the best design (SI) and the target."""
    return {
        "objective": result.objective.name,
        "budget": result.budget,
        "seeds": list(result.seeds),
        "sets": {
            name: {
                "reference": result.reference[name],
                "best": result.best_known(name),
                "design": result.best(name).result.design.tolist(),
                "method": result.best(name).method,
                "target": result.target(name),
            }
            for name in result.sets
        },
        "summaries": result.summaries(),
        "seconds": seconds,
        "folder": place,
        "files": files,
    }
