"""What a calibration leaves behind: constants to paste, a table, a report for programs."""

from __future__ import annotations

import csv
import io
import json
import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from flexor.calibration.calibration import Calibration, Fit
from flexor.calibration.goal import Goal
from flexor.calibration.knowledge import Knowledge
from flexor.errors import InputError
from flexor.store import write_text

_NOTHING = 1e-9  # of what was wanted
CONSTANTS, TARGETS, REPORT = "constants.toml", "targets.csv", "calibration.json"


@dataclass(frozen=True)
class Row:
    """One value of one target, in the unit in which it was written.

    Attributes
    ----------
    target : str
        Name of the target.
    weight : str
        ``"hard"``, ``"soft"`` or ``"held-out"``.
    force : float or None
        Force of the first input [N]; None for optima.
    unit : str
        Unit of the numbers.
    wanted, found, tolerance : float
        NaN where there is none.
    """

    target: str
    weight: str
    force: float | None
    unit: str
    wanted: float
    found: float
    tolerance: float

    @property
    def off(self) -> float:
        """How far the value found is off."""
        return self.found - self.wanted


def rows(fit: Fit) -> list[Row]:
    """Return every value of every target of a fit, in the order of the file."""
    made = []
    for goal, values in zip(fit.variant.goals, fit.values, strict=True):
        forces: tuple[float | None, ...] = goal.force or (None,) * len(goal.value)
        for i, force in enumerate(forces):
            wanted, found, tolerance = (
                float(array[i]) / goal.unit.factor for array in (goal.value, values, goal.tolerance)
            )
            if abs(found) < _NOTHING * max(abs(wanted), tolerance):
                found = 0.0
            made.append(
                Row(
                    goal.target.name,
                    goal.target.weight,
                    force,
                    goal.unit.text,
                    wanted,
                    found,
                    tolerance,
                )
            )
    return made


def write(calibration: Calibration, folder: Path, name: str) -> list[Path]:
    """Write constants, table and report into a folder.

    Parameters
    ----------
    calibration
        What was found.
    folder
        Where to.
    name
        What to call the set of constants.

    Returns
    -------
    list of Path
        The files.

    Raises
    ------
    InputError
        If one cannot be written.
    """
    texts = {
        CONSTANTS: constants_toml(calibration, name),
        TARGETS: targets_csv(calibration.best),
        REPORT: json.dumps(to_dict(calibration), indent=2, allow_nan=False) + "\n",
    }
    try:
        for file, text in texts.items():
            write_text(folder / file, text)
    except OSError as error:
        why = (error.strerror or str(error)).lower()
        raise InputError(f'cannot write into "{folder}": {why}.') from error
    return [folder / file for file in texts]


def constants_toml(calibration: Calibration, name: str) -> str:
    """Return the best constants as a set to paste into each model file.

    Parameters
    ----------
    calibration
        What was found.
    name
        What to call the set.
    """
    best, known = calibration.best, calibration.knowledge
    ranges = {
        constant.name: tuple(constant.shown(end, 4) for end in known.interval(i))
        for i, constant in enumerate(known.constants)
    }
    lines = [f"# {calibration.title or 'Calibrated'}: fitted to {calibration.source}."]
    if best.variant.name:
        lines.append(f"# With {best.variant.name}.")
    blocks: dict[str, list[str]] = {}
    for model, system in best.variant.systems.items():
        block = []
        for field, constant in system.fields().items():
            value = constant.unit.shown(best.constants[constant.name], 9)
            text = f'"{value}"' if constant.unit.si else value
            low, high = ranges.get(constant.name, ("", ""))
            remark = f"{low} to {high} with 95 % likelihood" if low else "held"
            block.append(f"{field} = {text}  # {remark}")
        blocks.setdefault("\n".join(block), []).append(model)
    for block_text, models in blocks.items():
        lines += ["", f"# for {' and '.join(models)}", f"[constants.{name}]", block_text]
    return "\n".join(lines) + "\n"


def targets_csv(fit: Fit) -> str:
    """Return every value of every target as CSV."""
    out = io.StringIO()
    table = csv.writer(out, lineterminator="\n")
    table.writerow(["target", "weight", "force / N", "unit", "wanted", "found", "off", "tolerance"])
    for row in rows(fit):
        numbers = (row.wanted, row.found, row.off, row.tolerance)
        table.writerow(
            [
                row.target,
                row.weight,
                "" if row.force is None else f"{row.force:g}",
                row.unit,
                *("" if math.isnan(number) else f"{number:.9g}" for number in numbers),
            ]
        )
    return out.getvalue()


def to_dict(calibration: Calibration) -> dict[str, Any]:
    """Return what a calibration found as plain values for JSON; SI units.

    Returns
    -------
    dict
        ``fits`` (each with ``options``, ``constants``, ``misfit``, ``met``, ``starts`` that ended
        there and ``targets``), ``constants`` (what is known of each), ``combinations`` (the best
        known first) and how it was done.
    """
    known = calibration.knowledge
    return {
        "title": calibration.title,
        "targets": calibration.source,
        "seed": calibration.seed,
        "evaluations": calibration.evaluations,
        "met": calibration.best.met,
        "fits": [_fit(fit) for fit in calibration.fits],
        "constants": {
            constant.name: {
                "value": calibration.best.constants[constant.name],
                "likely": list(known.interval(i)),
                "range": [constant.low, constant.high],
                "verdict": known.verdict(i),
                "deviation_of_range": float(known.deviation[i]),
                "profile": _profile(known, i),
            }
            for i, constant in enumerate(known.constants)
        },
        "combinations": [
            {
                "known": known.told(direction),
                "weights": dict(
                    zip(
                        (constant.name for constant in known.constants),
                        direction.weights.tolist(),
                        strict=True,
                    )
                ),
                "deviation_of_ranges": direction.deviation,
            }
            for direction in known.directions
        ],
    }


def _profile(known: Knowledge, i: int) -> dict[str, Any] | None:
    if not known.profiles:
        return None
    value = known.constants[i].value(known.profiles[i].u)
    return {"value": value.tolist(), "rise": known.profiles[i].rise.tolist()}


def _fit(fit: Fit) -> dict[str, Any]:
    goals = zip(fit.variant.goals, fit.values, strict=True)
    return {
        "options": dict(fit.variant.options),
        "constants": fit.constants,
        "misfit": _plain(fit.misfit),
        "met": fit.met,
        "starts": fit.minimum.hits,
        "targets": [_target(goal, values) for goal, values in goals],
    }


def _target(goal: Goal, values: np.ndarray[Any, np.dtype[np.float64]]) -> dict[str, Any]:
    return {
        "name": goal.target.name,
        "weight": goal.target.weight,
        "force": list(goal.force),
        "wanted": goal.value.tolist(),
        "found": [_plain(value) for value in values.tolist()],
        "tolerance": [_plain(value) for value in goal.tolerance.tolist()],
    }


def _plain(value: float) -> float | None:
    return value if math.isfinite(value) else None
