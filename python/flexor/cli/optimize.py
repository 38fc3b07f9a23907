"""`flexor optimize`: optimise a design for an objective."""

from __future__ import annotations

import json
import time
from pathlib import Path as FilePath
from typing import TYPE_CHECKING, Annotated, Any

import typer

from flexor.cli.changes import load_changed
from flexor.cli.evaluation import executor_for
from flexor.cli.options import (
    Cluster,
    Constants,
    EvaluationForce,
    OptionalModel,
    Parameters,
    Seed,
    Set,
    Solver,
    StudyFolder,
    Threads,
)
from flexor.cli.studies import interrupted, new_folder, reject_fixed_options
from flexor.cli.values import numbers
from flexor.errors import ClusterError, InputError

if TYPE_CHECKING:
    from flexor.study import Study


def optimize(
    context: typer.Context,
    model: OptionalModel = None,
    parameters: Parameters = "L+R01",
    objective: Annotated[
        str, typer.Option("--objective", "-o", help="Objective (see `flexor sets`).")
    ] = "bending",
    method: Annotated[
        str, typer.Option(help="Search method (see `flexor methods`).")
    ] = "pattern-search",
    options: Annotated[
        list[str] | None,
        typer.Option(
            "--option",
            metavar="KEY=VALUE",
            help="Option of the method, such as `starts=8`; may be repeated.",
        ),
    ] = None,
    start: Annotated[
        list[str] | None,
        typer.Option(
            help="Starting design: `random`, values in the order of the set such as `10 cm, "
            "0.7 cm, 0.8 cm`, or `R_0=0.7 cm`; may be repeated. By default the model's exosuit."
        ),
    ] = None,
    force: EvaluationForce = None,
    seed: Seed = 0,
    budget: Annotated[
        int | None, typer.Option(help="Maximum number of designs to evaluate.")
    ] = None,
    folder: StudyFolder = None,
    resume: Annotated[
        FilePath | None, typer.Option(help="Resume the study in this folder.")
    ] = None,
    threads: Threads = 0,
    cluster: Cluster = None,
    constants: Constants = None,
    changes: Set = None,
    solver: Solver = None,
    plot: Annotated[
        FilePath | None, typer.Option(help="Also save the figure to this PNG, SVG or PDF file.")
    ] = None,
    show: Annotated[
        bool, typer.Option("--open", help="Open the figure when done, if there is a display.")
    ] = False,
    as_json: Annotated[
        bool, typer.Option("--json", help="Print a JSON object instead of the table and figure.")
    ] = False,
) -> int:
    """Optimise a design for an objective.

    Every evaluated design is recorded immediately in the study folder, so a study can be
    interrupted (Ctrl-C) at any time and resumed with the same final result.

    Examples
    --------
    * `flexor optimize finger --parameters L+R01 --objective bending`
    * `flexor optimize finger -p RLP --option starts=8 --budget 5000`
    * `flexor optimize finger -p R01 -o tip-force --start "0.6 cm, 0.8 cm" --out studies/press`
    * `flexor optimize --resume studies/press`

    The JSON object uses SI units, with angles in rad.
    """
    from flexor import study as studies
    from flexor.cli import outcome
    from flexor.cli.progress import SearchProgress

    if plot is not None:
        from flexor.plot import writable

        writable(plot)
    if model is None and resume is None:
        raise InputError("give a MODEL to optimise, or --resume FOLDER to resume a study.")
    if resume is not None and folder is not None:
        raise InputError("--out and --resume exclude each other: give one of them.")
    if resume is not None and model is None:
        reject_fixed_options(
            context, resume, "budget", "threads", "cluster", "plot", "show", "as_json"
        )
    began = time.monotonic()
    place = resume
    try:
        with executor_for(threads, cluster) as executor, SearchProgress() as progress:
            if model is None:
                assert resume is not None
                study = studies.resume(resume, budget=budget, progress=progress, executor=executor)
            else:
                loaded = load_changed(model, constants, changes or [])
                settings = _settings(loaded, parameters, method, options or [], start or [], force)
                place = (
                    resume
                    or folder
                    or new_folder(loaded.name, settings["parameters"].name, objective)
                )
                study = studies.optimize(
                    loaded,
                    objective=objective,
                    seed=seed,
                    budget=budget,
                    folder=place,
                    resume=resume is not None,
                    progress=progress,
                    executor=executor,
                    engine_options=numbers("--solver", solver or []),
                    **settings,
                )
    except (KeyboardInterrupt, ClusterError) as error:
        return interrupted(place, "flexor optimize --resume", error)
    seconds = time.monotonic() - began
    if as_json:
        print(json.dumps(outcome.as_json(study, seconds), allow_nan=False))
    else:
        outcome.print_summary(study, seconds, resumed=resume is not None)
    if plot is not None or not as_json:
        outcome.draw(study, plot, quiet=as_json)
    if show:
        _open(study)
    return 0


def _settings(
    model: Any,
    parameters: str,
    method: str,
    options: list[str],
    start: list[str],
    force: str | None,
) -> dict[str, Any]:
    from flexor import design, optimizers
    from flexor.design.start import starts
    from flexor.model import forces

    chosen = design.parameter_set(parameters, model.design)
    return {
        "parameters": chosen,
        "method": optimizers.method(method, **numbers("--option", options)),
        "start": starts(start, chosen),
        "force": None if force is None else forces(force),
    }


def _open(study: Study) -> None:
    import os
    import sys

    desktop = sys.platform in ("win32", "darwin") or any(
        os.environ.get(name) for name in ("DISPLAY", "WAYLAND_DISPLAY")
    )
    if desktop and sys.stdout.isatty() and study.folder is not None:
        typer.launch(str((study.folder / "designs.png").resolve()))
