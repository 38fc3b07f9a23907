"""Settings of a study: everything that decides its numbers."""

from __future__ import annotations

from collections.abc import Mapping, Sized
from dataclasses import asdict, dataclass, is_dataclass
from pathlib import Path
from typing import Any

from pydantic import BaseModel, ConfigDict, FiniteFloat, NonNegativeInt, model_validator

from flexor.optimizers import Budget, Search
from flexor.store import Header, Kind, read_settings
from flexor.study.problem import FloatArray, Problem
from flexor.study.record import TABLES

MODEL = "model.toml"


class _Table(BaseModel):
    model_config = ConfigDict(extra="forbid", strict=True)


class ModelTable(_Table):
    """Which model; the file itself is beside the settings."""

    name: str
    constants: str | None
    hash: str


class ObjectiveTable(_Table):
    """What is wanted, and at which forces [N]."""

    name: str
    force: list[FiniteFloat]


class MethodTable(_Table):
    """How to search."""

    name: str
    options: dict[str, Any]


class _Parameters(_Table):
    name: str
    labels: list[str]
    units: list[str]
    lower: list[FiniteFloat]
    upper: list[FiniteFloat]


class _Budget(_Table):
    evaluations: int | None
    seconds: FiniteFloat | None


class _Shape(Header):
    model: ModelTable
    parameters: _Parameters
    objective: ObjectiveTable
    method: MethodTable
    start: list[list[FiniteFloat]] | None
    seed: NonNegativeInt
    engine: dict[str, FiniteFloat]
    budget: _Budget

    @model_validator(mode="after")
    def _one_size(self) -> _Shape:
        chosen = self.parameters
        rows: list[Sized] = [chosen.units, chosen.lower, chosen.upper, *(self.start or [])]
        if any(len(row) != len(chosen.labels) for row in rows):
            raise ValueError("rows of different lengths")
        return self


STUDY = Kind(
    name="study",
    schema=_Shape,
    tables=TABLES,
    free=("budget",),
    hashed={"model.hash": "a model that differs from the one now given"},
)


@dataclass(frozen=True)
class Settings:
    """Settings of a study, as plain JSON values.

    Attributes
    ----------
    values : dict
        ``format``, ``kind``, ``flexor`` (version), ``environment`` (engine, Python, packages,
        system), ``created``, ``model`` (name, constants, hash), ``parameters`` (name, labels,
        units, bounds), ``objective`` (name, forces), ``method`` (name, options), ``start``,
        ``seed``, ``engine`` (options) and ``budget``. Numbers are SI and read back exactly.
    """

    values: Mapping[str, Any]

    @classmethod
    def read(cls, folder: Path) -> Settings:
        """Read the settings of a study folder.

        Raises
        ------
        InputError
            If the folder is not a study, or one that this version cannot read.
        """
        return cls(read_settings(STUDY, folder))


def study_settings(
    problem: Problem, search: Search, start: FloatArray | None, seed: int, budget: Budget
) -> dict[str, Any]:
    """Describe a study; a ``start`` of None is drawn from the seed."""
    chosen = problem.parameters
    return {
        "model": model_table(problem),
        "parameters": {
            "name": chosen.name,
            "labels": list(chosen.labels),
            "units": list(chosen.units),
            "lower": chosen.lower.tolist(),
            "upper": chosen.upper.tolist(),
        },
        "objective": {"name": problem.objective.name, "force": problem.force.tolist()},
        "method": method_table(search),
        "start": None if start is None else start.tolist(),
        "seed": seed,
        "engine": dict(problem.options),
        "budget": asdict(budget),
    }


def model_table(problem: Problem) -> dict[str, Any]:
    """Describe a problem's model."""
    model = problem.model
    return {"name": model.name, "constants": model.file.use, "hash": model.hash}


def method_table(search: Search) -> dict[str, Any]:
    """Describe a method with its options."""
    known = is_dataclass(search) and not isinstance(search, type)
    return {"name": search.name, "options": asdict(search) if known else {}}  # type: ignore[call-overload]
