"""The committed results: one TOML file an actuator, with the values of two meshes."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from dataclasses import asdict, fields
from pathlib import Path
from typing import Any

import numpy as np
import tomli_w
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from .actuators import ACTUATORS, BARS, BULK, CAP, CONTACT, FIBRES, MESHES, SHEAR, Actuator
from .states import State

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

FOLDER = Path(__file__).parent / "results"
COLUMNS = [entry.name for entry in fields(State)]
DIGITS = 7

Results = dict[str, Any]


def settings(actuator: Actuator) -> Results:
    """Return what the results of an actuator depend on."""
    given = {key: value for key, value in asdict(actuator).items() if value is not None}
    del given["about"]
    given["pressures"] = list(given["pressures"])
    given["sizes"] = list(given["sizes"])
    return {
        **given,
        "cap": CAP,
        "shear_modulus_MPa": SHEAR,
        "bulk_modulus_MPa": BULK,
        "fibres_N_per_mm": FIBRES,
        "bars_N": BARS,
        "contact_N_per_mm": CONTACT,
        "meshes": {name: asdict(fineness) for name, fineness in MESHES.items()},
    }


def read(name: str) -> Results:
    """Return the results of an actuator; empty if there are none for its present settings."""
    file = FOLDER / f"{name}.toml"
    if not file.exists():
        return {}
    found = tomllib.loads(file.read_text(encoding="utf-8"))
    return found if found.pop("settings") == settings(ACTUATORS[name]) else {}


def write(name: str, meshes: Results) -> None:
    """Write the results of an actuator."""
    FOLDER.mkdir(exist_ok=True)
    content = {"settings": settings(ACTUATORS[name]), **meshes}
    (FOLDER / f"{name}.toml").write_text(tomli_w.dumps(content), encoding="utf-8")


def table(states: Sequence[State]) -> dict[str, list[float]]:
    """Return states as columns."""
    return {
        name: [float(f"{getattr(state, name):.{DIGITS}g}") for state in states] for name in COLUMNS
    }


def common(results: Results, column: str) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the coarse and the fine values of a column at the pressures that both reached."""
    coarse, fine = (results[mesh] for mesh in MESHES)
    _, first, second = np.intersect1d(coarse["pressure"], fine["pressure"], return_indices=True)
    return np.array(coarse[column])[first], np.array(fine[column])[second]


def pressure_at(results: Results, angle: float) -> float:
    """Return the pressure [kPa] of a `middle_angle` [°], by a cubic spline through the states."""
    found = results["coarse"]
    return float(CubicSpline([0.0, *found["middle_angle"]], [0.0, *found["pressure"]])(angle))
