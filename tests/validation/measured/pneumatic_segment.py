"""A segment of a pneumatic silicone arm with one chamber under pressure."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray
from scipy.optimize import minimize_scalar

from flexor.materials.library import find
from flexor.model import Model
from tests.validation.drawing import SERIES
from tests.validation.systems import build, rod, si

from .measurement import Group, Measurement, read

Array = NDArray[np.float64]
SET = "pneumatic_arm_segment"
LENGTH, HALF, DENSITY, GRAVITY = 0.1, 0.0222, 1070.0, 9.81
LEVER = 0.014  # of the chamber from the axis [m], between the hole (7.5 mm) and the surface
FITTED = 200.0  # mbar, and below


def segment() -> Model:
    """Build the hanging segment; the chamber's load is pressure times its area."""
    young = find("dragon-skin-10-linear").young_modulus
    body = rod(
        LENGTH,
        HALF,
        {"bend_y": "nodal_quadratic", "extend_x": "nodal_quadratic"},
        young_modulus=young,
        elements=8,
        gauss_points=3,
        section={"kind": "rectangular", "ratio": 1.0},
        density=f"{DENSITY} kg/m^3",
        placement={"rotation": {"y": "90 deg"}},
    )
    chamber = {"kind": "chamber", "rod": "rod", "path": {"z": si(LEVER, "m")}}
    return build(
        "segment", {"rod": body}, gravity=(0.0, 0.0, -GRAVITY), actuators={"chamber": chamber}
    )


def bending(model: Model, pressure: Array, area: float) -> Array:
    """Return tilt [°] and lateral and axial displacement [mm] at pressures [Pa], (n, 3)."""
    path = model.equilibrium([0.0, *(pressure * area)])
    assert path.converged.all()
    tips = np.array([path.frames(step)["rod"][-1] for step in range(len(path))])
    tilt = np.degrees(np.arctan2(np.abs(tips[:, 0, 0]), -tips[:, 2, 0]))
    lateral = 1e3 * np.abs(tips[:, 0, 3] - tips[0, 0, 3])
    axial = 1e3 * (tips[0, 2, 3] - tips[:, 2, 3])
    return np.stack([tilt, lateral, axial], axis=1)[1:]


def run() -> Measurement:
    """Fit the chamber's area to 100 to 200 mbar, and predict the rest."""
    table = read(SET, "static_summary.csv")
    mbar = np.array([float(row["pressure_mbar"]) for row in table])
    keys = ("early_tilt_deg", "early_d_lat1_mm", "early_d_axial_mm")
    measured = np.array([[float(row[key]) for key in keys] for row in table]) * [1.0, -1.0, 1.0]
    model, fitted = segment(), mbar <= FITTED

    def misfit(area: float) -> float:
        tilt = bending(model, 100.0 * mbar[fitted], area)[:, 0]
        return float(np.sum((tilt / measured[fitted, 0] - 1.0) ** 2))

    area = float(minimize_scalar(misfit, bounds=(1e-6, 2e-3), method="bounded").x)
    found = bending(model, 100.0 * mbar, area)
    below, above = ~fitted & (mbar <= 300.0), mbar > 300.0
    groups = [
        Group(f"{name}: {label}", measured[chosen, i], found[chosen, i], unit, chosen is fitted)
        for i, (name, unit) in enumerate((("tilt", "°"), ("lateral", "mm")))
        for label, chosen in (
            ("100 to 200 mbar", fitted),
            ("250 and 300 mbar", below),
            ("350 to 450 mbar", above),
        )
    ]

    def draw(figure: Figure) -> None:
        axes = figure.subplots()
        for i, (label, colour) in enumerate(
            zip(("tilt / °", "lateral / mm"), SERIES, strict=False)
        ):
            axes.plot(mbar, found[:, i], color=colour, label=label)
            axes.plot(mbar, measured[:, i], "o", color=colour, markersize=3.0)
        axes.set(xlabel="pressure / mbar", ylim=(0.0, None))
        axes.legend()

    return Measurement(
        name="pneumatic-segment",
        title="Pneumatic arm segment",
        about=(
            "A segment of Dragon Skin 10, 100 mm long and 44.4 mm wide, hanging, with one "
            "chamber at 100 to 450 mbar; tilt and displacement of the tip 0.6 s after the "
            "onset. Dubied et al. (`dubied2022`), arXiv 2201.12560 (MIT). The chamber's shape "
            "is not published: the model is a linear solid square rod with a chamber line 14 mm "
            "off the axis, whose area is fitted to the tilt at 100 to 200 mbar "
            f"({1e6 * area:.0f} mm²)."
        ),
        groups=groups,
        verdict=(
            "The measured tilt grows faster than the pressure from the first step on (2.8° at 100 "
            "mbar, 7.2° at 200, 60° at 450): the unreinforced walls balloon, which enlarges the "
            "chamber and thins its walls. A section that keeps its shape has no such effect. The "
            "model fails above the pressures that it was fitted to, and should not be used for "
            "chambers without winding."
        ),
        headings=(
            "pressure / mbar",
            "tilt / ° measured / computed",
            "lateral / mm",
            "axial / mm",
        ),
        rows=[
            [f"{p:.0f}", *(f"{m:.1f} / {f:.1f}" for m, f in zip(*pair, strict=True))]
            for p, *pair in zip(mbar, measured, found, strict=True)
        ],
        draw=draw,
        caption="Measured (dots) and computed (lines).",
    )
