"""Loads that rise and fall, states where paths begin, and branches followed by arc length."""

from __future__ import annotations

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
