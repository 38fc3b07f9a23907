"""The design problems on which search methods are measured, and their best known designs."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

import flexor
from flexor.study import Problem

SETS = ("L", "R01", "L+R01", "Rsc", "L+Rsc", "RLP", "L+RLP")
DEMO = "demo"
# The paper's sets with the constants that reproduce its model, and the problem that the pneumatic
# finger states in its file, with the default constraints.
NAMES = (*SETS, DEMO)
CONSTANTS = "surface"
BEST_KNOWN = Path(__file__).with_name("best_known.json")


def problem(name: str) -> Problem:
    """Return the problem of a name."""
    if name in SETS:
        return Problem.of(flexor.load("finger", CONSTANTS), name, "bending")
    model = flexor.load("pneumatic-finger")
    design = model.file.design
    assert design is not None
    return Problem.of(
        model, design.varied, design.aims, subject_to=design.subject_to, without=design.without
    )


def recorded() -> dict[str, dict[str, Any]]:
    """Return what `best_known.py` has recorded, by problem."""
    if not BEST_KNOWN.exists():
        return {}
    found: dict[str, dict[str, Any]] = json.loads(BEST_KNOWN.read_text(encoding="utf-8"))
    return found


def record(name: str, run: dict[str, Any], stated: Problem) -> None:
    """Add a run to the record of a problem, with its best design if that is better than all."""
    table = recorded()
    entry = table.setdefault(name, {"runs": []})
    entry["runs"].append(run)
    best = min(entry["runs"], key=lambda each: (each["violation"], each["value"]))
    start = stated.evaluate(stated.parameters.start[None, :])
    entry |= {
        "labels": stated.parameters.labels,
        "design": best["design"],
        "value": best["value"],
        "start": float(start.value[0]),
        "flexor": flexor.__version__,
    }
    BEST_KNOWN.write_text(json.dumps(table, indent=1) + "\n", encoding="utf-8")


def best_known(make: Callable[[str], Problem] = problem) -> dict[str, float]:
    """Evaluate the best known designs with this engine: the values of the feasible ones."""
    values = {}
    for name, entry in recorded().items():
        found = make(name).evaluate(np.array([entry["design"]]))
        if found.violation[0] == 0.0:
            values[name] = float(found.value[0])
    return values
