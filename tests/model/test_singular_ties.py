"""Linkages at and beyond singular configurations, and drives that cannot be followed."""

from __future__ import annotations

import re

import numpy as np
import pytest

from flexor.model import Model, why_not_closed, why_singular
from tests.model.test_ties import link, model, push, rod, tie

MOTOR = tie("motor", "hinge", "world = {}", '"crank", at = "base"', 'drive = "rotation"')


def turned(angle: float) -> str:
    return f'placement = {{ rotation = {{ y = "{angle!r} deg" }} }}'


def slider_crank(rod_length: float = 0.1, size: float = 1.0, force: float = 1.0) -> Model:
    """Return a crank of 10 cm with a sprung joint to a rod whose end slides along x."""
    return model(
        link("crank", 0.1 * size, "", 'kind = "free"'),
        link(
            "rod",
            rod_length * size,
            'parent = "crank"',
            f'kind = "revolute"\nstiffness = "{0.05 * force * size!r} N*m/rad"',
        ),
        link("block", 0.02 * size, 'parent = "rod"'),
        MOTOR,
        tie(
            "rail",
            "slider",
            f'world = {{ x = "{0.2 * size!r} m" }}',
            '"block", at = "base"',
            'axis = "x"',
        ),
    )


def linkage(lengths: tuple[float, float, float, float], crank: float, rocker: float) -> Model:
    """Return a four-bar linkage: crank, coupler, sprung rocker and ground, with two angles."""
    a, b, c, d = lengths
    crank, rocker = float(crank), float(rocker)
    away = np.array([d + c * np.cos(rocker), c * np.sin(rocker)])
    coupler = away - a * np.array([np.cos(crank), np.sin(crank)])
    turn = [-float(np.degrees(x)) for x in (crank, np.arctan2(coupler[1], coupler[0]), rocker)]
    place = f'placement = {{ x = "{d!r} m", rotation = {{ y = "{turn[2]!r} deg" }} }}'
    return model(
        link("crank", a, turned(turn[0]), 'kind = "free"'),
        link("coupler", b, f'parent = "crank"\n{turned(turn[1] - turn[0])}'),
        link("rocker", c, place, 'kind = "revolute"\nstiffness = "0.05 N*m/rad"'),
        MOTOR,
        tie("loop", "pin", '"coupler", at = "tip"', '"rocker", at = "tip"'),
    )


def stops_at(made: Model, loads: object, expected: float, within: float = 2e-3) -> str:
    """Check that a path ends as singular near an angle [deg]; return the sentence."""
    path = made.equilibrium(np.radians(loads))
    step = path.status.tolist().index("singular")
    assert path.converged[:step].all() and (path.status[step + 1 :] == "not-reached").all()
    assert np.isnan(path.tie_loads[step]).all() and not path.stable[step]
    assert path.tie_singularity[step].sum() == pytest.approx(1.0)
    assert np.abs(path.tie_loads[:step]).max() < 1e6
    found = np.degrees(path.applied[step, 0])
    assert found == pytest.approx(expected, abs=within)
    said = why_singular(path)
    assert f"the path ends at {found:g} deg" in said
    return said


@pytest.mark.parametrize("loads", [[-60, -90], [-60, -120], np.arange(-60, -121, -10), [-60, -400]])
def test_a_slider_crank_with_equal_arms_stops_at_its_change_point(loads: object) -> None:
    # Where the block is at the crank's axis it may rest while the rod turns with the crank.
    said = stops_at(slider_crank(), loads, -90.0)
    assert said.startswith("ties.motor and ties.rail become dependent on one another")


@pytest.mark.parametrize("size", [1e-3, 1.0, 1e3])
@pytest.mark.parametrize("force", [1e-3, 1.0, 1e3])
def test_singular_configurations_do_not_depend_on_units(size: float, force: float) -> None:
    stops_at(slider_crank(0.1, size, force), [-60.0, -120.0], -90.0)


