"""Loads that rise and fall, states where paths begin, and branches followed by arc length."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

import flexor
from flexor.errors import InputError
from flexor.model import Model, parse

A, HEIGHT, K = 0.1, 0.02, 1000.0
REST = float(np.hypot(A, HEIGHT))
TRUSS = f"""
name = "truss"
planar = true
[bodies.node]
kind = "link"
length = "1 mm"
radius = "1 mm"
placement = {{ x = "-1 mm" }}
[bodies.node.joint]
kind = "prismatic"
axis = "z"
stiffness = "0 N/m"
[springs.l]
stiffness = "{K} N/m"
rest_length = "{REST!r} m"
first = {{ body = "node", at = "tip" }}
second = {{ world = {{ x = "-10 cm" }} }}
[springs.r]
stiffness = "{K} N/m"
rest_length = "{REST!r} m"
first = {{ body = "node", at = "tip" }}
second = {{ world = {{ x = "10 cm" }} }}
[wrenches.push]
body = "node"
at = "tip"
input = true
force = {{ z = "-1 N" }}
"""


@pytest.fixture(scope="module")
def truss() -> Model:
    return Model(parse(TRUSS))


def force(z: np.ndarray) -> np.ndarray:
    """Return the load [N] that holds the apex at the height z."""
    length = np.hypot(A, z)
    return 2.0 * K * (REST - length) * z / length


def test_the_start_chooses_the_side(truss: Model) -> None:
    for start in ("15 mm", "-15 mm", 0.015):
        path = truss.equilibrium([0.0], start={"node": start})
        above = not str(start).startswith("-")
        assert path.q[0, 0] == pytest.approx(HEIGHT if above else -HEIGHT, rel=1e-9)


def test_unloading_takes_another_way(truss: Model) -> None:
    limit = force(np.linspace(0.0, HEIGHT, 100_001)).max()
    path = truss.equilibrium("0:0.4:0.05,0.4:0:0.05", start={"node": "15 mm"})
    assert limit < 0.4
    up, down = path.q[:9, 0], path.q[8:, 0][::-1]
    assert up[0] == pytest.approx(HEIGHT)
    assert down[0] == pytest.approx(-HEIGHT)
    assert len(path.events) == 1
    np.testing.assert_allclose(force(path.q[:, 0]), path.force, atol=1e-9)


def test_a_state_found_before_is_a_start(truss: Model) -> None:
    snapped = truss.equilibrium([0.0, 0.4], start={"node": "15 mm"})[-1]
    again = truss.equilibrium([0.4, 0.0], start=snapped)
    assert again.q[-1, 0] == pytest.approx(-HEIGHT)


def test_arc_length_goes_through_the_limit_points(truss: Model) -> None:
    path = truss.equilibrium([0.0, 0.4], start={"node": "15 mm"}, follow="arc-length")
    z = path.q[:, 0]
    np.testing.assert_allclose(force(z), path.force, atol=1e-8)
    assert np.all(np.diff(z) < 0.0)
    slope = np.gradient(force(np.linspace(HEIGHT, z[-1], 10_001)))
    limits = np.linspace(HEIGHT, z[-1], 10_001)[np.flatnonzero(np.diff(np.sign(slope)))]
    inside = (z < limits.max() - 1e-4) & (z > limits.min() + 1e-4)
    outside = (z > limits.max() + 1e-4) | (z < limits.min() - 1e-4)
    assert inside.sum() >= 2 and not path.stable[inside].any()
    assert path.stable[outside].all()


@pytest.mark.parametrize(
    ("start", "message"),
    [
        ({"nod": "1 mm"}, "nod"),
        ({"node": "1 kg"}, "kg"),
        ([1.0], "start is"),
    ],
)
def test_a_bad_start_gets_one_sentence(truss: Model, start: object, message: str) -> None:
    with pytest.raises(InputError, match=message) as caught:
        truss.equilibrium([0.0], start=start)
    assert "\n" not in str(caught.value)


def test_a_path_is_followed_in_one_of_two_ways(truss: Model) -> None:
    with pytest.raises(InputError, match='expected "load" or "arc-length"'):
        truss.equilibrium([0.0], follow="arc")  # type: ignore[arg-type]


def test_the_file_can_say_where_paths_begin() -> None:
    model = Model(parse(TRUSS + '[start]\nnode = "-15 mm"\n'))
    assert model.equilibrium([0.0]).q[0, 0] == pytest.approx(-HEIGHT)
    assert flexor.load("finger").file.start == {}


# A hollow rubber tube of radii 10 and 7 mm, as the solid rod of its EI and EA.
TUBE = """
name = "tube"
planar = true
gravity = { z = "-9.81 m/s^2" }
[bodies.rod]
kind = "rod"
length = "1 m"
radius = "12.206555615733702 mm"
young_modulus = "684563.7583892618 Pa"
poisson_ratio = 0.49
density = "376.510067114094 kg/m^3"
strain = { bend_y = "nodal_quadratic", extend_x = "nodal_quadratic", shear_z = "nodal_quadratic" }
elements = 24
gauss_points = 3
[springs.pin]
first = { body = "rod", at = "tip" }
second = { world = { x = "0.6 m", z = "-0.1 m" } }
stiffness = "1e5 N/m"
[wrenches.down]
body = "rod"
at = 0.5
force = { z = "-1 N" }
input = true
"""


def test_a_load_that_comes_and_goes_leaves_the_deeper_of_two_states() -> None:
    path = Model(parse(TUBE)).equilibrium([0, 2, 4, 6, 8, 6, 4, 2, 0])
    assert path.stable.all()
    np.testing.assert_allclose(path.energy[[0, -1]], [0.207, -0.294], atol=1e-3)
    assert path.frames(-1)["rod"][:, 2, 3].min() == pytest.approx(-0.40332, abs=1e-5)


def test_a_posture_chooses_the_deeper_state_and_so_does_the_file_or_a_state(tmp_path: Path) -> None:
    model = Model(parse(TUBE))
    deep = model.equilibrium([0.0], start={"rod.bend_y": "-90 deg"})
    assert deep.energy[0] == pytest.approx(-0.294, abs=1e-3)
    assert deep.frames(0)["rod"][:, 2, 3].min() == pytest.approx(-0.40332, abs=1e-5)
    saved = tmp_path / "deep.json"
    saved.write_text(json.dumps(deep.to_dict()), encoding="utf-8")
    told = Model(parse(f'{TUBE}[start]\nrod = {{ bend_y = "-90 deg" }}\n'))
    assert told.hash != model.hash
    for path in (
        model.equilibrium([0.0], start=saved),
        model.equilibrium([0.0], start=deep[0]),
        told.equilibrium([0.0]),
    ):
        np.testing.assert_allclose(path.q, deep.q, atol=1e-9)


@pytest.mark.parametrize("text", ["{}", "[1, 2]", "no JSON", '{"coordinates": [], "q": []}'])
def test_a_file_that_holds_no_path_gets_one_sentence(
    truss: Model, tmp_path: Path, text: str
) -> None:
    file = tmp_path / "state.json"
    file.write_text(text, encoding="utf-8")
    with pytest.raises(InputError, match=r"state\.json"):
        truss.equilibrium([0.0], start=file)


LEE = """
name = "lee"
planar = true
[bodies.column]
kind = "rod"
length = "120 cm"
radius = "1 cm"
section = { kind = "rectangular", ratio = 1.5 }
young_modulus = "7.2e6 Pa"
poisson_ratio = 0.3
joint = { kind = "revolute" }
placement = { rotation = { y = "-90 deg" } }
strain = { bend_y = "nodal_quadratic", extend_x = "nodal_quadratic", shear_z = "nodal_quadratic" }
elements = 10
gauss_points = 3
[bodies.beam]
kind = "rod"
parent = "column"
length = "120 cm"
radius = "1 cm"
section = { kind = "rectangular", ratio = 1.5 }
young_modulus = "7.2e6 Pa"
poisson_ratio = 0.3
placement = { rotation = { y = "90 deg" } }
strain = { bend_y = "nodal_quadratic", extend_x = "nodal_quadratic", shear_z = "nodal_quadratic" }
elements = 10
gauss_points = 3
[springs.pin]
first = { body = "beam", at = "tip" }
second = { world = { x = "120 cm", z = "120 cm" } }
stiffness = "1e7 N/m"
[wrenches.p]
body = "beam"
at = 0.2
force = { z = "-1 N" }
input = true
"""


@pytest.fixture(scope="module")
def lee() -> Model:
    return Model(parse(LEE))


@pytest.mark.parametrize("steps", [5, 20])
def test_lee_s_frame_snaps_back_in_load_and_displacement(lee: Model, steps: int) -> None:
    path = lee.equilibrium(np.linspace(0.0, 1.9, steps), follow="arc-length")
    assert path.converged.all() and path.force[-1] == 1.9
    assert (path.residual <= path.tolerance).all()
    turns = np.flatnonzero(np.diff(np.sign(np.diff(path.force)))) + 1
    # 1.8552 N in the literature, for a frame that neither stretches nor shears.
    np.testing.assert_allclose(path.force[turns], [1.854657, -0.939620], atol=2e-6)
    assert path.force[turns[0]] == pytest.approx(1.8552, rel=5e-4)
    # The loaded point goes sideways, back and on again: no control of its displacement follows it.
    loaded = np.array([state.frames()["beam"][6, 0, 3] for state in path])
    assert np.abs(np.diff(np.sign(np.diff(loaded)))).sum() >= 4
    # Stable before the first limit point, unstable in between, stable after the second.
    assert path.stable[: turns[0]].all() and path.stable[turns[1] + 1 :].all()
    assert not path.stable[turns[0] : turns[1]].any()
    for state in path[:: max(1, len(path) // 12)]:
        if abs(state.force - path.force[turns]).min() < 1e-3:
            continue
        tangent = lee.engine.tangent(lee.parameters, state.q, [state.force])
        assert state.stable == (np.linalg.eigvalsh(tangent).min() > 0.0), state.force


def test_lee_s_frame_snaps_once_at_its_limit_point(lee: Model) -> None:
    path = lee.equilibrium(np.linspace(0.0, 1.9, 5))
    assert path.converged.all()
    assert [event.kind for event in path.events] == ["snap"]
    assert path.events[0].force == pytest.approx(1.854657, abs=3e-4)
    # The pin is 10⁸ times as stiff as the frame; its force is an unknown.
    assert path.iterations.sum() < 400


def test_every_equilibrium_at_a_listed_load_is_met(truss: Model) -> None:
    path = truss.equilibrium([0.0, 0.1, 0.5], start={"node": "20 mm"}, follow="arc-length")
    met = np.sort(path.q[path.force == 0.1, 0])
    # Heights at which the two springs carry 0.1 N, from the closed form.
    z = np.linspace(-0.03, HEIGHT, 200_001)
    exact = z[np.flatnonzero(np.diff(np.sign(force(z) - 0.1)))]
    np.testing.assert_allclose(met, exact, atol=1e-6)
    peak = force(z[z > 0.0]).max()
    assert path.force[path.force < 0.4].max() == pytest.approx(peak, rel=1e-9)


def test_arc_length_turns_where_loads_turn_and_starts_where_it_is_told(truss: Model) -> None:
    path = truss.equilibrium([0.0, 0.2, 0.0], follow="arc-length", start={"node": "20 mm"})
    assert path.force[0] == path.force[-1] == 0.0 and 0.2 in path.force
    np.testing.assert_allclose(path.q[-1], path.q[0], atol=1e-9)
    whole = truss.equilibrium([0.0, 0.5], start={"node": "20 mm"}, follow="arc-length")
    unstable = next(state for state in whole if not state.stable)
    # An unstable equilibrium is kept as a start.
    on = truss.equilibrium([0.5], start=unstable, follow="arc-length")
    assert not on.stable[0] and on.force[0] == unstable.force and on.force[-1] == 0.5


def test_the_figure_of_a_loop_has_both_ways_and_dashes(truss: Model) -> None:
    from flexor import plot

    loop = plot.path(truss.equilibrium([0.0, 0.2, 0.4, 0.2, -0.4, 0.0], start={"node": "20 mm"}))
    assert len(loop.axes) == 2
    branch = plot.path(truss.equilibrium([0.0, 0.5], start={"node": "20 mm"}, follow="arc-length"))
    (panel,) = (axes for axes in branch.axes if axes.get_xlabel() == "force / N")
    styles = {line.get_linestyle() for line in panel.lines}
    assert {"-", "--"} <= styles
    rising = plot.path(truss.equilibrium([0.0, 0.1], start={"node": "20 mm"}))
    assert len(rising.axes) == 1


LIMITED = """
name = "limited"
planar = true
[bodies.finger]
kind = "link"
length = "40 mm"
radius = "10 mm"
joint = { kind = "revolute", lower = "0 deg", upper = "90 deg" }
[wrenches.motor]
body = "finger"
at = "base"
moment = { y = "1 N*m" }
input = true
"""


@pytest.mark.parametrize("angle", [-170, -20, -1, 100, 120])
def test_a_start_beyond_a_limit_returns_to_it(angle: float) -> None:
    """At a limit of zero nothing acts any more, not even rounding."""
    path = Model(parse(LIMITED)).equilibrium([0.0, 1.0], start={"finger": f"{angle} deg"})
    assert path.converged.all()
    limit = 0.0 if angle < 0 else np.pi / 2
    assert path.joint_angles[0, 0] == pytest.approx(limit, abs=1e-9)


def test_a_start_of_huge_numbers_is_refused(truss: Model, tmp_path: Path) -> None:
    file = tmp_path / "start.json"
    found = {"coordinates": truss.engine.coordinates, "converged": [True], "force": [0]}
    file.write_text(json.dumps(found | {"q": [[10**400]]}))
    with pytest.raises(InputError, match="it contains no equilibrium"):
        truss.equilibrium([0.0], start=file)
    with pytest.raises(InputError, match="must be a finite number"):
        truss.equilibrium([0.0], start={"node": 10**400})
