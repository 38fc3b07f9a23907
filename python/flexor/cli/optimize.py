"""`flexor optimize`: optimise a design for an objective."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Annotated

import typer

from flexor.cli import options
from flexor.cli.console import print_json
from flexor.cli.folders import carry_out, check_resumable, executor_for, new_folder
from flexor.cli.values import assignments, load_changed, numbers, one_or_assignments, ranges
from flexor.errors import InputError

if TYPE_CHECKING:
    from flexor.study import Study


def optimize(
    context: typer.Context,
    model: options.OptionalModel = None,
    parameters: options.Parameters = "L+R01",
    objective: options.Objective = "bending",
    vary: Annotated[
        list[str] | None,
        typer.Option(
            metavar="FIELD=LOW:HIGH",
            help="Vary a numeric field of the model file instead of `--parameters`, such as "
            "`exosuit.length=8 cm:11 cm`; may be repeated.",
        ),
    ] = None,
    maximise: Annotated[
        str | None,
        typer.Option(metavar="NAME", help="Maximise an observable (see `flexor sets`)."),
    ] = None,
    minimise: Annotated[
        str | None, typer.Option(metavar="NAME", help="Minimise an observable.")
    ] = None,
    subject_to: Annotated[
        list[str] | None,
        typer.Option(
            metavar="CONSTRAINT",
            help="Constraint along the whole path, such as `overlap <= 0.5 mm`; may be repeated.",
        ),
    ] = None,
    without: Annotated[
        list[str] | None,
        typer.Option(
            metavar="NAME",
            help="Switch off a default constraint: `overlap`, `strain`, `stress`, `stretch` or "
            "`defaults` for all; may be repeated. They hold with --maximise and --minimise.",
        ),
    ] = None,
    scenarios: options.Scenarios = None,
    aggregate: options.Aggregate = None,
    tolerance: options.Tolerance = None,
    samples: options.Samples = None,
    method: Annotated[
        str | None,
        typer.Option(
            autocompletion=options.method_names,
            help="Search method (see `flexor methods`); by default `auto` with --maximise and "
            "--minimise, otherwise `pattern-search`.",
        ),
    ] = None,
    method_options: Annotated[
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
    force: options.Load = None,
    seed: options.Seed = 0,
    budget: Annotated[
        int | None,
        typer.Option(callback=options.at_least(1), help="Maximum number of designs to evaluate."),
    ] = None,
    folder: options.Folder = None,
    resume: options.Resume = None,
    threads: options.Threads = 0,
    cluster: options.Cluster = None,
    variant: options.Variant = None,
    changes: options.Set = None,
    solver: options.Solver = None,
    plot: options.Plot = None,
    show: Annotated[
        bool, typer.Option("--open", help="Open the figure when done, if there is a display.")
    ] = False,
    as_json: options.Json = False,
) -> int:
    """Optimise a design for an objective.

    Every evaluated design is recorded immediately in the study folder, so a study can be
    interrupted (Ctrl-C) at any time and resumed with the same final result.

    Examples
    --------
    * `flexor optimize finger --parameters L+R01 --objective bending`
    * `flexor optimize finger -p RLP --option starts=8 --budget 5000`
    * `flexor optimize finger -p R01 -o tip-force --start "0.6 cm, 0.8 cm" --out studies/press`
    * `flexor optimize pneumatic-finger --vary "exosuit.section.wall=1.5 mm:3 mm" --maximise
      range-of-motion --subject-to "overlap <= 1.5 mm"`
    * `flexor optimize pneumatic-finger --tolerance "exosuit.section.wall=0.1 mm"`
    * `flexor optimize glove.toml --scenarios all --aggregate "served 60 deg"`
    * `flexor optimize --resume studies/press`

    The JSON object uses SI units, with angles in rad; with `--json`, a figure is drawn only to
    the file of `--plot`.
    """
    from flexor import study as studies
    from flexor.cli import outcome
    from flexor.cli.progress import SearchProgress
    from flexor.design import parameter_set, variables
    from flexor.design.start import starts
    from flexor.model.schema import Design

    free = ("budget", "threads", "cluster", "plot", "show", "as_json")
    check_resumable(context, "study", model, folder, resume, *free)
    if resume is not None:
        place, work = resume, partial(studies.resume, resume, budget=budget)
    else:
        assert model is not None
        loaded = load_changed(model, variant, changes)
        given = {"--parameters": "parameters", "--objective": "objective"}
        stated = [option for option, name in given.items() if _is_given(context, name)]
        stated_there = loaded.file.design or Design.model_construct()
        varied = dict(ranges("--vary", vary or [])) or stated_there.varied
        chosen = (
            variables(varied, loaded, "--vary" if vary else f"{loaded.name}: design.variable")
            if varied and "--parameters" not in stated
            else parameter_set(parameters, loaded.design)
        )
        if vary and "--parameters" in stated:
            raise InputError("--vary and --parameters are two statements of what varies: give one.")
        aims = [f"{sense} {name}" for sense, name in _aims(maximise, minimise) if name]
        if len(aims) + ("--objective" in stated) > 1:
            raise InputError("give one of --maximise, --minimise and --objective.")
        aim = aims[0] if aims else objective
        if "--objective" not in stated and not aims:
            aim = stated_there.aim or objective
        place = folder or new_folder(loaded.name, chosen.name, aim.replace(" ", "-"))
        work = partial(
            studies.optimize,
            loaded,
            chosen,
            aim,
            method,
            subject_to=subject_to or stated_there.subject_to,
            without=without or stated_there.without,
            scenarios=scenarios or stated_there.scenarios,
            aggregate=aggregate or stated_there.aggregate,
            tolerance=assignments("--tolerance", tolerance or [], "exosuit.section.wall=0.1 mm")
            or stated_there.tolerance,
            samples=stated_there.samples if samples is None else samples,
            method_options=numbers("--option", method_options or []),
            start=starts(start or [], chosen),
            force=one_or_assignments("--load", force, "chamber=0:5:1"),
            seed=seed,
            budget=budget,
            folder=place,
            engine_options=numbers("--solver", solver or []),
        )

    def report(study: Study, seconds: float) -> int:
        if as_json:
            print_json(outcome.as_json(study, seconds))
        else:
            outcome.print_summary(study, seconds, resumed=resume is not None)
        if plot is not None or not as_json:
            outcome.draw(study, plot, quiet=as_json)
        if show:
            _open(study)
        return 0

    where = executor_for(threads, cluster)
    return carry_out("flexor optimize --resume", place, where, SearchProgress(), work, report)


def _aims(maximise: str | None, minimise: str | None) -> list[tuple[str, str | None]]:
    return [("maximise", maximise), ("minimise", minimise)]


def _is_given(context: typer.Context, name: str) -> bool:
    source = context.get_parameter_source(name)
    return source is not None and source.name != "DEFAULT"


def _open(study: Study) -> None:
    import os
    import sys

    desktop = sys.platform in ("win32", "darwin") or any(
        os.environ.get(name) for name in ("DISPLAY", "WAYLAND_DISPLAY")
    )
    if desktop and sys.stdout.isatty() and study.folder is not None:
        typer.launch(str((study.folder / "designs.png").resolve()))
