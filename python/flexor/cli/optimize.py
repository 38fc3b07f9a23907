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
    JudgedForce,
    ModelUnlessResumed,
    Parameters,
    Seed,
    Set,
    StudyFolder,
    Threads,
)
from flexor.cli.studies import free_folder, interrupted, refuse_settled
from flexor.errors import ClusterError, InputError

if TYPE_CHECKING:
    from flexor.study import Study


def optimize(
    context: typer.Context,
    model: ModelUnlessResumed = None,
    parameters: Parameters = "L+R01",
    objective: Annotated[
        str, typer.Option("--objective", "-o", help="What is wanted (see `flexor sets`).")
    ] = "bending",
    method: Annotated[
        str, typer.Option(help="How to search (see `flexor methods`).")
    ] = "pattern-search",
    options: Annotated[
        list[str] | None,
        typer.Option(
            "--option", metavar="KEY=VALUE", help="An option of the method, such as `starts=8`."
        ),
    ] = None,
    start: Annotated[
        list[str] | None,
        typer.Option(
            help="Where to begin: `random`, values in the set's order such as `10 cm, 0.7 cm, "
            "0.8 cm`, or `R_0=0.7 cm`; may be repeated. The model's own exosuit by default."
        ),
    ] = None,
    force: JudgedForce = None,
    seed: Seed = 0,
    budget: Annotated[int | None, typer.Option(help="Evaluate at most so many designs.")] = None,
    folder: StudyFolder = None,
    resume: Annotated[
        FilePath | None, typer.Option(help="Resume the study in this folder.")
    ] = None,
    threads: Threads = 0,
    cluster: Cluster = None,
    constants: Constants = None,
    changes: Set = None,
    plot: Annotated[
        FilePath | None, typer.Option(help="Draw both designs into this PNG, SVG or PDF as well.")
    ] = None,
    show: Annotated[
        bool, typer.Option("--open", help="Open the figure at the end, where there is a desktop.")
    ] = False,
    as_json: Annotated[
        bool, typer.Option("--json", help="Print one JSON object instead of table and figure.")
    ] = False,
) -> int:
    """Optimise a design for an objective.

    Every design that is evaluated is kept in the study folder at once, so a study can be
    interrupted (Ctrl-C) at any moment and resumed; resumed studies end as if never interrupted.

    For example:

    * `flexor optimize finger --parameters L+R01 --objective bending`
    * `flexor optimize finger -p RLP --option starts=8 --budget 5000`
    * `flexor optimize finger -p R01 -o tip-force --start "0.6 cm, 0.8 cm" --out studies/press`
    * `flexor optimize --resume studies/press`

    In the JSON object parameters are in SI units and angles in rad.
    """
    from flexor import study as studies
    from flexor.cli import outcome
    from flexor.cli.progress import SearchProgress

    if plot is not None:
        from flexor.plot import writable

        writable(plot)
    if model is None and resume is None:
        raise InputError("give a MODEL to optimise, or --resume FOLDER to go on with a study.")
    if resume is not None and folder is not None:
        raise InputError("--out makes a new study and --resume goes on with one: give one of them.")
    if resume is not None and model is None:
        refuse_settled(context, resume, "budget", "threads", "cluster", "plot", "show", "as_json")
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
                    or free_folder(loaded.name, settings["parameters"].name, objective)
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
                    **settings,
                )
    except (KeyboardInterrupt, ClusterError) as error:
        return interrupted(place, "flexor optimize --resume", error)
    seconds = time.monotonic() - began
    if as_json:
        print(json.dumps(outcome.as_json(study, seconds), allow_nan=False))
    else:
        outcome.tell(study, seconds, resumed=resume is not None)
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
    from flexor.cli.start import starts
    from flexor.cli.values import numbers
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
