"""The paper's toolbox: residuals, poses and equilibria computed with SoRoSim."""

from __future__ import annotations

import csv
import json
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from flexor.model import Model

from .comparison import Comparison, compare, verdict
from .drawing import SERIES, dots
from .report import Case
from .systems import build, link, rod, si

Array = NDArray[np.float64]
FAMILY = "The toolbox of the paper"
FOLDER = Path(__file__).resolve().parents[1] / "reference"
# Length, radii and joint stiffness of each link; the last is fixed.
LINKS = (
    ("ph_1", 0.045, (0.0216, 0.0139), 0.04),
    ("ph_2", 0.0253, (0.0139, 0.0102), 0.03),
    ("ph_3", 0.0236, (0.0102, 0.0087), 0.02),
    ("tip", 0.001, (0.0087, 0.008), None),
)


def finger() -> Model:
    """Build the finger and exosuit of the reference: no limits, k = 1000 N/m, E = 1 MPa."""
    bodies = {
        "exosuit": rod(
            *(0.1, (0.0116, 0.008), dict.fromkeys(("bend_y", "extend_x"), "nodal_linear")),
            elements=10,
            gauss_points=3,
            placement={"z": "3.32 cm"},
        )
    }
    parent: dict[str, object] = {}
    for name, length, radii, stiffness in LINKS:
        fixed = {"kind": "fixed"}
        hinge = {"kind": "revolute", "axis": "y", "stiffness": si(stiffness or 0.0, "N*m/rad")}
        bodies[name] = link(length, radii, joint=hinge if stiffness else fixed, **parent)
        parent = {"parent": name}
    names = [name for name, *_ in LINKS]
    return build(
        "toolbox-finger",
        bodies,
        spheres={"exosuit": {"bodies": ["exosuit"]}, "finger": {"bodies": names}},
        contacts={"skin": {"first": "exosuit", "second": "finger", "stiffness": "1000 N/m"}},
        actuators={"chamber": {"kind": "chamber", "rod": "exosuit", "lever": 1.0}},
    )


def arm() -> Model:
    """Build the spatial rod of the reference: six modes, a tendon that winds about it, gravity."""
    modes = ("twist_x", "bend_y", "bend_z", "extend_x", "shear_y", "shear_z")
    body = rod(
        *(0.25, (0.012, 0.006), dict.fromkeys(modes, "nodal_quadratic")),
        young_modulus=2e5,
        density="1 g/cm^3",
        elements=3,
        gauss_points=4,
    )
    path = {"radius": "4 mm", "turn": "2 rad"}
    tendon = {"kind": "cable", "rod": "arm", "path": path}
    gravity = (0.0, 0.0, -9.81)
    return build(
        "toolbox-arm", {"arm": body}, planar=False, gravity=gravity, actuators={"tendon": tendon}
    )


def _states(model: Model, body: str, file: str, sign: float, tolerance: float) -> list[Comparison]:
    """Compare residuals, and the pose of the rod's tip, at given states."""
    reference: dict[str, Any] = json.loads((FOLDER / file).read_text(encoding="utf-8"))
    states, inputs = np.array(reference["q"]), sign * np.array(reference["u"])
    wanted = np.array(reference["residual"])
    engine, p = model.engine, model.parameters
    found = np.stack([engine.residual(p, q, u) for q, u in zip(states, inputs, strict=True)])
    # Each state is measured by its own largest residual: they differ by decades.
    size = np.max(np.abs(wanted), axis=1, keepdims=True)
    tip = engine.frame_names().index(f"{body}[{model.file.rod(body).sample_count - 1}]")
    poses = np.stack([engine.frames(p, q)[tip, :3] for q in states])
    columns = np.array(reference["rod_tip_g_colmajor3x4"]).reshape(-1, 4, 3).transpose(0, 2, 1)
    comparisons = [
        compare("residual / its largest entry", wanted / size, found / size, tolerance, 1.0),
        compare("pose of the rod's tip (R, r [m])", columns, poses, 1e-10, 1.0),
    ]
    if "touching_pairs" in reference:
        pairs = np.array(reference["touching_pairs"]).ravel()
        ours = np.array([len(engine.contacts(p, q)["depth"]) for q in states])
        free = pairs == 0
        comparisons += [
            compare("touching pairs of spheres", pairs, ours, 0.0, 1.0),
            compare(
                "residual without contact", (wanted / size)[free], (found / size)[free], 1e-9, 1.0
            ),
        ]
    return comparisons


def test_toolbox_finger(case: Case) -> None:
    """Residuals of finger and exosuit.

    Residual of (9), tip pose and touching pairs at twelve states of the paper's planar model with
    25 degrees of freedom, from the public MATLAB toolbox SoRoSim under GNU Octave. SoRoSim's
    `Equilibrium` truncates the exponential after Ω̂³/6 where θ ≤ 0.01 (its forward kinematics does
    not), which changes its residuals in contact by up to 4·10⁻⁸ of the largest; Flexor's
    exponential is exact. With the same truncation they agree to 10⁻⁹
    (`engine/tests/engine/toolbox_reference.rs`).
    """
    case.check(tuple(_states(finger(), "exosuit", "sorosim_finger.json", 1.0, 1e-7)))


def test_toolbox_arm(case: Case) -> None:
    """Residuals of a spatial rod.

    The same for a tapered rod with six quadratic strain modes, a helical tendon and gravity, at
    six states.
    """
    case.check(tuple(_states(arm(), "arm", "sorosim_spatial.json", -1.0, 1e-9)))


def test_toolbox_path(case: Case) -> None:
    """Equilibria of finger and exosuit.

    Joint angles of the default design from 0 to 5 N, found by SoRoSim with `fsolve`.
    """
    with (FOLDER / "sorosim_static.csv").open(encoding="utf-8") as lines:
        rows = list(csv.DictReader(lines))
    forces = np.array([float(row["u"]) for row in rows])
    wanted = np.array([[float(row[f"th{i}"]) for i in (1, 2, 3)] for row in rows])
    path = finger().equilibrium(forces)
    case.check(
        (
            compare("joint angles [rad]", wanted, path.joint_angles, 1e-7),
            verdict("events on the way", "none", str(len(path.events)) if path.events else "none"),
        ),
        lambda figure: _draw(figure, forces, wanted, path.joint_angles),
        "Joint angles of the default design: SoRoSim (lines) and Flexor (dots).",
    )


def _draw(figure: Figure, forces: Array, wanted: Array, found: Array) -> None:
    axes = figure.subplots()
    for i, name in enumerate(("first", "second", "third")):
        axes.plot(forces, wanted[:, i], color=SERIES[i], label=f"{name} joint")
        dots(axes, forces, found[:, i])
    axes.set(xlabel="force / N", ylabel="angle / rad")
    axes.legend()
