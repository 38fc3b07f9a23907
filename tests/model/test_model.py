"""Models, paths and batches on the engine."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import pytest
from numpy.typing import NDArray

import flexor
from flexor import _engine
from flexor.errors import InputError
from flexor.model import Model, Path, parse

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Taper:
    """Straight exosuits, written here anew: length, radius, slope as the model wants them."""

    length: Array
    radius: Array
    slope: Array


def tapers(model: Model, *designs: tuple[float, float, float]) -> Taper:
    L, R0, R1 = np.array(designs).T
    X = model.X
    return Taper(L, R0[:, None] + X * (R1 - R0)[:, None], np.repeat((R1 - R0)[:, None], len(X), 1))


@pytest.fixture(scope="module")
def finger() -> Model:
    return flexor.load("finger", "calibrated")


@pytest.fixture(scope="module")
def path(finger: Model) -> Path:
    return finger.equilibrium(force="0:5:1")


def test_finger_has_the_papers_counts(finger: Model) -> None:
    assert finger.dof == 25
    assert finger.planar
    assert finger.joints == ("ph_1.theta", "ph_2.theta", "ph_3.theta")
    assert finger.inputs == ("chamber",)
    assert finger.rods == ("exosuit",)
    assert finger.sphere_groups == {"exosuit": 42, "finger": 8}
    assert finger.first_spheres == 42
    assert len(finger.X) == 41


def test_design_space(finger: Model) -> None:
    space = finger.design
    assert (space.rod, space.length, space.radius_base) == ("exosuit", 0.1, 0.0116)
    assert space.radius_tip == pytest.approx(0.008, rel=1e-15)
    assert space.length_bounds == (0.06, 0.14)
    assert space.radius_bounds == (0.004, 0.012)
    assert space.minimum_radius == 0.005
    assert finger.evaluation_loads[:, 0].tolist() == [0.0, 1.0, 2.0, 3.0, 4.0, 5.0]


def test_sample_points_are_the_ones_the_description_used(finger: Model) -> None:
    gauss = np.polynomial.legendre.leggauss(3)[0] / 2.0 + 0.5
    expected = [0.0] + [(e + x) / 10 for e in range(10) for x in (*gauss, 1.0)]
    np.testing.assert_allclose(finger.X, expected, atol=1e-15)
    np.testing.assert_allclose(
        finger.slot("exosuit.radius"), 0.0116 - 0.0036 * finger.X, rtol=1e-14
    )


def test_rest(finger: Model, path: Path) -> None:
    assert path.force.tolist() == [0.0, 1.0, 2.0, 3.0, 4.0, 5.0]
    np.testing.assert_allclose(path.q[0], 0.0, atol=1e-12)
    frames = path.frames(0)
    assert list(frames) == ["exosuit", "ph_1", "ph_2", "ph_3", "tip"]
    np.testing.assert_allclose(frames["exosuit"][:, 0, 3], 0.1 * finger.X, atol=1e-14)
    np.testing.assert_allclose(frames["exosuit"][:, 2, 3], 0.0332, atol=1e-14)
    for name, base, tip in [
        ("ph_1", 0.0, 0.045),
        ("ph_2", 0.045, 0.0703),
        ("ph_3", 0.0703, 0.0939),
        ("tip", 0.0939, 0.0949),
    ]:
        np.testing.assert_allclose(frames[name][[0, -1], 0, 3], [base, tip], atol=1e-14)
        np.testing.assert_allclose(frames[name][[0, -1], 2, 3], 0.0, atol=1e-14)


def test_spheres_are_as_wide_as_their_bodies(finger: Model, path: Path) -> None:
    spheres = path.spheres(0)
    radius = 0.0116 - 0.0036 * finger.X
    np.testing.assert_allclose(spheres["exosuit"][:, 3], [0.0116, *radius], rtol=1e-13)
    np.testing.assert_allclose(spheres["exosuit"][:, 0], [0.0, *(0.1 * finger.X)], atol=1e-14)
    base, a, b, length = 0.0, 0.0216, 0.0139, 0.045
    # Centroid of a conical frustum.
    centroid = length * (a * a + 2 * a * b + 3 * b * b) / (4 * (a * a + a * b + b * b))
    at = a + (b - a) * centroid / length
    np.testing.assert_allclose(
        spheres["finger"][:2, [0, 3]], [[base, a], [centroid, at]], rtol=1e-13, atol=1e-15
    )


def test_the_finger_bends_and_the_path_is_an_equilibrium(finger: Model, path: Path) -> None:
    assert path.converged.all()
    assert path.stable.all()
    assert set(path.status) == {"converged"}
    total = path.joint_angles.sum(axis=1)
    assert (np.diff(total) >= -1e-12).all()
    assert total[-1] > 0.1
    assert path.joint_angles.shape == (6, 3)
    for step in range(6):
        gradient = finger.engine.residual(path.parameters, path.q[step], path.loads[step])
        assert np.abs(gradient).max() < 1e-6
        tangent = finger.engine.tangent(path.parameters, path.q[step], path.loads[step])
        assert np.linalg.eigvalsh(tangent).min() > 0.0
        energy = finger.engine.energy(path.parameters, path.q[step], path.loads[step])
        assert energy == pytest.approx(path.energy[step], rel=1e-12, abs=1e-15)


def test_contact_forces_are_those_of_equation_8(path: Path) -> None:
    step = 5
    spheres = np.concatenate(list(path.spheres(step).values()))
    found = path.contact_forces(step)
    expected = {}
    for i in range(42):
        for j in range(42, 50):
            r = spheres[i, :3] - spheres[j, :3]
            depth = spheres[i, 3] + spheres[j, 3] - np.linalg.norm(r)
            if depth > 0.0:
                expected[i, j] = 77.1 * depth * r / np.linalg.norm(r)
    assert len(expected) > 0
    pairs = list(zip(found.first.tolist(), found.second.tolist(), strict=True))
    assert sorted(pairs) == sorted(expected)
    np.testing.assert_allclose(found.force, [expected[pair] for pair in pairs], atol=1e-12)
    assert path.pairs[step] == len(expected)
    assert path.touching[step] == len({first for first, _ in expected})
    tip = sum((force for (first, _), force in expected.items() if first == 41), np.zeros(3))
    assert path.tip_force[step] == pytest.approx(float(np.linalg.norm(tip)), abs=1e-12)
    for row, (first, second) in enumerate(pairs):
        for sphere in (spheres[first], spheres[second]):
            gap = sphere[3] - np.linalg.norm(found.point[row] - sphere[:3])
            assert gap == pytest.approx(found.depth[row] / 2.0, abs=1e-14)


@pytest.mark.parametrize("constants", ["surface", "calibrated", "calibrated-optimum"])
@pytest.mark.parametrize(("name", "expected"), [("finger", 1.05), ("finger-2-links", 0.27)])
def test_fitted_constants_meet_the_papers_angles(
    constants: str, name: str, expected: float
) -> None:
    """1.05 and 0.27 rad at 10 N (section III of the paper)."""
    path = flexor.load(name, constants).equilibrium(force="0:10:2")
    assert path.joint_angles[-1].sum() == pytest.approx(expected, abs=1e-3)


def test_the_published_optimum_bends_as_far_as_published(finger: Model) -> None:
    """1.43 rad at 5 N (section III of the paper), to which `calibrated` is fitted."""
    path = finger.equilibrium(design=tapers(finger, (0.108, 0.0065, 0.0074)))
    assert path.joint_angles[-1].sum() == pytest.approx(1.43, abs=1e-3)


def test_a_path_starts_without_load_whatever_its_first_force(finger: Model, path: Path) -> None:
    late = finger.equilibrium(force=[3, 5])
    assert late.force.tolist() == [3.0, 5.0]
    assert late.q.shape == (2, 25)
    np.testing.assert_allclose(late.joint_angles, path.joint_angles[[3, 5]], atol=1e-8)
    assert all(0 <= event.step < 2 for event in late.events)


def test_forces_have_defaults_units_and_forms(finger: Model, path: Path) -> None:
    for force in (None, "0:5:1", [0, "1000 mN", 2, 3, 4, "5 N"], {"chamber": range(6)}):
        np.testing.assert_array_equal(finger.equilibrium(force=force).q, path.q)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda m: m.equilibrium(force=[]), "force is an empty list: give at least one force"),
        (lambda m: m.equilibrium(force=[float("nan")]), "it must be a finite number"),
        (lambda m: m.equilibrium(force=[0, 1], tolerence=1.0), "tolerence"),
        (
            lambda m: m.evaluate(Taper(np.array([0.1]), np.ones((1, 3)), np.ones((1, 3)))),
            r"with 1 lengths and 41 sample points both must be \(1, 41\)",
        ),
    ],
)
def test_bad_calls(finger: Model, call: Callable[[Model], object], message: str) -> None:
    with pytest.raises(InputError, match=message):
        call(finger)


def test_the_files_own_geometry_changes_nothing(finger: Model) -> None:
    indices, values = finger.geometry_slots(tapers(finger, (0.1, 0.0116, 0.008)))
    assert values.shape == (1, len(indices))
    assert len(set(indices.tolist())) == len(indices)
    np.testing.assert_allclose(values[0], finger.parameters[indices], rtol=1e-14, atol=1e-17)


def test_the_base_follows_the_radius(finger: Model) -> None:
    batch = finger.evaluate(tapers(finger, (0.08, 0.006, 0.005), (0.12, 0.01, 0.005)), force=[0])
    for index, (length, radius) in enumerate([(0.08, 0.006), (0.12, 0.01)]):
        exosuit = batch[index].frames(0)["exosuit"]
        assert exosuit[0, 2, 3] == pytest.approx(0.0216 + radius, rel=1e-14)
        assert exosuit[-1, 0, 3] == pytest.approx(length, rel=1e-14)
        spheres = batch[index].spheres(0)["exosuit"]
        assert spheres[0, 3] == pytest.approx(radius, rel=1e-14)


def test_a_base_placed_by_its_axis_stays() -> None:
    file = parse(
        flexor.load("finger", "calibrated").file.to_toml().replace('"underside"', '"axis"')
    )
    model = Model(file)
    batch = model.evaluate(tapers(model, (0.1, 0.006, 0.009)), force=[0])
    assert batch[0].frames(0)["exosuit"][0, 2, 3] == pytest.approx(0.0216, rel=1e-14)


def test_a_batch_is_its_paths_whatever_the_threads(finger: Model) -> None:
    designs = [(0.1, 0.0116, 0.008), (0.08, 0.006, 0.009), (0.12, 0.009, 0.006)]
    geometry = tapers(finger, *designs)
    one, two = (finger.evaluate(geometry, threads=threads) for threads in (1, 2))
    np.testing.assert_array_equal(one.q, two.q)
    assert len(one) == 3
    assert one.sphere_count == 42
    assert one.joint_angles.shape == (3, 6, 3)
    for index, path in enumerate(one):
        alone = finger.equilibrium(design=tapers(finger, designs[index]))
        np.testing.assert_array_equal(path.q, alone.q)
        np.testing.assert_array_equal(path.touching, one.touching[index])
        np.testing.assert_array_equal(path.parameters, alone.parameters)
        assert path.converged.tolist() == one.converged[index].tolist()
    with pytest.raises(IndexError):
        one[3]


def test_json_holds_one_entry_per_step(path: Path) -> None:
    found = json.loads(json.dumps(path.to_dict(), allow_nan=False))
    assert list(found) == [
        "force",
        "joint_angles",
        "converged",
        "stable",
        "contacts",
        "tip_force",
        "length",
        "max_overlap",
        "places",
        "events",
        "coordinates",
        "q",
    ]
    assert found.pop("coordinates") == path.model.engine.coordinates
    assert found.pop("length") == {"chamber": path.length("chamber").tolist()}
    places = found.pop("places")["max_overlap"]
    assert [place is None for place in places] == (path.max_overlap == 0.0).tolist()
    assert places[-1]["body"] == "exosuit"
    assert all(len(entries) == 6 for entries in found.values())
    assert found["force"] == [0.0, 1.0, 2.0, 3.0, 4.0, 5.0]
    assert found["joint_angles"] == path.joint_angles.tolist()
    assert sum(len(events) for events in found["events"]) == len(path.events)


def test_events_tell_force_and_angles() -> None:
    """Somewhere in the search bounds branches end; what is told of it must hang together."""
    model = flexor.load("finger", "calibrated")
    radii = np.linspace(0.004, 0.012, 9)
    designs = [(length, a, b) for length in (0.07, 0.1, 0.13) for a in radii for b in radii]
    batch = model.evaluate(tapers(model, *designs))
    events = [event for path in batch for event in path.events]
    assert len(events) == batch.event_count.sum() > 0
    for path in batch:
        for event in path.events:
            assert event.kind in _engine.EVENTS
            assert event.angles_before.shape == event.angles_after.shape == (3,)
            low = path.force[event.step - 1] if event.step else 0.0
            assert low - 1e-12 <= event.force <= path.force[event.step] + 1e-12


def test_hash_is_of_the_mechanics() -> None:
    text = flexor.load("finger", "calibrated").file.to_toml()
    same = text.replace('"10 cm"', '"100 mm"').replace("Soft exosuit", "Exosuit")
    other = text.replace('"10 cm"', '"101 mm"')
    reference, renamed, longer = (Model(parse(source)).hash for source in (text, same, other))
    assert reference == renamed != longer
    assert len(reference) == 64


def test_tendon_arm_hangs_and_is_lifted() -> None:
    model = flexor.load("tendon-arm")
    assert not model.planar
    assert model.dof == 42 + 1
    path = model.equilibrium()
    assert path.force.tolist() == [0.0, 0.5, 1.0, 1.5, 2.0]
    assert path.converged.all()
    assert path.stable.all()
    tips = np.array([path.frames(step)["claw"][-1, :3, 3] for step in range(5)])
    assert tips[0, 2] < -0.05
    assert abs(tips[0, 1]) < 1e-9  # without tension nothing pulls it out of its plane
    assert np.linalg.norm(tips[-1] - tips[0]) > 0.005


def test_every_joint_counts_its_coordinates() -> None:
    def link(name: str, joint: str) -> str:
        return f"""
