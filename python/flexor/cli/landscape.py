"""`flexor landscape`: an objective over one or two parameters, evaluated and drawn."""

from __future__ import annotations

import json
import time
from pathlib import Path as FilePath
from typing import TYPE_CHECKING, Annotated, Any

import typer

from flexor.cli.changes import load_changed
from flexor.cli.console import err, out
from flexor.cli.evaluation import executor_for
from flexor.cli.options import (
    Cluster,
    Constants,
    EvaluationForce,
    OptionalModel,
    Parameters,
    Set,
    Solver,
    StudyFolder,
    Threads,
)
from flexor.cli.progress import duration
from flexor.cli.studies import interrupted, new_folder, reject_fixed_options, save_figure
from flexor.cli.table import number
from flexor.cli.values import numbers
from flexor.errors import ClusterError, InputError

if TYPE_CHECKING:
    from flexor.design import ParameterSet
    from flexor.study import Study
    from flexor.study.landscape import Landscape, SearchPath


def landscape(
    context: typer.Context,
    model: OptionalModel = None,
    parameters: Parameters = "R01",
    objective: Annotated[
        str, typer.Option("--objective", "-o", help="Objective (see `flexor sets`).")
    ] = "bending",
    grid: Annotated[int, typer.Option(help="Number of points per axis.")] = 81,
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
    force: EvaluationForce = None,
    searches: Annotated[
        list[FilePath] | None,
        typer.Option(
            "--study",
            help="Overlay the search path of this study (a folder of `flexor optimize`); may be "
            "repeated.",
        ),
    ] = None,
    folder: StudyFolder = None,
    resume: Annotated[
        FilePath | None, typer.Option(help="Resume the landscape in this folder.")
    ] = None,
    threads: Threads = 0,
    cluster: Cluster = None,
    constants: Constants = None,
    changes: Set = None,
    solver: Solver = None,
    plot: Annotated[
        FilePath | None, typer.Option(help="Also save the figure to this PNG, SVG or PDF file.")
    ] = None,
    as_json: Annotated[
        bool, typer.Option("--json", help="Print a JSON object instead of text.")
    ] = False,
) -> int:
    """Evaluate and plot an objective on a grid over one or two parameters.

    Every evaluated design is recorded immediately in the study folder, so a landscape can be
    interrupted (Ctrl-C) and resumed. The completed folder contains the arrays (`landscape.npz`),
    a row per design (`landscape.csv`) and the figure (`landscape.png`, `landscape.svg`): a
    surface and a contour plot with the minimum of the grid, the designs that snap and those that
    failed.

    Examples
    --------
    * `flexor landscape finger --parameters R01 --objective f_b`
    * `flexor landscape finger -p L+R01 --axes L,R_1 --start "R_0=0.7 cm" --grid 41`
    * `flexor landscape finger -p L --grid 201 --constants printed --out studies/length`
    * `flexor landscape finger -p R01 --study studies/finger-R01-bending`
    """
    from flexor import study as studies
    from flexor.cli.progress import SearchProgress
    from flexor.study.landscape import Landscape, SearchPath

    if plot is not None:
        from flexor.plot import writable

        writable(plot)
    if model is None and resume is None:
        raise InputError("give a MODEL, or --resume FOLDER to resume a landscape.")
    if resume is not None and (folder is not None or model is not None):
        raise InputError("--resume takes only the folder: omit MODEL and --out.")
    if resume is not None:
        reject_fixed_options(context, resume, "searches", "threads", "cluster", "plot", "as_json")
    overlays = [(each, studies.Study.open(each)) for each in searches or []]
    began, place = time.monotonic(), resume
    try:
        with executor_for(threads, cluster) as executor, SearchProgress() as progress:
            if resume is not None:
                Landscape.check(resume)
                study = studies.Study.open(resume)
                if study.finished is None:
                    study.close()
                    study = studies.resume(resume, progress=progress, executor=executor)
            else:
                assert model is not None
                loaded = load_changed(model, constants, changes or [])
                settings = _settings(loaded, parameters, axes, grid, start, force)
                chosen = settings["parameters"]
                for each, search in overlays:
                    _check_same_set(each, search, chosen)
                place = folder or new_folder(loaded.name, chosen.name, objective, "landscape")
                study = studies.optimize(
                    loaded,
                    objective=objective,
                    folder=place,
                    progress=progress,
                    executor=executor,
                    engine_options=numbers("--solver", solver or []),
                    **settings,
                )
    except (KeyboardInterrupt, ClusterError) as error:
        return interrupted(place, "flexor landscape --resume", error)
    result = Landscape.of(study)
    seconds = time.monotonic() - began
    for each, search in overlays:
        _check_same_set(each, search, study.problem.parameters)
    files = _keep(
        result, [SearchPath.from_study(search, each.name) for each, search in overlays], plot
    )
    if as_json:
        print(json.dumps(_as_json(result, seconds, files), allow_nan=False))
    else:
        _print_summary(result, seconds, files)
    return 0


