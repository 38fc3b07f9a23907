"""Settings of studies and comparisons, from a problem to a folder and back."""

from __future__ import annotations

from collections.abc import Mapping, Sequence, Sized
from dataclasses import asdict, dataclass, is_dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from pydantic import BaseModel, ConfigDict, FiniteFloat, NonNegativeInt, model_validator

from flexor.constraints import Constraint, constraint
from flexor.design import ParameterSet, parameter_set
from flexor.design.stated_variables import recorded_variables
from flexor.design.variables import NAME as FIELDS
from flexor.errors import InputError, shortened
from flexor.model.loads import loads
from flexor.model.toml import read_text
from flexor.model.written import Written
from flexor.objectives import Objective
from flexor.objectives import objective as named_objective
from flexor.optimizers import Budget, Search
from flexor.scenarios import Scenario
from flexor.store import RECORD, Database, Header, Kind, check_regular, read_settings
from flexor.study.problem import FloatArray, Problem
from flexor.study.record import TABLES, Record
from flexor.study.scenario_problem import ScenarioProblem, Uncertainty

if TYPE_CHECKING:
    from flexor.model import Model

MODEL, SOURCE = "model.toml", "source.toml"


class _Table(BaseModel):
    model_config = ConfigDict(extra="forbid", strict=True)


class ModelTable(_Table):
    """Which model; the file itself is beside the settings."""

    name: str
    variant: str | None
    hash: str


class ObjectiveTable(_Table):
    """What is wanted, and at which loads [N or Pa]: of one input, or a row a step."""

    name: str
    force: list[FiniteFloat] | list[list[FiniteFloat]]


class ConstraintTable(_Table):
    """What a design has to keep; ``default`` is what it is called among the defaults, or empty."""

    text: str
    default: str


class MethodTable(_Table):
    """How to search."""

    name: str
    options: dict[str, Any]


class LimitsTable(_Table):
    """Parameters of a set and their bounds, SI."""

    labels: list[str]
    lower: list[FiniteFloat]
    upper: list[FiniteFloat]

    @model_validator(mode="after")
    def _one_size(self) -> LimitsTable:
        if not len(self.labels) == len(self.lower) == len(self.upper):
            raise ValueError("rows of different lengths")
        return self


class ScenarioTable(_Table):
    """A scenario: what it changes in the model file, as a variant does."""

    name: str
    weight: FiniteFloat
    changes: dict[str, Any]


class UncertaintyTable(_Table):
    """Scenarios and tolerances, and what is made of the values of all."""

    scenarios: list[ScenarioTable]
    aggregate: str
    tolerance: dict[str, str]
    samples: NonNegativeInt
    seed: NonNegativeInt


class SetTable(LimitsTable):
    """Parameters of a set with the units in which they are shown."""

    units: list[str]

    @model_validator(mode="after")
    def _one_unit_each(self) -> SetTable:
        if len(self.units) != len(self.labels):
            raise ValueError("rows of different lengths")
        return self


class _Parameters(SetTable):
    name: str


class _Budget(_Table):
    evaluations: int | None
    seconds: FiniteFloat | None


class _Shape(Header):
    model: ModelTable
    parameters: _Parameters
    objective: ObjectiveTable
    constraints: list[ConstraintTable]
    uncertainty: UncertaintyTable | None
    method: MethodTable
    start: list[list[FiniteFloat]] | None
    seed: NonNegativeInt
    engine: dict[str, FiniteFloat]
    budget: _Budget

    @model_validator(mode="after")
    def _one_size(self) -> _Shape:
        rows: Sequence[Sized] = self.start or []
        if any(len(row) != len(self.parameters.labels) for row in rows):
            raise ValueError("rows of different lengths")
        return self


STUDY = Kind(
    name="study",
    schema=_Shape,
    tables=TABLES,
    free=("budget",),
    hashed={"model.hash": "a model that differs from the one now given"},
)
LANDSCAPE = replace(STUDY, name="landscape")


@dataclass(frozen=True)
class Settings:
    """Settings of a study, as plain JSON values; numbers are SI and read back exactly.

    They are ``format``, ``kind``, ``flexor`` (version), ``environment`` (engine, Python, packages,
    system), ``created``, ``model`` (name, variant, hash), ``parameters`` (name, labels, units,
    bounds), ``objective`` (name, forces), ``constraints`` (texts), ``uncertainty``
    (scenarios, tolerances; or nothing), ``method`` (name, options),
    ``start``, ``seed``, ``engine`` (options) and ``budget``.
    """

    values: Mapping[str, Any]

    @classmethod
    def read(cls, folder: Path, kind: Kind | None = None) -> Settings:
        """Read the settings of a study or landscape, or of that kind; InputError if it is none."""
        return cls(read_settings(kind or STUDY, folder, *([] if kind else [LANDSCAPE])))

    @property
    def kind(self) -> Kind:
        """Study or landscape."""
        return LANDSCAPE if self.values["kind"] == LANDSCAPE.name else STUDY


def study_settings(
    problem: Problem, search: Search, start: FloatArray | None, seed: int, budget: Budget
) -> dict[str, Any]:
    """Describe a study; a ``start`` of None is drawn from the seed."""
    chosen = problem.parameters
    return {
        **common_settings(problem),
        "uncertainty": _uncertainty(problem),
        "parameters": {"name": chosen.name, **set_table(chosen)},
        "method": method_table(search),
        "start": None if start is None else start.tolist(),
        "seed": seed,
        "budget": asdict(budget),
    }


