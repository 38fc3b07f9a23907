"""`flexor landscape`: an objective over one or two parameters, evaluated and drawn."""

from __future__ import annotations

from functools import partial
from pathlib import Path as FilePath
from typing import TYPE_CHECKING, Annotated, Any

import typer

from flexor.cli import options
from flexor.cli.console import print_json, say
from flexor.cli.design_problem import say_unapplied, stated
from flexor.cli.folders import carry_out, check_resumable, executor_for, new_folder, save_figure
from flexor.cli.progress import SearchProgress, duration, working
from flexor.cli.values import load_changed, numbers, one_or_assignments
from flexor.errors import InputError

if TYPE_CHECKING:
    from flexor.design import ParameterSet
    from flexor.study import Study
    from flexor.study.landscape import Landscape, SearchPath


def landscape(
    context: typer.Context,
    model: options.OptionalModel = None,
    parameters: options.Parameters = "R01",
    objective: options.Objective = "bending",
    vary: options.Vary = None,
    maximise: options.Maximise = None,
    minimise: options.Minimise = None,
    subject_to: options.SubjectTo = None,
    without: options.Without = None,
    grid: Annotated[
        int, typer.Option(callback=options.at_least(2), help="Number of points per axis.")
    ] = 81,
    axes: Annotated[
        str | None,
        typer.Option(
            help="One or two parameters to vary, such as `R_0,R_1`; the others are fixed at the "
            "start. Required if the set has more than two."
        ),
    ] = None,
    start: Annotated[
        str | None,
        typer.Option(
            help="Values of the fixed parameters, such as `L=8 cm`; the model's own by default."
        ),
    ] = None,
    force: options.Load = None,
    searches: Annotated[
        list[FilePath] | None,
        typer.Option(
            "--study",
            help="Overlay the search path of this study (a folder of `flexor optimize`); may be "
            "repeated.",
        ),
    ] = None,
    folder: options.Folder = None,
    resume: options.Resume = None,
    threads: options.Threads = 0,
    cluster: options.Cluster = None,
    variant: options.Variant = None,
    changes: options.Set = None,
    solver: options.Solver = None,
    plot: options.Plot = None,
    as_json: options.Json = False,
) -> int:
    """Evaluate and plot an objective on a grid over one or two parameters.

    Every evaluated design is recorded immediately in the landscape folder, so a landscape can be
    interrupted (Ctrl-C) and resumed. The completed folder contains the arrays (`landscape.npz`),
    a row per design (`landscape.csv`) and the figure (`landscape.png`, `landscape.svg`): a
    surface and a contour plot with the best design of the grid, the designs that snap or bifurcate
    and those that failed, and where each constraint is exceeded.

    Examples
    --------
    * `flexor landscape finger --parameters R01 --objective f_b`
    * `flexor landscape finger -p L+R01 --axes L,R_1 --start "R_0=0.7 cm" --grid 41`
    * `flexor landscape finger -p L --grid 201 --variant printed --out studies/length`
    * `flexor landscape finger -p R01 --study studies/finger-R01-bending`
    * `flexor landscape pneumatic-finger --vary "exosuit.length=8 cm:11 cm" --vary
      "exosuit.section.wall=1.5 mm:3 mm" --maximise range-of-motion --subject-to "overlap <= 1 mm"`
    * `flexor landscape pneumatic-finger --axes exosuit.length,exosuit.section.wall --grid 31`
    """
    from flexor import study as studies
    from flexor.design import parameter_set
    from flexor.study import landscape as landscapes
    from flexor.study.landscape import SearchPath

    free = ("searches", "threads", "cluster", "plot", "as_json")
    check_resumable(context, "landscape", model, folder, resume, *free)
    overlays = [(each, studies.Study.open(each)) for each in searches or []]
    if resume is not None:
        place, work = resume, partial(landscapes.resume_landscape, resume)
    else:
        assert model is not None
        loaded = load_changed(model, variant, changes)
        say_unapplied(loaded, "a landscape")
        problem = stated(context, loaded, objective, vary, maximise, minimise, subject_to, without)
        chosen = problem.varied or parameter_set(parameters, loaded.design)
        for each, search in overlays:
            _check_same_set(each, search, chosen)
        place = folder or new_folder(
            loaded.name, chosen.name, problem.aim.replace(" ", "-"), "landscape"
        )
        work = partial(
            landscapes.landscape,
            loaded,
            chosen,
            problem.aim,
            subject_to=problem.subject_to,
            without=problem.without,
            grid=grid,
            axes=None if axes is None else [label.strip() for label in axes.split(",")],
            start=_fixed(start, chosen),
            force=one_or_assignments("--load", force, "chamber=0:5:1"),
            folder=place,
            engine_options=numbers("--solver", solver or []),
        )

    def report(result: Landscape, seconds: float) -> int:
        for each, search in overlays:
            _check_same_set(each, search, result.problem.parameters)
        paths = [SearchPath.from_study(search, each.name) for each, search in overlays]
        files = _keep(result, paths, plot)
        if as_json:
            print_json(_as_json(result, seconds, files))
        else:
            _print_summary(result, seconds, files)
        return 0

    where = executor_for(threads, cluster)
    return carry_out("flexor landscape --resume", place, where, SearchProgress(), work, report)


