"""Output files of a calibration: constants to paste, a table, and a report in JSON."""

from __future__ import annotations

import json
import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from flexor.calibration.identifiability import Identifiability
from flexor.calibration.result import Calibration, Fit
from flexor.calibration.targets import BoundTarget
from flexor.errors import InputError, one_line
from flexor.store import csv_text, write_text

_ZERO = 1e-9  # relative to the target value
CONSTANTS, TARGETS, REPORT = "constants.toml", "targets.csv", "calibration.json"


@dataclass(frozen=True)
class Row:
    """One value of one target, in the unit in which it was written; NaN where there is none."""

    target: str
    weight: str
    force: float | None  # of the first input [N]; None for optima
    unit: str
    wanted: float
    found: float
    tolerance: float

    @property
    def off(self) -> float:
        """Deviation of the value found."""
        return self.found - self.wanted


def rows(fit: Fit) -> list[Row]:
    """Return every value of every target of a fit, in the order of the file."""
    made = []
    for target, values in zip(fit.problem.targets, fit.values, strict=True):
        forces: tuple[float | None, ...] = target.force or (None,) * len(target.value)
        for i, force in enumerate(forces):
            wanted, found, tolerance = (
                float(array[i]) / target.unit.factor
                for array in (target.value, values, target.tolerance)
            )
            if abs(found) < _ZERO * max(abs(wanted), tolerance):
                found = 0.0
            numbers = (wanted, found, tolerance)
            made.append(
                Row(target.table.name, target.table.weight, force, target.unit.text, *numbers)
            )
    return made


def write(calibration: Calibration, folder: Path, name: str) -> list[Path]:
    """Write constants (a variant `name`), table and report into a folder; return the files."""
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
    """Return the best constants as a variant called `name`, to paste into each model file."""
    best, identifiability = calibration.best, calibration.identifiability
    ranges = {
        constant.name: tuple(constant.shown(end, 4) for end in identifiability.interval(i))
        for i, constant in enumerate(identifiability.constants)
    }
    title = calibration.title or "Calibrated"
    lines = [f"# {one_line(title)}: fitted to {one_line(calibration.source)}."]
    blocks: dict[str, list[str]] = {}
    for model, system in best.problem.systems.items():
        block = []
        for field, constant in system.fields().items():
            value = constant.unit.shown(best.constants[constant.name], 9)
            text = json.dumps(value) if constant.unit.si else value
            low, high = ranges[constant.name]
            block.append(f"{field} = {text}  # 95 % confidence: {one_line(f'{low} to {high}')}")
        blocks.setdefault("\n".join(block), []).append(model)
    for block_text, models in blocks.items():
        lines += ["", f"# for {one_line(' and '.join(models))}", f"[variants.{name}]", block_text]
    return "\n".join(lines) + "\n"


def targets_csv(fit: Fit) -> str:
    """Return every value of every target as CSV."""
    lines = [["target", "weight", "force / N", "unit", "wanted", "found", "off", "tolerance"]]
    for row in rows(fit):
        numbers = (row.wanted, row.found, row.off, row.tolerance)
        lines.append(
            [
                row.target,
                row.weight,
                "" if row.force is None else f"{row.force:g}",
                row.unit,
                *("" if math.isnan(number) else f"{number:.9g}" for number in numbers),
            ]
        )
    return csv_text(lines)


def to_dict(calibration: Calibration) -> dict[str, Any]:
    """Return a calibration as plain values for JSON, SI units.

    ``combinations`` has the best identified first; ``starts`` is how many of them ended in a fit.
    """
    found = calibration.identifiability
    names = [constant.name for constant in found.constants]
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
                "confidence_interval": list(found.interval(i)),
                "range": [constant.low, constant.high],
                "verdict": found.verdict(i),
                "deviation_of_range": float(found.deviation[i]),
                "profile": _profile(found, i),
            }
            for i, constant in enumerate(found.constants)
        },
        "combinations": [
            {
                "description": found.describe(direction),
                "weights": dict(zip(names, direction.weights.tolist(), strict=True)),
                "deviation_of_ranges": direction.deviation,
            }
            for direction in found.directions
        ],
    }


def _profile(found: Identifiability, i: int) -> dict[str, Any] | None:
    if not found.profiles:
        return None
    value = found.constants[i].value(found.profiles[i].u)
    return {"value": value.tolist(), "rise": found.profiles[i].rise.tolist()}


def _fit(fit: Fit) -> dict[str, Any]:
    targets = zip(fit.problem.targets, fit.values, strict=True)
    return {
        "constants": fit.constants,
        "misfit": _plain(fit.misfit),
        "met": fit.met,
        "starts": fit.minimum.hits,
        "targets": [_target(target, values) for target, values in targets],
    }


def _target(target: BoundTarget, values: np.ndarray[Any, np.dtype[np.float64]]) -> dict[str, Any]:
    return {
        "name": target.table.name,
        "weight": target.table.weight,
        "force": list(target.force),
        "wanted": target.value.tolist(),
        "found": [_plain(value) for value in values.tolist()],
        "tolerance": [_plain(value) for value in target.tolerance.tolist()],
    }


def _plain(value: float) -> float | None:
    return value if math.isfinite(value) else None
