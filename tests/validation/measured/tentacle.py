"""A hanging tapered tentacle pulled by two tendons."""

from __future__ import annotations

from functools import cache

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray
from scipy.optimize import minimize_scalar
from scipy.spatial.transform import Rotation

from flexor.model import Model
from tests.validation.drawing import SERIES
from tests.validation.systems import build, rod, sample_points, si

from .measurement import Group, Measurement, read

Array = NDArray[np.float64]
SET = "soromox_tentacle"
LONG, SHORT = 0.305, 0.055
RADII = (0.01541, 0.00642, 0.0048)
DENSITY, LIGHT, POISSON, GRAVITY = 1318.0, 1070.0, 0.45, 9.81
ANGLES = np.radians([30.0, 150.0])
DISTANCE, RATE = 0.0114, 0.0295  # of the tendons from the axis at the base, and its fall per m
# Arc length and offset in the section's frame of each marker [m].
MARKERS = {
    "p1": (0.1291, (0.0, 0.0, 0.025)),
    "p2": (0.2195, (0.0, 0.0, -0.021)),
    "p3": (0.2800, (0.0, 0.0, 0.020)),
    "p4": (0.3600, (0.008, 0.0, 0.0)),
}
FITTED = tuple(f"m{i}_u{u}" for i in (1, 2) for u in ("01", "015", "02", "025"))


@cache
def tentacle(young: float, density: float = DENSITY) -> Model:
    """Build the tentacle: the tapered piece with the tendons, and the thin end beyond them."""
    modes = ("twist_x", "bend_y", "bend_z", "extend_x", "shear_y", "shear_z")
    strain = dict.fromkeys(modes, "nodal_quadratic")
    shared = {
        "young_modulus": young,
        "gauss_points": 3,
        "density": f"{density} kg/m^3",
        "poisson_ratio": POISSON,
    }
    down = {"rotation": {"y": "90 deg"}}
    bodies = {
        "long": rod(LONG, RADII[:2], strain, elements=10, placement=down, **shared),
        "short": rod(SHORT, RADII[1:], strain, elements=2, parent="long", **shared),
    }
    ends = np.array([DISTANCE, DISTANCE - RATE * LONG])
    tendons = {
        f"tendon{i}": {
            "kind": "cable",
            "rod": "long",
            "path": {
                "y": [si(value, "m") for value in ends * np.cos(angle)],
                "z": [si(value, "m") for value in ends * np.sin(angle)],
            },
        }
        for i, angle in enumerate(ANGLES, 1)
    }
    return build(
        "tentacle",
        bodies,
        planar=False,
        gravity=(0.0, 0.0, -GRAVITY),
        actuators=tendons,
    )


def markers(model: Model, tensions: tuple[float, float], steps: int = 4) -> Array:
    """Return the markers' places under tensions [N], (4, 3) [mm]."""
    ramp = np.linspace(0.0, 1.0, steps + 1)
    load = {f"tendon{i}": (tension * ramp).tolist() for i, tension in enumerate(tensions, 1)}
    path = model.equilibrium(load)
    assert path.converged.all()
    frames = path.frames(-1)
    arc = np.concatenate(
        [sample_points(model, "long") * LONG, LONG + sample_points(model, "short")[1:] * SHORT]
    )
    poses = np.concatenate([frames["long"], frames["short"][1:]])
    return (
        np.array([_place(arc, poses, s, np.array(offset)) for s, offset in MARKERS.values()]) * 1e3
    )


def _place(arc: Array, poses: Array, s: float, offset: Array) -> Array:
    """Place a marker between two sample points, by the circular arc between them."""
    at = min(int(np.searchsorted(arc, s)), len(arc) - 1)
    before, after = poses[at - 1], poses[at]
    share = (s - arc[at - 1]) / (arc[at] - arc[at - 1])
    turn = Rotation.from_matrix(before[:3, :3].T @ after[:3, :3]).as_rotvec()
    rotation = before[:3, :3] @ Rotation.from_rotvec(share * turn).as_matrix()
    chord = before[:3, 3] + share * (after[:3, 3] - before[:3, 3])
    # The arc leaves its chord by half of κ s (l - s).
    length = arc[at] - arc[at - 1]
    curvature = np.cross(rotation @ (turn / length), rotation[:, 0])
    chord = chord - 0.5 * share * (1.0 - share) * length**2 * curvature
    return chord + rotation @ offset


def measured() -> dict[str, tuple[tuple[float, float], Array]]:
    """Return tensions [N] and the markers' places (4, 3) [mm] by case."""
    cases: dict[str, tuple[tuple[float, float], Array]] = {}
    for row in read(SET, "markers_static.csv"):
        tensions = (float(row["tension1_N"]), float(row["tension2_N"]))
        _, places = cases.setdefault(row["case"], (tensions, np.full((4, 3), np.nan)))
        marker = list(MARKERS).index(row["marker"])
        places[marker] = [1e3 * float(row[f"{axis}_m"]) for axis in "XYZ"]
    return cases


