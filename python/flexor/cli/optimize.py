"""`flexor optimize`: optimise a design for an objective."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from flexor.cli import options
from flexor.cli.console import print_json
from flexor.cli.design_problem import say_unapplied, stated, uncertainty
from flexor.cli.folders import carry_out, check_resumable, executor_for, new_folder
from flexor.cli.saving import save_model
from flexor.cli.values import load_changed, numbers, one_or_assignments
from flexor.errors import InputError

if TYPE_CHECKING:
    from flexor.study import Study


def optimize(
    context: typer.Context,
    model: options.OptionalModel = None,
    parameters: options.Parameters = "L+R01",
    objective: options.Objective = "bending",
    vary: options.Vary = None,
    choose: options.Choose = None,
    maximise: options.Maximise = None,
    minimise: options.Minimise = None,
    subject_to: options.SubjectTo = None,
    without: options.Without = None,
    scenarios: options.Scenarios = None,
    aggregate: options.Aggregate = None,
    tolerance: options.Tolerance = None,
    samples: options.Samples = None,
    wearers: options.Wearers = None,
    sizes: options.Sizes = None,
    method: Annotated[
        str | None,
        typer.Option(
            autocompletion=options.method_names,
            help="Search method (see `flexor methods`); by default `auto` with --maximise or "
            "--minimise, `pareto` with several of these, otherwise `pattern-search`.",
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
    save: options.Save = None,
    show: Annotated[
        bool, typer.Option("--open", help="Open the figure when done, if there is a display.")
    ] = False,
    as_json: options.Json = False,
) -> int:
    """Optimise a design for an objective, or find the front between several.

    Every evaluated design is recorded immediately in the study folder, so a study can be
    interrupted (Ctrl-C) at any time and resumed with the same final result.

    Examples
    --------
    * `flexor optimize finger --parameters L+R01 --objective bending`
    * `flexor optimize finger -p RLP --option starts=8 --budget 5000`
    * `flexor optimize finger -p R01 -o tip-force --start "0.6 cm, 0.8 cm" --out studies/press`
    * `flexor optimize pneumatic-finger --vary "exosuit.section.wall=1.5 mm:3 mm" --maximise
      range-of-motion --subject-to "overlap <= 1.5 mm"`
    * `flexor optimize pneumatic-finger --maximise range-of-motion --minimise mass`, then
      `flexor front FOLDER --point 7 --save light.toml`
    * `flexor optimize pneumatic-finger --tolerance "exosuit.section.wall=0.1 mm"`
    * `flexor optimize glove.toml --scenarios all --aggregate "served 60 deg"`
    * `flexor optimize pneumatic-finger --wearers 64 --sizes 3 --aggregate "served 45 deg"`
    * `flexor optimize pneumatic-finger --choose middle=with,without --choose
      "exosuit.material=dragon-skin-30,ecoflex-00-50"`
    * `flexor optimize --resume studies/press`

    The JSON object uses SI units, with angles in rad; with `--json`, a figure is drawn only to
    the file of `--plot`.
    """
    from flexor import study as studies
    from flexor.cli import choices_report, outcome, sizes_report
    from flexor.cli.progress import SearchProgress
    from flexor.design import parameter_set
    from flexor.design.start import starts

    free = ("budget", "threads", "cluster", "plot", "save", "show", "as_json")
    check_resumable(context, "study", model, folder, resume, *free)
    if resume is not None and studies.is_choices(resume):
        if budget is not None:
            raise InputError("choices are resumed with their own budget: omit --budget.")
        chosen_work = partial(studies.resume_choices, resume)
        where = executor_for(threads, cluster)
        return choices_report.carry_out(chosen_work, where, resume, plot, save, as_json, True)
    if resume is not None:
        place, work = resume, partial(studies.resume, resume, budget=budget)
    else:
        assert model is not None
        loaded = load_changed(model, variant, changes)
        problem = stated(
            context, loaded, objective, vary, maximise, minimise, subject_to, without, choose
        )
        chosen = problem.varied or parameter_set(parameters, loaded.design)
        aims = [each.replace(" ", "-") for each in problem.aims]
        place = folder or new_folder(loaded.name, chosen.name, *aims)
        if save is not None and (sizes is not None or len(problem.aims) > 1):
            raise InputError("--save writes one design: see `flexor front` for one of several.")
        if problem.choices:
            if sizes is not None:
                raise InputError("--sizes and choices exclude each other: give one of them.")
            if len(problem.aims) > 1:
                raise InputError("choices are made for one objective, not for several.")
            chosen_work = partial(
                studies.choices,
                loaded,
                dict(problem.bounds) or parameters,
                problem.aim,
                problem.choices,
                method=method,
                subject_to=problem.subject_to,
                without=problem.without,
                **uncertainty(loaded, problem, scenarios, aggregate, tolerance, samples, wearers),
                method_options=numbers("--option", method_options or []),
                start=start or None,
                force=one_or_assignments("--load", force, "chamber=0:5:1"),
                seed=seed,
                budget=budget,
                folder=place,
                engine_options=numbers("--solver", solver or []),
            )
            where = executor_for(threads, cluster)
            return choices_report.carry_out(chosen_work, where, place, plot, save, as_json)
        if sizes is not None:
            if len(problem.aims) > 1:
                raise InputError("sizes are found for one objective, not for several.")
            if tolerance or samples is not None:
                raise InputError(
                    "--sizes are found for wearers and scenarios without errors: leave out "
                    f"{'--tolerance' if tolerance else '--samples'}."
                )
            say_unapplied(loaded, "sizes")
            over = uncertainty(
                loaded, problem, scenarios, aggregate, None, None, wearers, for_sizes=True
            )
            found = partial(
                studies.sizes,
                loaded,
                chosen,
                problem.aim,
                sizes,
                subject_to=problem.subject_to,
                without=problem.without,
                scenarios=over["scenarios"],
                wearers=over["wearers"],
                aggregate=over["aggregate"],
                method=method or "auto",
                method_options=numbers("--option", method_options or []),
                force=one_or_assignments("--load", force, "chamber=0:5:1"),
                seed=seed,
                budget=budget,
                folder=place,
                engine_options=numbers("--solver", solver or []),
            )
            return sizes_report.carry_out(
                found, executor_for(threads, cluster), place, plot, as_json
            )
        if len(problem.aims) > 1:
            say_unapplied(loaded, "a front of several objectives")
        work = partial(
            studies.optimize,
            loaded,
            chosen,
            problem.aims,
            method,
            subject_to=problem.subject_to,
            without=problem.without,
            **uncertainty(loaded, problem, scenarios, aggregate, tolerance, samples, wearers),
            method_options=numbers("--option", method_options or []),
            start=starts(start or [], chosen),
            force=one_or_assignments("--load", force, "chamber=0:5:1"),
            seed=seed,
            budget=budget,
            folder=place,
            engine_options=numbers("--solver", solver or []),
        )

    def report(study: Study, seconds: float) -> int:
        if study.problem.objective.count:
            if save is not None:
                raise InputError("--save writes one design: see `flexor front` for one of several.")
            return _report_front(study, seconds, plot, as_json, resume is not None)
        best = study.best
        if as_json:
            print_json(outcome.as_json(study, best, seconds))
        else:
            outcome.print_summary(study, best, seconds, resumed=resume is not None)
        if plot is not None or not as_json:
            outcome.draw(study, best, plot, quiet=as_json)
        save_model(best, save, f"the best design of {place}")
        if show:
            _open(study)
        return 0

    if plot is not None or not as_json:
        outcome.import_figures()
    where = executor_for(threads, cluster)
    return carry_out("flexor optimize --resume", place, where, SearchProgress(), work, report)


def _report_front(
    study: Study, seconds: float, plot: Path | None, as_json: bool, resumed: bool
) -> int:
    from flexor.cli import front_report

    front = study.front
    if as_json:
        print_json(front_report.front_as_json(study, front, seconds))
    else:
        front_report.print_front(study, front, seconds, resumed)
    front_report.draw_front(study, front, plot, quiet=as_json)
    return 0


def _open(study: Study) -> None:
    import os
    import sys

    desktop = sys.platform in ("win32", "darwin") or any(
        os.environ.get(name) for name in ("DISPLAY", "WAYLAND_DISPLAY")
    )
    if desktop and sys.stdout.isatty() and study.folder is not None:
        typer.launch(str((study.folder / "designs.png").resolve()))