@pytest.mark.parametrize("longer", [1e-2, 1e-4])
def test_a_rod_that_is_a_little_longer_takes_the_regular_path(longer: float) -> None:
    rod_length = 0.1 * (1.0 + longer)
    for loads in ([-60, -120], np.arange(-60, -121, -10.0), [-60, -420]):
        turns = np.radians(loads)
        path = slider_crank(rod_length).equilibrium(turns)
        assert path.converged.all() and path.stable.all() and not path.events
        # sin of the rod's angle to the rail; its cosine never changes sign.
        down = 0.1 * np.sin(turns) / rod_length
        angles = dict(zip(path.model.joints, path.joint_angles.T, strict=True))
        np.testing.assert_allclose(angles["block.theta"], np.arcsin(down), atol=1e-7)


def test_arc_length_stops_at_change_points_and_turns_back_at_dead_centres() -> None:
    path = slider_crank().equilibrium(np.radians([-60.0, -120.0]), follow="arc-length")
    assert path.status[-1] == "singular" and path.converged[:-1].all()
    assert np.degrees(path.applied[-1, 0]) == pytest.approx(-90.0, abs=2e-3)
    assert "ties.motor and ties.rail become dependent" in why_singular(path)
    regular = slider_crank(0.101).equilibrium(np.radians([-60.0, -120.0]), follow="arc-length")
    assert regular.converged.all()
    short = slider_crank(0.09).equilibrium(
        np.radians([-60.0, -70.0]), follow="arc-length", max_iterations=200
    )
    assert short.status[-1] == "iteration-limit"
    turned_back = np.degrees(short.applied[short.converged, 0])
    assert turned_back.min() == pytest.approx(-np.degrees(np.arcsin(0.9)), abs=1e-3)


PARALLEL = (0.05, 0.1, 0.05, 0.1)


@pytest.mark.parametrize("loads", [[0, 60], [0, 100], [0, 59.9, 360], [0, -300]])
def test_a_parallelogram_stops_at_its_change_points(loads: list[float]) -> None:
    made = linkage(PARALLEL, np.radians(60.0), np.radians(60.0))
    stops_at(made, loads, 60.0 if loads[1] > 0 else -120.0)


@pytest.mark.parametrize("loads", [[0, 60], [0, 100], [0, 30, 70]])
def test_an_antiparallelogram_does_not_turn_into_a_parallelogram(loads: list[float]) -> None:
    # tan of half the rocker's angle to tan of half the crank's: (d + a)/(d - a) = 3.
    rocker = -2.0 * np.arctan(3.0 * np.tan(np.radians(30.0)))
    made = linkage(PARALLEL, np.radians(60.0), float(rocker))
    stops_at(made, loads, 60.0)


def test_a_linkage_that_begins_in_a_singular_configuration_says_so() -> None:
    path = linkage(PARALLEL, 0.0, 0.0).equilibrium(np.radians([0.0, 30.0]))
    assert path.status.tolist() == ["singular", "not-reached"]
    assert why_singular(path).endswith("become dependent on one another")


def test_two_parallelograms_out_of_phase_pass_their_change_points() -> None:
    # As the wheels of a locomotive: what one does not hold the other does.
    bars = []
    for name, phase in (("a", 60.0), ("b", 150.0)):
        place = turned(60.0 - phase)
        bars += [
            link(f"arm_{name}", 0.05, f'parent = "crank"\n{place}', 'kind = "fixed"'),
            link(f"far_{name}", 0.05, f'parent = "wheel"\n{place}', 'kind = "fixed"'),
            link(f"bar_{name}", 0.1, f'parent = "arm_{name}"\n{turned(phase)}'),
            tie(f"loop_{name}", "pin", f'"bar_{name}", at = "tip"', f'"far_{name}", at = "tip"'),
        ]
    wheel = 'placement = { x = "10 cm", rotation = { y = "-60 deg" } }'
    made = model(
        link("crank", 1e-9, turned(-60.0), 'kind = "free"'),
        link("wheel", 1e-9, wheel, 'kind = "revolute"\nstiffness = "0.05 N*m/rad"'),
        *bars,
        MOTOR,
    )
    turns = np.radians(np.arange(0.0, 721.0, 60.0))
    path = made.equilibrium(turns)
    assert path.converged.all(), path.status
    angles = dict(zip(path.model.joints, path.joint_angles.T, strict=True))
    np.testing.assert_allclose(angles["wheel.theta"], turns, atol=1e-9)
    np.testing.assert_allclose(path.tie_drives()["motor"], 0.05 * turns, atol=1e-9)


