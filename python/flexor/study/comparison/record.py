"""The record of a comparison: finished searches, and evaluations of those that are running."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
from pydantic import FiniteFloat, NonNegativeInt

from flexor.optimizers import SearchResult
from flexor.store import Database, Header, Kind
from flexor.study.comparison.result import SearchRun
from flexor.study.problem import Problem
from flexor.study.record import TABLES, Record
from flexor.study.settings import (
    ConstraintTable,
    MethodTable,
    ModelTable,
    ObjectiveTable,
    SetTable,
)

_TABLES = """
CREATE TABLE searches (
    search TEXT PRIMARY KEY, -- set, method and seed, as a JSON list
    result TEXT NOT NULL     -- what it found, as JSON
) WITHOUT ROWID;
"""


class _Shape(Header):
    model: ModelTable
    objective: ObjectiveTable
    constraints: list[ConstraintTable]
    budget: NonNegativeInt
    engine: dict[str, FiniteFloat]
    sets: dict[str, SetTable]
    methods: dict[str, MethodTable]
    seeds: list[NonNegativeInt]


COMPARISON = Kind(
    name="comparison",
    schema=_Shape,
    tables=TABLES + _TABLES,
    growing=("sets", "methods", "seeds"),
    hashed={"model.hash": "a model that differs from the one now given"},
)
Key = tuple[str, str, int]  # of a search: parameter set, method and seed
_ARRAYS = {
    "design": np.float64,
    "improvement_evaluations": np.int64,
    "improvement_values": np.float64,
    "improvement_designs": np.float64,
}


def running_record(database: Database, problem: Problem, key: Key) -> Record:
    """Return the record of a search that has not finished."""
    return Record(database, problem.sizes, search=json.dumps(key))


def save(database: Database, run: SearchRun) -> None:
    """Keep a finished search, instead of its evaluations."""
    result, search = run.result, json.dumps((run.parameters, run.method, run.seed))
    values = {
        "seconds": run.seconds if np.isfinite(run.seconds) else None,
        "value": result.value if np.isfinite(result.value) else None,
        "evaluations": result.evaluations,
        "iterations": result.iterations,
        "reason": result.reason,
        **{name: getattr(result, name).tolist() for name in _ARRAYS},
    }
    database.write(
        ("INSERT INTO searches VALUES (?, ?)", [(search, json.dumps(values))]),
        ("DELETE FROM evaluations WHERE search = ?", [(search,)]),
    )


def references(database: Database) -> dict[str, float]:
    """Return the value of each set's own start, as far as they are known."""
    noted = database.noted("reference") or {}
    if not isinstance(noted, dict) or not all(
        isinstance(value, float) and not np.isnan(value) for value in noted.values()
    ):
        raise database.damaged("a reference is not a number")
    return noted


def finished(database: Database) -> dict[Key, SearchRun]:
    """Return the finished searches."""
    runs = {}
    for search, text in database.rows("SELECT search, result FROM searches"):
        try:
            parameters, method, seed = json.loads(search)
            if [type(each) for each in (parameters, method, seed)] != [str, str, int]:
                raise ValueError("not a set, a method and a seed")
            values = json.loads(text)
            arrays: dict[str, Any] = {
                name: np.array(values[name], dtype=kind) for name, kind in _ARRAYS.items()
            }
            shape = (-1, arrays["design"].size)
            arrays["improvement_designs"] = arrays["improvement_designs"].reshape(shape)
            result = SearchResult(
                value=np.inf if values["value"] is None else float(values["value"]),
                evaluations=int(values["evaluations"]),
                iterations=int(values["iterations"]),
                reason=str(values["reason"]),
                **arrays,
            )
            seconds = np.nan if values["seconds"] is None else float(values["seconds"])
            given = [values[name] for name in ("value", "seconds") if values[name] is not None]
            if not all(np.isfinite(each).all() for each in (given, *arrays.values())):
                raise ValueError("a number is not finite")
        except (ValueError, KeyError, TypeError, OverflowError, RecursionError):
            raise database.damaged("a finished search is damaged") from None
        runs[parameters, method, seed] = SearchRun(parameters, method, seed, result, seconds)
    return runs