def fitted_modulus(cases: dict[str, tuple[tuple[float, float], Array]], density: float) -> float:
    """Fit Young's modulus to the single-tendon cases."""

    def misfit(young: float) -> float:
        model = tentacle(float(young), density)
        return sum(
            float(np.sum((markers(model, cases[name][0]) - cases[name][1]) ** 2)) for name in FITTED
        )

    found = minimize_scalar(misfit, bounds=(1.5e5, 8e5), method="bounded", options={"xatol": 500.0})
    return float(found.x)


def run() -> Measurement:
    """Fit one modulus to eight loads and predict the others."""
    cases = measured()
    young = fitted_modulus(cases, DENSITY)
    model = tentacle(young)
    found = {name: markers(model, tensions) for name, (tensions, _) in cases.items()}
    distance = {
        name: np.linalg.norm(found[name] - places, axis=1) for name, (_, places) in cases.items()
    }
    moved = {
        name: np.linalg.norm(places - markers(model, (0.0, 0.0), 1), axis=1)
        for name, (_, places) in cases.items()
    }
    groups = []
    for label, chosen in (
        ("eight loads of one tendon", FITTED),
        ("other loads of one tendon", [n for n in cases if "m12" not in n and n not in FITTED]),
        ("both tendons", [name for name in cases if "m12" in name]),
    ):
        off = np.array([distance[name] for name in chosen])
        size = np.array([moved[name] for name in chosen])
        # The distance between the markers' measured and computed places.
        groups.append(Group(label, size, size + off, fitted=chosen == FITTED))
    by_marker = np.sqrt(np.mean([distance[name] ** 2 for name in FITTED], axis=0))
    other = fitted_modulus(cases, LIGHT)
    rows = [
        [
            name,
            f"{tensions[0]:.2f}",
            f"{tensions[1]:.2f}",
            "fitted" if name in FITTED else "",
            *(f"{value:.1f}" for value in distance[name]),
            " ".join(f"{value:.0f}" for value in places[3]),
            " ".join(f"{value:.0f}" for value in found[name][3]),
        ]
        for name, (tensions, places) in cases.items()
    ]

    def draw(figure: Figure) -> None:
        panels = figure.subplots(1, 2, sharey=True)
        for axes, (i, label) in zip(panels, ((0, "X / mm"), (1, "Y / mm")), strict=True):
            for name, (_, places) in cases.items():
                colour = SERIES[1] if "m12" in name else SERIES[0]
                axes.plot(places[:, i], places[:, 2], "o", color=colour, markersize=2.5)
                pairs = np.stack([places, found[name]])
                axes.plot(pairs[..., i], pairs[..., 2], color=colour, linewidth=0.6)
            axes.set(xlabel=label, aspect="equal")
        panels[0].set(ylabel="Z / mm")

    return Measurement(
        name="tentacle",
        title="Tapered tentacle with two tendons",
        about=(
            "A hanging silicone rod of 360 mm, 31 mm thick at the base and 10 mm at the tip, "
            "pulled by tendons at 30° and 150° that end 55 mm before the tip; four markers, 22 "
            "static loads of up to 7.7 N. SoRoMoX (MIT). E is fitted to eight loads of one "
            f"tendon; density ({DENSITY:.0f} kg/m³) and Poisson's ratio are the authors'. Tensions "
            "are motor torques over a pulley's radius, so friction is in them."
        ),
        groups=groups,
        verdict=(
            f"E = {young / 1e3:.0f} kPa ({other / 1e3:.0f} kPa if the density is {LIGHT:.0f} "
            "kg/m³). The deviations are distances, over how far the markers moved. On the eight "
            "loads the markers are off by "
            + ", ".join(f"{value:.0f}" for value in by_marker)
            + " mm (rms, p1 to p4), where the authors' own rod with two fitted constants "
            "leaves 11, 18, 19 and 36 mm; the fourteen others are predicted as well as these "
            "are fitted. The 10 mm of p1 are the same under all loads, so that its position "
            "along the rod, or the base, is probably not where the scripts have it. The two "
            "tendons are not mirror images in the measurement (p4 differs by 10 to 20 mm), but "
            "are in any model with equal tendons: friction in motors and guides, which is not "
            "measured, would do that."
        ),
        headings=(
            "case",
            "T1 / N",
            "T2 / N",
            "",
            "p1 / mm",
            "p2 / mm",
            "p3 / mm",
            "p4 / mm",
            "p4 measured",
            "p4 computed",
        ),
        rows=rows,
        draw=draw,
        caption="Measured places of the markers (dots), and lines to the computed ones: one tendon "
        "blue, both orange.",
        panels=2,
    )
