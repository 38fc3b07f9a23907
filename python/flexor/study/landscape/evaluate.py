"""Evaluate a landscape as a study: recorded, resumable, with progress."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

from numpy.typing import ArrayLike

from flexor.arguments import check_callable, integer
from flexor.design import ParameterSet
from flexor.errors import InputError, unknown
from flexor.objectives import Objective
from flexor.optimizers import Grid
from flexor.study.executors import AnyExecutor
from flexor.study.landscape.result import Landscape
from flexor.study.optimization import resume_search, run_search
from flexor.study.problem import Problem
from flexor.study.settings import LANDSCAPE, Settings, reopened
from flexor.study.study import Study, StudyCallback

if TYPE_CHECKING:
    from flexor.model import Model


def landscape(
    model: Model | str | PathLike[str],
    parameters: str | ParameterSet | Mapping[str, Sequence[object]] = "R01",
    objective: str | Objective = "bending",
    *,
    subject_to: Sequence[str] = (),
    without: Sequence[str] = (),
    grid: int = 81,
    axes: Sequence[str] | None = None,
    start: ArrayLike | str | None = None,
    bounds: Mapping[str, tuple[float, float]] | None = None,
    force: Any = None,
    folder: str | Path | None = None,
    resume: bool = False,
    progress: StudyCallback | None = None,
    executor: AnyExecutor | None = None,
    finish: Callable[[Landscape], None] | None = None,
    engine_options: Mapping[str, float] | None = None,
) -> Landscape:
    """Evaluate an objective on a grid over one or two parameters.

    Parameters
    ----------
    model, parameters, objective, subject_to, without
        As for `flexor.optimize`.
    grid : int
        Points along each axis, both bounds included.
    axes : sequence of str, optional
        Labels of the one or two parameters to vary; required if the set has more than two.
    start : (k,) array, optional
        Values of the other parameters, SI; the set's own start by default.
    bounds, force, folder, resume, progress, executor, finish, engine_options : optional
        As for `flexor.optimize`; ``finish`` is called with the landscape.

    Returns
    -------
    Landscape
        Arrays over the grid; draw it with `flexor.plot.landscape`.

    Raises
    ------
    InputError
        If a name is not known, the axes are not one or two of the set's parameters, or the folder
        cannot be used.
    """
    problem = Problem.of(
        model, parameters, objective, force, bounds, engine_options, subject_to, without
    )
    if problem.objective.count:
        raise InputError("a landscape shows one objective, not several.")
    check_callable("finish", finish)
    study = run_search(
        LANDSCAPE,
        problem,
        _grid(problem.parameters, integer("grid", grid, 2), axes),
        start,
        folder=folder,
        resume=resume,
        progress=progress,
        executor=executor,
        finish=_finished(finish),
    )
    return Landscape.of(study)


def resume_landscape(
    folder: str | Path,
    *,
    progress: StudyCallback | None = None,
    executor: AnyExecutor | None = None,
    finish: Callable[[Landscape], None] | None = None,
) -> Landscape:
    """Resume a landscape from its folder.

    Parameters
    ----------
    folder : path
        The landscape folder.
    progress, executor, finish : optional
        As for `landscape`.

    Returns
    -------
    Landscape
        Arrays over the grid.

    Raises
    ------
    InputError
        If the folder is not a landscape, is damaged or in use, or names something not known.
    """
    place = Path(folder)
    settings = Settings.read(place, LANDSCAPE)
    check_callable("finish", finish)
    study = resume_search(
        place,
        settings,
        reopened(place, settings),
        progress=progress,
        executor=executor,
        finish=_finished(finish),
    )
    return Landscape.of(study)


def _finished(finish: Callable[[Landscape], None] | None) -> Callable[[Study], None] | None:
    return None if finish is None else lambda study: finish(Landscape.of(study))


def _grid(chosen: ParameterSet, points: int, axes: Sequence[str] | None) -> Grid:
    if axes is None:
        if chosen.size > 2:
            raise InputError(
                f"parameter set {chosen.name} has {chosen.size} parameters "
                f"({', '.join(chosen.labels)}): choose one or two of them as axes."
            )
        return Grid(points)
    if isinstance(axes, str) or not 1 <= len(axes) <= 2 or len(set(axes)) < len(axes):
        raise InputError(
            f"axes must be one or two different parameters, got {', '.join(axes) or 'none'}."
        )
    for label in axes:
        if label not in chosen.labels:
            raise unknown(f"parameter of the set {chosen.name}", label, chosen.labels)
    return Grid(points, tuple(chosen.labels.index(label) for label in axes))
