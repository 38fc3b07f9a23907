"""A continuum robot with a helical tendon, shortened by a spool."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from flexor.model import Model
from tests.validation.drawing import SERIES
from tests.validation.systems import build, rod, sample_points, vector

from .measurement import Group, Measurement

Array = NDArray[np.float64]
LENGTH, ROD, TENDON, TURN = 0.245, 0.002, 0.021, 120.0
YOUNG, SHEAR, DENSITY, DISC = 2.31e9, 0.849e9, 735.0, 0.0075
CABLE = 109e9 * np.pi / 4.0 * 0.17e-3**2  # EA [N]
COMMAND = 7.5  # mm
# Size of the tip's lateral displacement after each tenth of the command, mean of two runs [mm].
MEASURED = np.array([2.0, 5.2, 8.4, 11.6, 14.8, 18.1, 21.4, 24.5, 27.8, 30.9])
ORIENTATIONS = {"without gravity": 0.0, "hanging": -9.81, "upright": 9.81}


def robot(gravity: float) -> Model:
    """Build the robot along -z, with its discs as weights."""
    modes = ("twist_x", "bend_y", "bend_z", "extend_x", "shear_y", "shear_z")
    body = rod(
        LENGTH,
        ROD,
        dict.fromkeys(modes, "nodal_quadratic"),
        young_modulus=YOUNG,
        elements=9,
        gauss_points=3,
        poisson_ratio=YOUNG / (2.0 * SHEAR) - 1.0,
        density=f"{DENSITY} kg/m^3",
        placement={"rotation": {"y": "90 deg"}},
    )
    weights = {
        f"disc{i}": {
            "body": "rod",
            "at": i / 3.0,
            "force": vector((0.0, 0.0, DISC * gravity or 1e-12), "N"),
        }
        for i in (1, 2, 3)
    }
    tendon = {
        "kind": "cable",
        "rod": "rod",
        "path": {"radius": f"{TENDON} m", "turn": f"{TURN} deg"},
    }
    return build(
        "robot",
        {"rod": body},
        planar=False,
        gravity=(0.0, 0.0, gravity),
        wrenches=weights,
        actuators={"tendon": tendon},
    )


def displacement(model: Model, shortening: Array) -> Array:
    """Return the size of the tip's lateral displacement at shortenings of the tendon [mm]."""
    tensions = np.linspace(0.0, 8.0, 41)
    path = model.equilibrium(tensions.tolist())
    assert path.converged.all()
    angle = np.radians(TURN) * sample_points(model, "rod")
    ring = TENDON * np.stack([0.0 * angle, np.cos(angle), np.sin(angle)], axis=1)
    lengths, tips = [], []
    for step in range(len(path)):
        frames = path.frames(step)["rod"]
        line = frames[:, :3, 3] + np.einsum("pij,pj->pi", frames[:, :3, :3], ring)
        lengths.append(np.linalg.norm(np.diff(line, axis=0), axis=1).sum())
        tips.append(frames[-1, :2, 3])
    pulled = 1e3 * (lengths[0] - np.array(lengths) + tensions * lengths[0] / CABLE)
    moved = 1e3 * np.linalg.norm(np.array(tips) - tips[0], axis=1)
    assert pulled[-1] > shortening[-1]
    return np.interp(shortening, pulled, moved)


def run() -> Measurement:
    """Predict the tip's displacement from the commanded length."""
    shortening = COMMAND * np.arange(1, 11) / 10.0
    found = {
        name: displacement(robot(gravity), shortening) for name, gravity in ORIENTATIONS.items()
    }

    def draw(figure: Figure) -> None:
        axes = figure.subplots()
        for (name, values), colour in zip(found.items(), SERIES, strict=False):
            axes.plot(shortening, values, color=colour, label=name)
        axes.plot(shortening, MEASURED, "ko", markersize=3.0, label="measured")
        axes.set(xlabel="shortening of the tendon / mm", ylabel="displacement of the tip / mm")
        axes.legend()

    return Measurement(
        name="helical-robot",
        title="Robot with a helical tendon",
        about=(
            "A PLA rod, 4 mm thick and 245 mm long, with three discs that lead a tendon on a "
            "helix of radius 21 mm, turning by 120° from base to tip. A spool shortens the tendon "
            "by up to 7.5 mm. Bachelor project at Aarhus University, 2026, *A Quantitative "
            "Comparison of Analytical Models for Helical Tendon Driven Continuum Robots* "
            "(github.com/rasdm); its pictures are under the Apache licence, and only "
            "displacements read from them stand here. Moduli are the authors', **no number is "
            "fitted**. Whether the robot hung or stood is not stated."
        ),
        groups=[Group(name, MEASURED, values) for name, values in found.items()],
        verdict=(
            "Predicted displacements are 14 to 23 % above the measured at the full command, and "
            "more at the first steps, where the tendon is slack. The model has one tendon: the "
            "command also pays out the other two, by less than bending lengthens them, so that "
            "they pull back; and it follows the helix, where the real one is straight between "
            "discs. Friction at the discs (the authors assume a coefficient of 0.2) is missing "
            "too. Which of these matters cannot be told without tensions and the robot's "
            "orientation."
        ),
        headings=("shortening / mm", "measured / mm", *(f"{name} / mm" for name in found)),
        rows=[
            [f"{x:.2f}", f"{m:.1f}", *(f"{values[i]:.1f}" for values in found.values())]
            for i, (x, m) in enumerate(zip(shortening, MEASURED, strict=True))
        ],
        draw=draw,
        caption="Lateral displacement of the tip: measured (dots) and computed.",
    )