def test_a_universal_joint_that_lines_up_is_singular() -> None:
    # Two shafts at an angle: at right angles the cross lies along the first after a quarter turn.
    def shafts(degrees: float) -> Model:
        angle = float(np.radians(degrees))
        x, z = (0.05 * float(f(angle)) for f in (np.cos, np.sin))
        return model(
            link("fork", 0.05, "", 'kind = "free"'),
            link(
                "cross",
                0.05,
                f'parent = "fork"\nplacement = {{ rotation = {{ y = "{degrees!r} deg" }} }}',
                'kind = "universal"\nstiffness = "1 N*m/rad"',
            ),
            tie("motor", "hinge", "world = {}", '"fork", at = "base"', f'axis = "x"\n{DRIVEN}'),
            tie(
                "bearing",
                "hinge",
                f'world = {{ x = "{0.05 + x!r} m", z = "{-z!r} m" }}',
                '"cross", at = "tip"',
                f"axis = [{x / 0.05!r}, 0.0, {-z / 0.05!r}]",
            ),
            planar=False,
        )

    turns = np.radians(np.arange(0.0, 721.0, 40.0))
    path = shafts(60.0).equilibrium(turns)
    assert path.converged.all(), path.status
    # The cross leans to both sides: sin of its second angle, by the two shafts' axes.
    angles = dict(zip(path.model.joints, path.joint_angles.T, strict=True))
    leaning = -np.sin(np.radians(60.0)) * np.sin(turns)
    np.testing.assert_allclose(np.sin(angles["cross.theta_z"]), leaning, atol=1e-9)
    stops_at(shafts(90.0), [0.0, 40.0, 200.0], 90.0)


def test_an_inextensible_column_that_is_held_at_both_ends_is_singular() -> None:
    # To first order it may bend, but then it is too short: the force along it has no bound.
    column = rod("column", 0.2, "", 'bend_y = "nodal_quadratic"')
    pinned = tie("end", "pin", '"column", at = "tip"', 'world = { x = "20 cm" }')
    path = model(column, pinned).equilibrium([0.0])
    assert path.status.tolist() == ["singular"] and "ties.end becomes" in why_singular(path)
    stretching = model(rod("column", 0.2), pinned).equilibrium([0.0])
    assert stretching.stable.all()


def gap(said: str, unit: str) -> float:
    found = re.search(rf"([0-9.e+-]+) {unit}", said)
    assert found is not None, said
    return float(found.group(1))


def test_a_crank_beyond_its_range_names_the_tie_that_opens() -> None:
    made = linkage((0.05, 0.06, 0.05, 0.1), np.radians(60.0), np.radians(107.647))
    # The dead centre, where coupler and rocker are in line.
    end = 60.0 - np.degrees(np.arccos((0.05**2 + 0.1**2 - 0.11**2) / (2 * 0.05 * 0.1)))
    path = made.equilibrium(np.radians([0.0, 30.0, -120.0]))
    assert path.status.tolist() == ["converged", "converged", "not-closed"]
    said = why_not_closed(path)
    # Crank and ground in line, 15 cm apart, coupler and rocker 11 cm long.
    assert said.startswith("ties.loop is open by 40 mm; the path ends at")
    assert gap(said.split("ends at")[1], "deg") == pytest.approx(end, abs=2e-3)


@pytest.mark.parametrize("size", [1e-3, 1.0, 1e3])
def test_a_rod_that_is_too_short_leaves_the_smallest_gap(size: float) -> None:
    path = slider_crank(0.09, size).equilibrium(np.radians([-60.0, -70.0]))
    assert path.status.tolist() == ["converged", "not-closed"]
    expected = (0.1 * np.sin(np.radians(70.0)) - 0.09) * size
    assert path.tie_gaps[1, 1, 0] == pytest.approx(expected, rel=1e-6)
    assert "ties.motor" not in why_not_closed(path)
    # Further on the rod would reach, but not on the way, where the largest gap is.
    end = -np.degrees(np.arcsin(0.9))
    for loads in ([-60.0, -120.0], [-60.0, -64.0, -120.0], [-60.0, -410.0]):
        path = slider_crank(0.09, size).equilibrium(np.radians(loads))
        assert path.status.tolist()[-1] == "not-closed"
        found = np.degrees(path.applied[-1, 0])
        assert found == pytest.approx(end, abs=2e-3)
        said = why_not_closed(path)
        assert "ties.rail is open by" in said and "ties.motor" not in said
        widest = (0.1 - 0.09) * size
        assert path.tie_gaps[-1, 1, 0] == pytest.approx(widest, rel=0.15)


