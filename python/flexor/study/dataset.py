"""Studies and landscapes as labelled arrays of xarray, to be saved as netCDF."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from flexor.model.dataset import add, require_xarray
from flexor.objectives import Several
from flexor.study.problem import FloatArray, Problem

if TYPE_CHECKING:
    from xarray import Dataset

    from flexor.model.results import Paths
    from flexor.study.landscape import Landscape
    from flexor.study.study import Study

_ONE = ("value", "shown", "reason", "violation", "event_count", "total_iterations")
_EACH = ("joint_angles", "tip_force", "touching")


def study_dataset(study: Study) -> Dataset:
    """Return every evaluation of a study; see `Study.to_xarray`."""
    outcomes, problem = study.record.outcomes(), study.problem
    data = _outcomes(outcomes, problem, ("design",))
    for name in _EACH:
        add(data, name, getattr(outcomes, name), ("design", "step"))
    designs = study.record.designs()
    for label, unit, column in zip(
        problem.parameters.labels, problem.parameters.si_units, designs.T, strict=True
    ):
        data[label] = ("design", column, _unit(unit))
    loads = (("step", "input"), problem.loads, {"long_name": "loads", "units": "SI"})
    coordinates = {**_coordinates(problem, data), "loads": loads}
    return require_xarray().Dataset(data, coordinates, _attributes(problem))


def landscape_dataset(landscape: Landscape) -> Dataset:
    """Return a landscape over its axes; see `Landscape.to_xarray`."""
    problem, labels = landscape.problem, landscape.labels
    data: dict[str, Any] = {}
    for name in ("value", "shown", "reason", "violation", "tip_force", "touching", "events"):
        add(data, name, getattr(landscape, name), labels)
    add(data, "joint_angles", landscape.joint_angles, labels)
    add(data, "constraint_values", landscape.constraint_values, labels)
    coordinates = _coordinates(problem, data)
    for label, axis, column in zip(labels, landscape.axes, landscape.columns, strict=True):
        coordinates[label] = (label, axis, _unit(problem.parameters.si_units[column]))
    for column, label in enumerate(problem.parameters.labels):
        if label not in labels:
            value = float(landscape.designs.reshape(-1, problem.parameters.size)[0, column])
            coordinates[label] = ((), value, _unit(problem.parameters.si_units[column]))
    return require_xarray().Dataset(data, coordinates, _attributes(problem))


def _outcomes(outcomes: Paths, problem: Problem, first: tuple[str, ...]) -> dict[str, Any]:
    data: dict[str, Any] = {}
    for name in _ONE:
        add(data, name, getattr(outcomes, name), first)
    values: FloatArray = outcomes.constraint_values
    if values.shape[1] == len(problem.constraints):  # not those of every scenario
        add(data, "constraint_values", values, first)
    add(data, "objective_values", outcomes.objective_values, first)
    return data


def _coordinates(problem: Problem, data: dict[str, Any]) -> dict[str, Any]:
    found: dict[str, Any] = {"joint": list(problem.model.joints)}
    if "constraint_values" in data:
        found["constraint"] = [each.text(problem.model) for each in problem.constraints]
    if "objective_values" in data and isinstance(problem.objective, Several):
        found["objective"] = [each.name for each in problem.objective.parts]
    return found


def _attributes(problem: Problem) -> dict[str, str]:
    return {
        "model": problem.model.name,
        "objective": problem.objective.name,
        "shown": f"{problem.quantity} {problem.unit}".rstrip(),
        "units": "SI unless said otherwise",
    }


def _unit(unit: str) -> dict[str, str]:
    return {"units": unit}
