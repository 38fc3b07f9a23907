"""docs/finite-elements.md from the committed results."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from ..page import write_page
from . import moved_fibres, results
from .actuators import ACTUATORS, BULK, CAP, CONTACT, FIBRES, MESHES, SHEAR
from .results import Results


def deviation(found: Results, column: str) -> float | None:
    """Return the largest difference between the meshes over the largest value, or none."""
    if not set(MESHES) <= set(found):
        return None
    coarse, fine = results.common(found, column)
    largest = np.abs(fine).max(initial=0.0)
    return float(np.abs(coarse - fine).max() / largest) if largest > 1e-3 else None


def less(name: str, held_name: str) -> tuple[float, float]:
    """Return by how much [%] a chamber bends less than another.

    The least and the most over the pressures that both reached.
    """
    held, free = (results.read(key)["coarse"] for key in (held_name, name))
    _, i, j = np.intersect1d(held["pressure"], free["pressure"], return_indices=True)
    ratio = np.array(free["middle_angle"])[j] / np.array(held["middle_angle"])[i]
    return float(100.0 * (1.0 - ratio.max())), float(100.0 * (1.0 - ratio.min()))


def exponent(name: str) -> float:
    """Return d ln(angle)/d ln(pressure) between the first two states."""
    found = results.read(name)["coarse"]
    angles, pressures = (np.abs(found[key][:2]) for key in ("middle_angle", "pressure"))
    return float(np.log(angles[1] / angles[0]) / np.log(pressures[1] / pressures[0]))


def rods() -> dict[str, list[dict[str, float]]]:
    """Return what Flexor's rods do at the pressures of the finite elements."""
    from . import rod

    rows = {}
    for name in rod.NAMES:
        states = results.read(name).get("coarse", {"pressure": []})
        if states["pressure"]:
            actuator = ACTUATORS[name]
            found = rod.follow(rod.model(actuator), actuator, states["pressure"])
            rows[name] = [
                {"pressure": pressure}
                | {f"fe_{key}": states[key][i] for key in found}
                | {f"rod_{key}": values[i] for key, values in found.items()}
                for i, pressure in enumerate(states["pressure"])
            ]
    return rows


def half_round() -> list[dict[str, float]]:
    """Return angles of the half-round chamber [degrees] with fibres that stay and that move."""
    states, actuator = results.read("half-round")["coarse"], ACTUATORS["half-round"]
    return [
        {
            "pressure": pressure,
            "fe": found,
            "stay": moved_fibres.angle(actuator, pressure, moved=False),
            "move": moved_fibres.angle(actuator, pressure, moved=True),
        }
        for pressure, found in zip(states["pressure"], states["angle"], strict=True)
    ]


def write(page: Path) -> None:
    """Write the page."""
    found = {name: results.read(name) for name in ACTUATORS}
    write_page(
        Path(__file__).with_name("page.md.jinja"),
        page,
        actuators=ACTUATORS,
        results={name: meshes for name, meshes in found.items() if "coarse" in meshes},
        right_angle=results.pressure_at(found["half-round"], 90.0),
        less=less,
        exponent=exponent,
        rods=rods(),
        half_round=half_round(),
        deviation=deviation,
        constants={
            "shear": SHEAR,
            "bulk": BULK,
            "fibres": FIBRES,
            "contact": CONTACT,
            "cap": CAP,
        },
    )