def test_small_gaps_of_small_mechanisms_are_named() -> None:
    # 50 nm of 1 mm.
    far = tie("far", "pin", '"bar", at = "tip"', 'world = { x = "1.00005 mm" }')
    path = model(link("bar", 0.001), far).equilibrium(np.zeros((1, 0)))
    assert path.status.tolist() == ["not-closed"]
    assert why_not_closed(path) == "ties.far is open by 5e-05 mm"


def test_drives_that_contradict_one_another_are_named() -> None:
    made = model(
        link("crank", 0.04, "", 'kind = "free"'),
        MOTOR,
        tie("second", "weld", "world = {}", '"crank", at = "base"', 'drive = "rotation"'),
    )
    path = made.equilibrium(np.radians([[0.0, 0.0], [30.0, 30.0], [30.0, 20.0]]))
    assert path.status.tolist() == ["converged", "converged", "not-closed"]
    said = "ties.second is turned by 10 deg; the path ends at motor 30 deg, second 30 deg"
    assert why_not_closed(path) == said


def test_one_drive_more_than_a_linkage_has_mobility() -> None:
    made = model(
        link("crank", 0.04, turned(-90.0), 'kind = "free"'),
        link("coupler", 0.12, f'parent = "crank"\n{turned(90.0)}'),
        link(
            "rocker",
            0.04,
            'placement = { x = "12 cm", rotation = { y = "-90 deg" } }',
            'kind = "free"',
        ),
        MOTOR,
        tie("loop", "pin", '"coupler", at = "tip"', '"rocker", at = "tip"'),
        tie("brake", "hinge", 'world = { x = "12 cm" }', '"rocker", at = "base"', DRIVEN),
    )
    path = made.equilibrium(np.radians([[0.0, 0.0], [20.0, 20.0], [40.0, 20.0]]))
    assert path.status.tolist() == ["converged", "converged", "not-closed"]
    said = "ties.brake is turned by 20 deg; the path ends at motor 20 deg, brake 20 deg"
    assert why_not_closed(path) == said


def test_a_path_whose_first_load_is_not_reached_says_why() -> None:
    # Paths begin without load.
    far = tie("far", "pin", '"bar", at = "tip"', 'world = { x = "13 cm" }')
    path = model(link("bar", 0.1), far, push("bar", 'z = "1 N"')).equilibrium([1.0, 2.0])
    assert path.status.tolist() == ["not-closed", "not-reached"]
    assert why_not_closed(path) == "ties.far is open by 30 mm"


DRIVEN = 'drive = "rotation"'


@pytest.mark.parametrize("planar", [True, False])
@pytest.mark.parametrize("kind", ["hinge", "weld"])
def test_a_free_body_is_turned_about_any_place(planar: bool, kind: str) -> None:
    made = model(
        link("wheel", 0.04, 'placement = { x = "1 cm", z = "3 cm" }', 'kind = "free"'),
        tie(
            "motor",
            kind,
            'world = { x = "-5 cm", z = "2 cm" }',
            '"wheel", at = 0.3, offset = { z = "7 mm" }',
            DRIVEN,
        ),
        planar=planar,
    )
    turns = np.radians(np.arange(0.0, 1081.0, 45.0))
    path = made.equilibrium(turns)
    assert path.converged.all() and path.tie_gaps.max() < 1e-9
    for step, turn in enumerate(turns):
        frame = path.frames(step)["wheel"][0]
        rotation = np.array([[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]])
        np.testing.assert_allclose(frame[:3:2, :3:2], rotation, atol=1e-8)
        place = np.array([-0.05, 0.02]) - rotation @ [0.012, 0.007]
        np.testing.assert_allclose(frame[:3:2, 3], place, atol=1e-9)
