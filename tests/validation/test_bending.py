"""Closed form: a straight rod bent to a full circle."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from flexor.model import Model
from flexor.plot.style import shades

from .comparison import Comparison, compare
from .drawing import dots
from .report import Case
from .systems import build, rod, sample_points, vector

Array = NDArray[np.float64]
FAMILY = "Closed forms"
LENGTH, RADIUS, YOUNG = 0.1, 0.005, 1e6
EI = YOUNG * np.pi / 4.0 * RADIUS**4
FULL = 2.0 * np.pi * EI / LENGTH  # N m, closes the circle
PLANAR = ("bend_y", "extend_x", "shear_z")
SPATIAL = ("twist_x", "bend_y", "bend_z", "extend_x", "shear_y", "shear_z")
TURNS = np.array([0.0, 0.25, 0.5, 0.75, 1.0])


def _rod(modes: tuple[str, ...], **actuation: Any) -> Model:
    strain = dict.fromkeys(modes, "nodal_linear")
    body = rod(LENGTH, RADIUS, strain, young_modulus=YOUNG, elements=4, gauss_points=2)
    return build("circle", {"rod": body}, planar=modes == PLANAR, **actuation)


def _by_moment(modes: tuple[str, ...]) -> Model:
    moment = vector((0.0, FULL, 0.0), "N*m")
    wrench = {"body": "rod", "at": "tip", "moment": moment, "input": True}
    return _rod(modes, wrenches={"turns": wrench})


def _arc(points: Array, turns: float) -> Array:
    """Positions (x, z) along an arc that starts along x and turns towards -z."""
    angle = 2.0 * np.pi * turns * points
    chord = LENGTH * points * np.sinc(angle / (2.0 * np.pi))
    return np.stack([chord * np.cos(0.5 * angle), -chord * np.sin(0.5 * angle)], axis=1)


def _along(model: Model, q: Array) -> Array:
    found = model.engine.frames(model.parameters, q)
    return found[-len(sample_points(model, "rod")) :, :3, 3]


def _positions(label: str, model: Model, states: Array) -> Comparison:
    points = sample_points(model, "rod")
    wanted = np.stack([np.insert(_arc(points, turns), 1, 0.0, axis=1) for turns in TURNS])
    found = np.stack([_along(model, q) for q in states])
    return compare(f"{label}: positions / L", wanted / LENGTH, found / LENGTH, 1e-12, 1.0)


def test_full_circle(case: Case) -> None:
    """Pure bending to a full circle.

    A rod under a moment M at its tip bends to an arc of curvature κ = M/EI; at M = 2πEI/L it
    closes. The potential is −½ M² L/EI. Repeated with all six strains in space, and with a chamber
    at the distance S from the axis of an inextensible rod, where EI κ = u S.
    """
    plane = _by_moment(PLANAR)
    path = plane.equilibrium(TURNS)
    work = -0.5 * EI / LENGTH * (2.0 * np.pi * TURNS) ** 2
    comparisons = [
        _positions("moment, plane", plane, path.q),
        compare("moment, plane: potential [J]", work, path.energy, 1e-12),
    ]

    space = _by_moment(SPATIAL)
    # In space a moment has no potential; Flexor follows the equilibrium all the same.
    comparisons.append(_positions("moment, space", space, space.equilibrium(TURNS).q))

    chamber = {"kind": "chamber", "rod": "rod", "lever": 1.0}
    actuated = _rod(("bend_y",), actuators={"chamber": chamber})
    # EI κ = u S: the chamber's force times its distance from the axis.
    chambers = actuated.equilibrium(TURNS * FULL / RADIUS)
    comparisons.append(_positions("chamber", actuated, chambers.q))
    case.check(
        comparisons,
        lambda figure: _draw(figure, path.q, plane),
        "A rod under parts of the moment 2πEI/L: arcs of circles (lines) and Flexor (dots).",
    )


def _draw(figure: Figure, states: Array, model: Model) -> None:
    axes = figure.subplots()
    dense = np.linspace(0.0, 1.0, 200)
    for turns, q, colour in zip(TURNS, states, shades(len(TURNS)), strict=True):
        axes.plot(*(_arc(dense, turns) / LENGTH).T, color=colour, label=f"{turns:g}")
        found = _along(model, q) / LENGTH
        dots(axes, found[:, 0], found[:, 2])
    axes.set(xlabel="x / L", ylabel="z / L", aspect="equal")
    axes.legend(title="ML/2πEI", loc="center left", bbox_to_anchor=(1.0, 0.5))
