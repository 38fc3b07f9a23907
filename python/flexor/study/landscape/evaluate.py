"""Evaluate a landscape as a study: recorded, resumable, with progress."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from numpy.typing import ArrayLike

from flexor.design import ParameterSet, parameter_set
from flexor.errors import InputError, unknown
from flexor.model.loading import require_model
from flexor.objectives import Objective
from flexor.optimizers import Grid
from flexor.study.executors import AnyExecutor
from flexor.study.landscape.result import Landscape
from flexor.study.optimization import optimize
from flexor.study.study import StudyCallback

if TYPE_CHECKING:
    from flexor.model import Model


def landscape(
    model: Model,
    parameters: str | ParameterSet = "R01",
    objective: str | Objective = "bending",
    *,
    grid: int = 81,
    axes: Sequence[str] | None = None,
    start: ArrayLike | str | None = None,
    bounds: Mapping[str, tuple[float, float]] | None = None,
    force: Any = None,
    folder: str | Path | None = None,
    resume: bool = False,
    progress: StudyCallback | None = None,
    executor: AnyExecutor | None = None,
    engine_options: Mapping[str, float] | None = None,
) -> Landscape:
    """Evaluate an objective on a grid over one or two parameters.

    Parameters
    ----------
    model, parameters, objective : Model, str or ParameterSet, str or Objective
        As for `flexor.optimize`.
    grid : int
        Points along each axis, both bounds included.
    axes : sequence of str, optional
        Labels of the one or two parameters to vary; required if the set has more than two.
    start : (k,) array, optional
        Values of the other parameters, SI; the set's own start by default.
    bounds, force, folder, resume, progress, executor, engine_options : optional
        As for `flexor.optimize`.

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
    chosen = parameter_set(parameters, require_model(model).design)
    study = optimize(
        model,
        chosen,
        objective,
        _grid(chosen, grid, axes),
        start=start,
        bounds=bounds,
        force=force,
        folder=folder,
        resume=resume,
        progress=progress,
        executor=executor,
        engine_options=engine_options,
    )
    return Landscape.of(study)


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