def _fixed(start: str | None, chosen: ParameterSet) -> list[list[float]] | None:
    from flexor.design.start import starts

    found = starts([] if start is None else [start], chosen)
    if isinstance(found, str):
        raise InputError('--start is "random": a landscape needs values, such as "L=8 cm".')
    return found


def _check_same_set(folder: FilePath, search: Study, chosen: ParameterSet) -> None:
    searched = search.problem.parameters
    if searched.labels != chosen.labels:
        raise InputError(
            f'--study "{folder}" searched {searched.name} ({", ".join(searched.labels)}), '
            f"but the landscape is of {chosen.name} ({', '.join(chosen.labels)})."
        )


def _keep(result: Landscape, paths: list[SearchPath], also: FilePath | None) -> list[FilePath]:
    from flexor import plot

    place = result.study.folder
    assert place is not None
    files = result.save(place)
    with working("drawing the landscape", at_once=False):
        figure = plot.landscape(result, paths)
        files += save_figure(figure, place, "landscape", also)
    return files


def _print_summary(result: Landscape, seconds: float, files: list[FilePath]) -> None:

    size = " × ".join(str(n) for n in result.value.shape)
    sentences = [f"{size} designs in {duration(seconds)}."]
    if not result.failed.all():
        best = result.minimum
        if result.infeasible.all():
            sentences.append("No design of the grid keeps the constraints.")
        word = "Best" if result.problem.objective.of_observable else "Minimum"
        word = word if best.feasible else "Least violation"
        sentences.append(f"{word} of the grid at {best.text}: {best.result}.")
        minima, snap = len(result.local_minima()), _share(float((result.events > 0).mean()))
        sentences.append(
            f"{minima} local {'minimum' if minima == 1 else 'minima'}; {snap} of the designs snap "
            f"or bifurcate, {_share(float(result.failed.mean()))} fail."
        )
        if result.constraints:
            sentences += _kept(result)
    else:
        sentences.append(f"All designs failed: {result.reason.flat[0]}.")
    for line in (*sentences, *(f"file: {file}" for file in files)):
        say(line)


def _kept(result: Landscape) -> list[str]:
    """Say how many designs are infeasible, and by which constraints."""
    exceeded = (result.excesses > 0.0).reshape(-1, len(result.constraints)).mean(axis=0)
    parts = [
        f"{text} by {_share(share)}"
        for text, share in zip(result.constraints, exceeded.tolist(), strict=True)
        if share
    ]
    share = _share(float(result.infeasible.mean()))
    which = f": {', '.join(parts)}" if parts else ""
    return [f"{share.capitalize()} of the designs are infeasible{which}."]


def _share(part: float) -> str:
    return "none" if part == 0.0 else f"{100.0 * part:.2g} %"


def _as_json(result: Landscape, seconds: float, files: list[FilePath]) -> dict[str, Any]:
    """Return parameters in SI, `value` and `bending` [rad] of the minimum, and counts."""
    minimum = None
    if not result.failed.all():
        best = result.minimum
        minimum = {
            "parameters": best.parameters,
            "value": best.value,
            "bending": best.bending,
            "feasible": best.feasible,
        }
    return {
        "parameters": result.problem.parameters.name,
        "objective": result.problem.objective.name,
        "axes": {
            label: axis.tolist() for label, axis in zip(result.labels, result.axes, strict=True)
        },
        "minimum": minimum,
        "local_minima": len(result.local_minima()),
        "designs": int(result.value.size),
        "snapping": int((result.events > 0).sum()),
        "failed": int(result.failed.sum()),
        "infeasible": int(result.infeasible.sum()),
        "exceeded": {
            text: int((result.excesses[..., i] > 0.0).sum())
            for i, text in enumerate(result.constraints)
        },
        "seconds": seconds,
        "folder": result.study.folder,
        "files": files,
    }