def _uncertainty(problem: Problem) -> dict[str, Any] | None:
    if not isinstance(problem, ScenarioProblem):
        return None
    return {
        "scenarios": [asdict(each) for each in problem.scenarios],
        "aggregate": problem.aggregate.text,
        "tolerance": {each.field: each.text for each in problem.tolerances},
        "samples": problem.samples,
        "seed": problem.seed,
    }


def _over(nominal: Problem, table: Mapping[str, Any] | None) -> Problem:
    """Return the problem over the recorded scenarios and tolerances, if there are any."""
    if table is None:
        return nominal
    stated = Uncertainty(
        tuple(Scenario(**each) for each in table["scenarios"]),
        table["aggregate"],
        table["tolerance"],
        table["samples"],
    )
    return ScenarioProblem.over(nominal, stated, table["seed"])


def common_settings(problem: Problem) -> dict[str, Any]:
    """Describe what is common to all parameter sets: all but the set and the search."""
    model = problem.model
    return {
        "model": {"name": model.name, "variant": model.file.use, "hash": model.hash},
        "objective": {"name": problem.objective.name, "force": _recorded(problem.loads)},
        "constraints": [
            {"text": each.text(model), "default": each.default} for each in problem.constraints
        ],
        "engine": dict(problem.options),
    }


def _recorded(loads: FloatArray) -> list[Any]:
    """Return the loads of one input, or all as rows."""
    return [row[0] for row in loads.tolist()] if loads.shape[1] == 1 else loads.tolist()


def limits_table(chosen: ParameterSet) -> dict[str, Any]:
    """Describe the bounds of a parameter set."""
    lower, upper = chosen.lower.tolist(), chosen.upper.tolist()
    return {"labels": list(chosen.labels), "lower": lower, "upper": upper}


def set_table(chosen: ParameterSet) -> dict[str, Any]:
    """Describe a parameter set but for its name."""
    return {"units": list(chosen.units), **limits_table(chosen)}


def recorded_set(name: str, table: Mapping[str, Any], model: Model) -> ParameterSet:
    """Return the parameter set of a name that a `set_table` describes; InputError if unknown."""
    if name == FIELDS:
        return recorded_variables(table, model)
    return within_limits(parameter_set(name, model.design), table)


def recorded_constraints(
    tables: Sequence[Mapping[str, str]], model: Model
) -> tuple[Constraint, ...]:
    """Return the constraints that settings list."""
    return tuple(constraint(each["text"], model, each["default"]) for each in tables)


def within_limits(chosen: ParameterSet, table: Mapping[str, Any]) -> ParameterSet:
    """Return a parameter set with the bounds of a `limits_table`."""
    ends = zip(table["lower"], table["upper"], strict=True)
    return chosen.with_bounds(dict(zip(table["labels"], ends, strict=True)))


def method_table(search: Search) -> dict[str, Any]:
    """Describe a method with its options."""
    known = is_dataclass(search) and not isinstance(search, type)
    return {"name": search.name, "options": asdict(search) if known else {}}  # type: ignore[call-overload]


def reopened(
    folder: Path,
    settings: Settings,
    model: Model | None = None,
    parameters: ParameterSet | None = None,
    objective: Objective | None = None,
) -> Problem:
    """Make the problem that a study's settings describe, except for what is given."""
    values = settings.values
    model = model if model is not None else recorded_model(folder)
    try:
        kind, name = "parameters", values["parameters"]["name"]
        if parameters is None:
            chosen = recorded_set(name, values["parameters"], model)
        elif isinstance(parameters, ParameterSet):
            chosen = parameters
        else:
            chosen = parameter_set(parameters, model.design)
        kind, name = "objective", values["objective"]["name"]
        wanted = named_objective(name if objective is None else objective, model)
    except InputError as error:
        raise InputError(
            f'the {settings.kind.name} "{folder}" uses {kind} "{shortened(name)}", which Flexor '
            "does not know: "
            f"give it as {kind}=."
        ) from error
    kept = recorded_constraints(values["constraints"], model)
    wanted = at_loads(wanted, values, model)
    nominal = Problem(model, chosen.on_model(model), wanted, values["engine"], kept)
    return _over(nominal, values["uncertainty"])


def at_loads(wanted: Objective, values: Mapping[str, Any], model: Model) -> Objective:
    """Return an objective at the recorded loads."""
    return wanted.at(loads(values["objective"]["force"], model.input_dimensions))


def recorded_model(folder: Path) -> Model:
    """Load the model of a folder."""
    from flexor.model import load

    check_regular(folder / MODEL)
    model = load(folder / MODEL)
    # One that was made in Python has no author's text, and that of the folder is not one.
    source = folder / SOURCE
    there = check_regular(source)
    model.written = Written.of(read_text(source, "model file"), str(source)) if there else None
    return model


def model_files(model: Model) -> dict[str, str]:
    """Return the files of a folder that hold its model: every value, and its author's text."""
    files = {MODEL: model.file.to_toml()}
    if getattr(model, "written", None) is not None:
        files[SOURCE] = model.to_toml()
    return files


def study_record(
    kind: Kind, folder: Path | None, problem: Problem, database: Database, search: str = ""
) -> Record:
    """Return the record of a study in its database, if that is of this problem."""
    record = Record(database, search=search)
    if record.sizes != problem.sizes:
        record.close()
        raise InputError(
            f'the {kind.name} "{folder}" is damaged: its {RECORD} is of another {kind.name}.'
        )
    return record