def _settings(
    model: Any, parameters: str, axes: str | None, grid: int, start: str | None, force: str | None
) -> dict[str, Any]:
    from flexor import design
    from flexor.design.start import starts
    from flexor.model import forces
    from flexor.study.landscape import grid_over

    chosen = design.parameter_set(parameters, model.design)
    labels = None if axes is None else [label.strip() for label in axes.split(",")]
    if start is not None and start.strip().lower() == "random":
        raise InputError('--start is "random": a landscape needs values, such as "L=8 cm".')
    return {
        "parameters": chosen,
        "method": grid_over(chosen, grid, labels),
        "start": starts([] if start is None else [start], chosen),
        "force": None if force is None else forces(force),
    }


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
    with err.status("drawing the landscape"):
        figure = plot.landscape(result, paths)
        files += save_figure(figure, place, "landscape")
        if also is not None:
            files.append(plot.save(figure, also))
    return files


def _print_summary(result: Landscape, seconds: float, files: list[FilePath]) -> None:
    objective, failed = result.problem.objective, int(result.failed.sum())
    size = " × ".join(str(n) for n in result.value.shape)
    sentences = [f"{size} designs in {duration(seconds)}."]
    if failed < result.value.size:
        best = result.minimum
        at = ", ".join(
            f"{label} = {number(value / scale)}{'' if unit == '1' else ' ' + unit}"
            for label, value, scale, unit in zip(
                result.problem.parameters.labels,
                best.vector.tolist(),
                result.problem.parameters.scale.tolist(),
                result.problem.parameters.units,
                strict=True,
            )
        )
        value = f"{objective.quantity} {number(best.shown)} {objective.unit}".rstrip()
        sentences.append(f"Minimum of the grid at {at}: {value}.")
        minima, snap = len(result.local_minima()), _share(float((result.events > 0).mean()))
        sentences.append(
            f"{minima} local {'minimum' if minima == 1 else 'minima'}; {snap} of the designs snap, "
            f"{_share(float(result.failed.mean()))} fail."
        )
    else:
        sentences.append(f"All designs failed: {result.reason.flat[0]}.")
    for sentence in sentences:
        out.print(sentence, markup=False, soft_wrap=True)
    for file in files:
        out.print(f"file: {file}", markup=False, soft_wrap=True)


def _share(part: float) -> str:
    return "none" if part == 0.0 else f"{100.0 * part:.2g} %"


def _as_json(result: Landscape, seconds: float, files: list[FilePath]) -> dict[str, Any]:
    """Return parameters in SI, `value` and `bending` [rad] of the minimum, and counts."""
    minimum = None
    if not result.failed.all():
        best = result.minimum
        minimum = {"parameters": best.parameters, "value": best.value, "bending": best.bending}
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
        "seconds": seconds,
        "folder": str(result.study.folder),
        "files": [str(file) for file in files],
    }
