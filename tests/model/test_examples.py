"""The examples that come with Flexor, against what their files say of them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from flexor.inverse import reach
from flexor.model import load, presets

DOCS = Path(__file__).parents[2] / "docs"


@pytest.mark.parametrize("name", presets())
def test_it_is_in_the_gallery_and_reaches_its_loads(name: str) -> None:
    page = (DOCS / "gallery.md").read_text(encoding="utf-8")
    assert f"\n## {name}\n" in page
    assert (DOCS / "images" / "gallery" / f"{name}.png").is_file()
    path = load(name).equilibrium()
    assert path.converged.all()
    assert path.stable.all()


def test_wound_tube() -> None:
    found = reach(load("wound-tube"), "strain = 0.2")
    assert found.loads["chamber"] == pytest.approx(76.26e3, rel=1e-4)


def test_column_buckles_at_its_critical_load() -> None:
    (event,) = load("column").equilibrium().events
    assert event.kind == "bifurcation"
    bending = 160e3 * np.pi * 0.01**4 / 4.0
    assert event.force == pytest.approx(np.pi**2 * bending / (4.0 * 0.16**2), rel=1e-3)


def test_truss_snaps_at_the_largest_force() -> None:
    (event,) = load("truss").equilibrium().events
    height = np.linspace(0.0, 0.02, 20_001)
    length = np.hypot(0.1, height)
    force = 2e3 * (np.hypot(0.1, 0.02) - length) * height / length
    assert event.kind == "snap"
    assert event.force == pytest.approx(force.max(), rel=1e-4)


def test_chambers_bend_their_own_half() -> None:
    model = load("two-chambers")
    turned = {}
    for chamber in ("proximal", "distal"):
        frames = model.equilibrium({chamber: ["0 kPa", "40 kPa"]}).frames(-1)["actuator"]
        turns = np.arctan2(-frames[:, 2, 0], frames[:, 0, 0])
        middle = len(turns) // 2
        turned[chamber] = (turns[middle], turns[-1] - turns[middle])
    # The node between them belongs to both halves.
    assert turned["proximal"][0] > 0.5 > 20.0 * abs(turned["proximal"][1])
    assert turned["distal"][1] > 0.5 > 20.0 * abs(turned["distal"][0])


def test_a_syringe_needs_pressure() -> None:
    pressure = load("syringe-actuator").equilibrium().found_loads()["syringe"]
    assert (np.diff(pressure) > 0.0).all()


def test_the_plate_feels_the_actuator() -> None:
    force = load("load-cell").equilibrium().obstacle_forces()["plate"]
    assert (np.diff(force) > 0.0).all()


def test_a_finger_grasps_a_cylinder() -> None:
    """The more pressure, the more force; all of it acts across the surface of the cylinder."""
    model = load("grasp")
    path = model.equilibrium()
    assert path.stable.all()
    force = path.obstacle_forces()["cylinder"]
    assert force[0] == 0.0
    assert (np.diff(force[1:]) > 0.0).all()
    found = path.contact_forces(-1)
    held = found.second < 0
    bar = model.file.obstacles["cylinder"]
    outward = found.point[held] - bar.point.components
    outward /= np.linalg.norm(outward, axis=1)[:, None]
    along = np.einsum("ij,ij->i", found.force[held], outward)
    np.testing.assert_allclose(along, np.linalg.norm(found.force[held], axis=1), rtol=1e-9)
    assert along.sum() == pytest.approx(force[-1], rel=1e-9)
    # It holds the finger back.
    free = load("grasp", changes={"cylinder.point.z": "-30 cm"}).equilibrium()
    assert path.joint_angles[-1].sum() < 0.9 * free.joint_angles[-1].sum()


def test_a_tendon_driven_finger_holds_a_can() -> None:
    """Cables flex and extend all joints; what friction holds does not slide as the pull grows."""
    path = load("tendon-glove").equilibrium()
    arms = path.moment_arms()
    assert all((arm > 0.0).all() for arm in arms["flexor"].values())
    assert all((arm < 0.0).all() for arm in arms["extensor"].values())
    force = path.obstacle_forces()["can"]
    assert (np.diff(force) > 0.0).all()
    assert not path.friction_forces(-1).slides.any()
    # Without friction the can pushes the knuckle back to its limit.
    smooth = load("tendon-glove", changes={"can.friction": 0.0}).equilibrium()
    assert np.degrees(smooth.joint_angles[-1, 0]) < -10.0 < np.degrees(path.joint_angles[-1, 0])