[bodies.{name}]
kind = "link"
length = "4 cm"
radius = "1 cm"
joint = {{ kind = "{joint}" }}
"""

    kinds = {
        "fixed": 0,
        "revolute": 1,
        "prismatic": 1,
        "universal": 2,
        "spherical": 3,
        "free": 6,
    }
    planar = Model(parse('name = "x"\nplanar = true\n' + link("a", "free")))
    assert planar.joints == ("a.theta_y", "a.x", "a.z")
    for kind, count in kinds.items():
        model = Model(parse('name = "x"\n' + link("a", kind)))
        assert model.dof == count
        assert len(model.joints) == count
        assert all(name.startswith("a.") for name in model.joints)


def test_several_inputs_are_told_apart() -> None:
    text = flexor.load("exosuit-alone", "calibrated").file.to_toml()
    text += """
[actuators.lower]
kind = "chamber"
rod = "exosuit"
lever = -1.0
"""
    model = Model(parse(text))
    assert model.inputs == ("chamber", "lower")
    with pytest.raises(InputError, match="force must name its input"):
        model.equilibrium(force=[0, 1])
    path = model.equilibrium(force={"lower": "0:1:0.5"})
    assert path.loads.tolist() == [[0.0, 0.0], [0.0, 0.5], [0.0, 1.0]]
    assert path.frames()["exosuit"][-1, 2, 3] > 0.0332  # it bends up


def test_a_model_without_inputs_or_design_has_an_equilibrium() -> None:
    text = """
name = "pendulum"
planar = true
gravity = { z = "-10 m/s^2" }

[bodies.bar]
kind = "link"
length = "10 cm"
radius = "1 cm"
density = "1 g/cm^3"
joint = { kind = "revolute", stiffness = "0.1 N*m/rad" }
"""
    model = Model(parse(text))
    path = model.equilibrium()
    # k theta = m g (L/2) cos(theta), with the bar a cylinder of 10 pi grams
    theta = path.joint_angles[-1, 0]
    weight = 1000.0 * np.pi * 0.01**2 * 0.1 * 10.0
    assert theta == pytest.approx(weight * 0.05 * np.cos(theta) / 0.1, rel=1e-8)
    assert path.force.tolist() == [0.0]
    with pytest.raises(InputError, match="has no \\[design\\] table"):
        _ = model.design
