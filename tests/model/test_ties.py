"""Ties: joints that close loops, against closed forms and differences."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from flexor.errors import InputError
from flexor.model import Model, Path, parse, why_not_closed, why_stalled
from flexor.model.derivatives import Differential, differentiate, weights

# A round rod: radius 1 mm, E = 1 GPa, nu = 0.3.
EI = 1e9 * np.pi / 4.0 * 1e-12
GJ = EI / 1.3
PLANAR = 'bend_y = "nodal_quadratic", extend_x = "nodal_quadratic"'
INEXTENSIBLE = ", ".join(f'{mode} = "nodal_quadratic"' for mode in ("twist_x", "bend_y", "bend_z"))
SPATIAL = f'twist_x = "nodal_quadratic", bend_z = "nodal_quadratic", {PLANAR}'


def rod(name: str, length: float, more: str = "", strain: str = PLANAR, elements: int = 6) -> str:
    return f"""
[bodies.{name}]
kind = "rod"
length = "{length!r} m"
radius = "1 mm"
young_modulus = "1 GPa"
poisson_ratio = 0.3
elements = {elements}
gauss_points = 3
strain = {{ {strain} }}
{more}
"""


def link(name: str, length: float, place: str = "", joint: str = 'kind = "revolute"') -> str:
    return f"""
[bodies.{name}]
kind = "link"
length = "{length!r} m"
radius = "2 mm"
{place}
[bodies.{name}.joint]
{joint}
"""


def tie(name: str, kind: str, first: str, second: str, more: str = "") -> str:
    at = [f"{{ {end} }}" if "world" in end else f"{{ body = {end} }}" for end in (first, second)]
    return f'[ties.{name}]\nkind = "{kind}"\nfirst = {at[0]}\nsecond = {at[1]}\n{more}\n'


def push(body: str, force: str, at: str = '"tip"') -> str:
    return f'[wrenches.push]\nbody = "{body}"\nat = {at}\nforce = {{ {force} }}\ninput = true\n'


def model(*parts: str, planar: bool = True) -> Model:
    return Model(parse(f'name = "loop"\nplanar = {str(planar).lower()}\n' + "\n".join(parts)))


def solved(made: Model, loads: object) -> Path:
    path = made.equilibrium(loads)  # type: ignore[arg-type]
    assert path.converged.all(), path.status
    assert path.tie_gaps[..., 0].max() < 1e-9 and path.tie_gaps[..., 1].max() < 1e-8
    return path


def four_bar(planar: bool = True, kind: str = "hinge") -> Model:
    """Return a crank of 4 cm, a coupler of 10 cm and a sprung rocker of 8 cm, 12 cm apart."""
    return model(
        link("crank", 0.04, 'placement = { rotation = { y = "-90 deg" } }', 'kind = "free"'),
        link("coupler", 0.1, 'parent = "crank"\nplacement = { rotation = { y = "90 deg" } }'),
        link(
            "rocker",
            0.08,
            'placement = { x = "12 cm", rotation = { y = "-90 deg" } }',
            'kind = "revolute"\nstiffness = "0.05 N*m/rad"',
        ),
        tie("motor", "hinge", "world = {}", '"crank", at = "base"', 'drive = "rotation"'),
        tie("loop", kind, '"coupler", at = "tip"', '"rocker", at = "tip"'),
        planar=planar,
    )


@pytest.mark.parametrize("planar", [True, False])
def test_a_four_bar_linkage_turns_as_by_hand(planar: bool) -> None:
    # Two turns of the crank; in space less than one, as its coordinates are a rotation vector.
    turns = np.radians(np.arange(0.0, 721.0 if planar else 341.0, 20.0))
    path = solved(four_bar(planar, "pin" if planar else "hinge"), turns)
    joints = dict(zip(path.model.joints, path.joint_angles.T, strict=True))

    def rocker(turn: np.ndarray) -> np.ndarray:
        # The pin between coupler and rocker is where two circles meet, on the upper side.
        crank = 0.04 * np.stack([np.sin(turn), np.cos(turn)])
        across = np.array([[0.12], [0.0]]) - crank
        d = np.linalg.norm(across, axis=0)
        along = (0.1**2 - 0.08**2 + d**2) / (2.0 * d)
        up = np.sqrt(0.1**2 - along**2)
        pin = crank + (along * across + up * np.stack([-across[1], across[0]])) / d
        return np.arctan2(pin[0] - 0.12, pin[1])

    expected = rocker(turns)
    np.testing.assert_allclose(joints["rocker.theta"], expected, atol=1e-9)
    # The motor's moment does the work of the rocker's spring.
    h = 1e-5
    slope = (rocker(turns + h) - rocker(turns - h)) / (2.0 * h)
    np.testing.assert_allclose(path.tie_drives()["motor"], 0.05 * expected * slope, atol=1e-8)
    assert not path.events
    # In space three of the five conditions of the hinge follow from the joints' parallel axes.
    redundant = [sentence for sentence in path.warnings if "ties.loop" in sentence]
    assert len(redundant) == (not planar) and all("redundant: 3 cond" in s for s in redundant)


@pytest.mark.parametrize("planar", [True, False])
@pytest.mark.parametrize("joint", ['kind = "revolute"', 'kind = "free"'])
def test_a_joint_of_an_arm_without_load_is_driven(planar: bool, joint: str) -> None:
    # Nothing but the spring at the arm's own joint acts, and not at all while the arm rests.
    made = model(
        link("arm", 0.1, joint='kind = "revolute"\nstiffness = "0.1 N*m/rad"'),
        link("fore", 0.1, 'parent = "arm"', joint),
        tie("motor", "hinge", '"arm", at = "tip"', '"fore", at = "base"', 'drive = "rotation"'),
        planar=planar,
    )
    turns = np.radians([0.0, 10.0, 90.0, 170.0])
    path = solved(made, turns)
    joints = dict(zip(made.joints, path.joint_angles.T, strict=True))
    angle = next(name for name in ("fore.theta", "fore.theta_y") if name in joints)
    np.testing.assert_allclose(joints[angle], turns, atol=1e-9)
    np.testing.assert_allclose(joints["arm.theta"], 0.0, atol=1e-9)
    assert path.total_iterations < 100
    said = [sentence for sentence in path.warnings if 'the joint "free"' in sentence]
    assert len(said) == ("revolute" in joint)


def crank_and_rocker(coupler: float) -> Model:
    """Return a crank of 4 cm and a sprung rocker of 5 cm, 12 cm apart."""
    return model(
        link("crank", 0.04, f"placement = {{ {UP} }}", 'kind = "free"'),
        link("coupler", coupler, 'parent = "crank"\nplacement = { rotation = { y = "90 deg" } }'),
        link(
            "rocker",
            0.05,
            f'placement = {{ x = "12 cm", {UP} }}',
            'kind = "revolute"\nstiffness = "0.05 N*m/rad"',
        ),
        tie("motor", "hinge", "world = {}", '"crank", at = "base"', 'drive = "rotation"'),
        tie("loop", "hinge", '"coupler", at = "tip"', '"rocker", at = "tip"'),
    )


def test_a_crank_that_turns_back_ends_by_arc_length() -> None:
    # The coupler and the rocker are stretched at 222.6 deg, by hand; the branch closes on itself.
    made = crank_and_rocker(coupler=0.1)
    path = made.equilibrium(np.radians([0.0, 400.0]), follow="arc-length")
    assert path.status[-1] == "closed-branch" and path.converged[:-1].all()
    cosine = (0.04**2 + 0.12**2 - 0.15**2) / (2.0 * 0.04 * 0.12)
    # The crank's angle is measured from the vertical, the base of the rocker lies at 90 degrees.
    most = np.arccos(cosine) + np.radians(90.0)
    assert np.nanmax(path.force[:-1]) == pytest.approx(most, rel=1e-6)
    # It turns back at the other end of its range, too.
    least = np.radians(90.0) - np.arccos(cosine)
    assert np.nanmin(path.force[:-1]) == pytest.approx(least, rel=1e-6)


def platform(load: str) -> Model:
    """Return three rods of 20 cm, clamped below and with ball joints to a platform."""
    places = [(0.05, 0.0), (-0.025, 0.0433), (-0.025, -0.0433)]
    rods = [
        rod(f"rod{i}", 0.2, f'placement = {{ x = "{x} m", y = "{y} m", {UP} }}', SPATIAL)
        for i, (x, y) in enumerate(places)
    ]
    place = f'placement = {{ z = "20 cm", {UP} }}'
    balls = [
        tie(
            f"ball{i}",
            "pin",
            f'"platform", at = "base", offset = {{ y = "{y} m", z = "{-x} m" }}',
            f'"rod{i}", at = "tip"',
        )
        for i, (x, y) in enumerate(places)
    ]
    body = link("platform", 0.01, place, 'kind = "free"')
    return model(*rods, body, *balls, push("platform", load, '"base"'), planar=False)


UP = 'rotation = { y = "-90 deg" }'


def test_three_rods_carry_a_platform() -> None:
    path = solved(platform('x = "1 N"'), [0.0, 1e-5])
    moved = path.frames(1)["platform"][0, 0, 3] - path.frames(0)["platform"][0, 0, 3]
    assert 1e-5 / moved == pytest.approx(9.0 * EI / 0.2**3, rel=1e-6)
    # Each rod bears a third, and the reactions balance the load.
    np.testing.assert_allclose(path.tie_loads[1, :, 0], 1e-5 / 3.0, rtol=1e-6)
    np.testing.assert_allclose(path.tie_loads[1, :, 1:3].sum(axis=0), 0.0, atol=1e-12)


def test_three_rods_under_a_platform_buckle() -> None:
    made = platform('z = "-1 N"')
    critical = 3.0 * np.pi**2 * EI / (4.0 * 0.2**2)
    path = solved(made, np.array([0.0, 0.99, 1.003]) * critical)
    assert [event.kind for event in path.events] == ["bifurcation"]
    assert path.events[0].force == pytest.approx(critical, rel=1e-3)


RING = float(0.2 * np.pi)  # of radius 10 cm
CLOSED = ('"ring", at = "base"', '"ring", at = "tip"')


def test_a_pinched_ring_yields() -> None:
    curved = 'reference_strain = { bend_y = "10 1/m" }'
    ring = rod("ring", RING, curved, elements=16)
    made = model(ring, tie("close", "weld", *CLOSED), push("ring", 'z = "1 N"', "0.5"))
    force = 1e-5 * EI / 0.1**2
    path = solved(made, [0.0, force])
    low, high = (path.frames(step)["ring"][32, 2, 3] for step in (0, 1))
    flexibility = (np.pi / 4.0 - 2.0 / np.pi) * 0.1**3 / EI
    assert flexibility * EI / 0.1**3 == pytest.approx(0.1488, abs=5e-5)
    # The rod stretches too, which adds 2e-5 of it.
    assert (high - low) / force == pytest.approx(flexibility, rel=2e-4)
    assert path.warnings == []


@pytest.mark.parametrize("turns", [1, 2, -1])
@pytest.mark.parametrize("strain", [PLANAR, 'bend_y = "nodal_quadratic"'])
def test_a_straight_rod_is_closed_to_a_ring(turns: int, strain: str) -> None:
    weld = tie("close", "weld", *CLOSED, f'rotation = {{ y = "{360 * turns} deg" }}')
    path = solved(model(rod("ring", RING, "", strain, 12), weld), [0.0])
    moment = 2.0 * np.pi * turns * EI / RING
    expected = np.array([0.0, 0.0, 0.0, 0.0, moment, 0.0, 0.0])
    np.testing.assert_allclose(path.tie_loads[0, 0], expected, atol=1e-9 * abs(moment))


@pytest.mark.parametrize("joint", ["fixed", "revolute", "spherical"])
def test_a_force_turns_a_ring_of_straight_rod_over(joint: str) -> None:
    """It rolls about its own axis without resistance, until it lies along the force."""
    weld = tie("close", "weld", *CLOSED, 'rotation = { y = "360 deg" }')
    more = f'joint = {{ kind = "{joint}" }}'
    force = 0.1 * EI / 0.1**2

    def middle(direction: str, steps: int = 1) -> Any:
        ring = rod("ring", RING, more, INEXTENSIBLE, 8)
        made = model(ring, weld, push("ring", direction, "0.5"), planar=False)
        path = solved(made, force * np.arange(steps + 1) / steps)
        assert not path.events
        assert (path.iterations < 500).all()
        return path.frames(steps)["ring"][16, :3, 3]

    expected = -middle('z = "-1 N"')[2]
    for steps in (1, 3):
        moved = middle('y = "1 N"', steps)
        np.testing.assert_allclose(moved, [0.0, expected, 0.0], atol=1e-6)


def test_a_twisted_ring_buckles() -> None:
    # At sqrt(3) 2 pi EI/GJ (Michell, Zajac), here 2.25 turns. The plane of the ring is free: it
    # rolls about its own axis without resistance.
    weld = 'rotation = { y = "360 deg" }\naxis = "x"\ndrive = "rotation"'
    parts = (rod("ring", RING, "", SPATIAL, 16), tie("twist", "weld", *CLOSED, weld))
    critical = float(np.sqrt(3.0) * 2.0 * np.pi * EI / GJ)
    path = solved(model(*parts, planar=False), np.array([0.0, 0.5, 0.99, 1.01]) * critical)
    drive = path.tie_drives()["twist"] / (path.force.clip(1e-9) * GJ / RING)
    np.testing.assert_allclose(drive[1:3], 1.0, rtol=1e-4)
    assert drive[3] < 0.5
    assert [event.step for event in path.events] == [3]
    assert path.events[0].force == pytest.approx(critical, rel=1e-4)
    assert (path.stability[1:] == "neutral").all()
    # Without the neutral motion told apart, thousands.
    assert (path.iterations[:3] < 50).all() and path.iterations[3] < 1000


LEE = [
    rod("column", 1.2, f'joint = {{ kind = "revolute" }}\nplacement = {{ {UP} }}', elements=10),
    rod(
        "beam",
        1.2,
        'parent = "column"\nplacement = { rotation = { y = "90 deg" } }',
        elements=10,
    ),
    tie("pin", "pin", '"beam", at = "tip"', 'world = { x = "1.2 m", z = "1.2 m" }'),
    push("beam", 'z = "-1 N"', "0.2"),
]


def test_lee_s_frame_with_a_true_pin_snaps_once() -> None:
    # 18.552 EI/L^2: 1.8552 in the literature's units.
    unit = 0.1 * EI / 1.2**2 * 100.0
    made = model(*LEE)
    path = solved(made, np.linspace(0.0, 1.9, 5) * unit)
    assert [event.kind for event in path.events] == ["snap"]
    assert path.events[0].force / unit == pytest.approx(1.8552, rel=5e-4)
    branch = made.equilibrium(np.array([0.0, 1.9]) * unit, follow="arc-length")
    assert branch.converged.all()
    turns = np.flatnonzero(np.diff(np.sign(np.diff(branch.force)))) + 1
    np.testing.assert_allclose(branch.force[turns] / unit, [1.8559, -0.9421], rtol=5e-4)
    assert path.events[0].force == pytest.approx(branch.force[turns[0]], rel=1e-6)
    assert branch.stable[: turns[0]].all() and branch.stable[turns[1] + 1 :].all()
    assert not branch.stable[turns[0] : turns[1]].any()


def test_a_clamped_and_hinged_arch_snaps_once() -> None:
    half = float(np.radians(107.5))
    place = 'placement = { rotation = { y = "-107.5 deg" } }'
    arch = rod(
        "arch", 2.0 * half, f'reference_strain = {{ bend_y = "1 1/m" }}\n{place}', elements=16
    )
    hinge = tie("hinge", "pin", '"arch", at = "tip"', f'world = {{ x = "{2 * np.sin(half)} m" }}')
    path = solved(model(arch, hinge, push("arch", 'z = "-1 N"', "0.5")), [0.0, 9.6 * EI])
    assert [event.kind for event in path.events] == ["snap"]
    assert path.events[0].force / EI == pytest.approx(8.97, abs=0.01)


@pytest.mark.parametrize("planar", [True, False])
def test_sliders_and_welds_hold_what_they_should(planar: bool) -> None:
    strain = PLANAR if planar else SPATIAL
    beam = rod("beam", 0.2, "", strain)
    along = 'axis = "z"\ndrive = "displacement"'
    # A guided tip: 12 EI/L^3. The slider stands off the beam's tip along its axis.
    guided = tie(
        "guide", "slider", '"beam", at = "tip"', 'world = { x = "20 cm", z = "3 cm" }', along
    )
    path = solved(model(beam, guided, planar=planar), [0.0, -1e-6])
    force = 12.0 * EI / 0.2**3 * 1e-6
    assert path.tie_drives()["guide"][1] == pytest.approx(-force, rel=1e-5)
    # The first place, on the beam, is pushed up where the second is pushed down.
    assert path.frames(1)["beam"][-1, 2, 3] == pytest.approx(1e-6, rel=1e-6)
    # About the second place, from that about the tip.
    axial, moment = path.tie_loads[1, 0, [0, 4]]
    np.testing.assert_allclose(moment + 0.03 * axial, -force * 0.1, rtol=1e-5)
    # A beam clamped at both ends under a force in the middle: 192 EI/L^3.
    both = tie("clamp", "weld", '"beam", at = "tip"', 'world = { x = "20 cm" }')
    path = solved(model(beam, both, push("beam", 'z = "1 N"', "0.5"), planar=planar), [0.0, 1e-7])
    middle = path.frames(1)["beam"][12, 2, 3]
    assert 1e-7 / middle == pytest.approx(192.0 * EI / 0.2**3, rel=1e-5)
    np.testing.assert_allclose(path.tie_loads[1, 0, 2], 0.5e-7, rtol=1e-6)


def test_rods_are_tied_side_by_side() -> None:
    # Two clamped rods, 2 cm apart, that slide along one another at five places.
    low = rod("low", 0.2, "")
    high = rod("high", 0.2, 'placement = { z = "2 cm" }')
    places = [repr(k / 6) for k in range(1, 6)]
    clips = [
        tie(f"clip{k}", "slider", f'"low", at = {x}, {OFFSET}', f'"high", at = {x}', 'axis = "x"')
        for k, x in enumerate(places)
    ]
    path = solved(model(low, high, *clips, push("low", 'z = "1 N"')), [0.0, 1e-6])
    # Both bend alike, so each bears half.
    tip = path.frames(1)["low"][-1, 2, 3]
    assert tip / 1e-6 == pytest.approx(0.2**3 / (6.0 * EI), rel=2e-2)


OFFSET = 'offset = { z = "2 cm" }'


def test_identical_ties_are_redundant() -> None:
    beam = rod("beam", 0.2)
    hold = ('"beam", at = "tip"', 'world = { x = "20 cm" }')
    load = push("beam", 'z = "1 N"', "0.5")
    one = solved(model(beam, tie("a", "weld", *hold), load), [0.0, 1e-3])
    two = solved(model(beam, tie("a", "weld", *hold), tie("b", "pin", *hold), load), [0.0, 1e-3])
    np.testing.assert_allclose(two.q, one.q, rtol=1e-9, atol=1e-12)
    np.testing.assert_array_equal(two.tie_redundancy, [[0.0, 2.0]] * 2)
    assert len(two.warnings) == 1 and "ties.b" in two.warnings[0] and "2 cond" in two.warnings[0]
    assert not one.warnings
    assert two.to_dict()["warnings"] == two.warnings


def test_redundant_ties_are_closed_one_after_another() -> None:
    # The tips of three rods are drawn together by two pins; a third one follows from them.
    rods = [rod(f"r{i}", 0.1, f'placement = {{ x = "{3 * i} cm", {UP} }}') for i in range(3)]
    pairs = [(0, 1), (1, 2), (2, 0)]
    pins = [tie(f"p{i}", "pin", f'"r{i}", at = "tip"', f'"r{k}", at = "tip"') for i, k in pairs]
    path = solved(model(*rods, *pins), [0.0])
    tips = [path.frames()[f"r{i}"][-1, :3, 3] for i in range(3)]
    np.testing.assert_allclose(tips[1:], [tips[0]] * 2, atol=1e-10)
    assert path.tie_redundancy[0].tolist() == [0.0, 0.0, 2.0]
    two = solved(model(*rods, *pins[:2]), [0.0])
    np.testing.assert_allclose(path.q, two.q, atol=1e-8)


def test_contradictory_ties_are_named() -> None:
    beam = rod("beam", 0.2)
    ties = [
        tie(name, "pin", '"beam", at = "tip"', f'world = {{ x = "19 cm", z = "{z} cm" }}')
        for name, z in (("low", 0), ("high", 3))
    ]
    path = model(beam, *ties).equilibrium([0.0])
    assert path.status[0] == "not-closed"
    assert "ties.high is open by 3" in why_not_closed(path)
    # Out of reach.
    far = tie("far", "pin", '"link", at = "tip"', 'world = { x = "25 cm" }')
    path = model(link("link", 0.2), far).equilibrium([0.0])
    assert path.status[0] == "not-closed" and "ties.far is open by 50" in why_not_closed(path)
    # Links that are too short, of which one turns freely meanwhile: sqrt(4^2 + 12^2) - 6 - 5 cm.
    path = crank_and_rocker(coupler=0.06).equilibrium([0.0])
    assert path.status[0] == "not-closed"
    assert "ties.loop is open by 16.5 mm" in why_not_closed(path)


@pytest.mark.parametrize(
    ("kind", "more", "said"),
    [
        ("glue", "", 'ties.bad.kind is "glue"'),
        ("pin", 'drive = "rotation"', 'ties.bad.drive is "rotation": a pin can be driven by "dis'),
        ("hinge", 'drive = "displacement"', 'a hinge can be driven by "rotation"'),
        ("weld", 'axis = "x"', "ties.bad.axis is given, but a weld without drive has none"),
        ("slider", "axis = [0.0, 0.0, 0.0]", "ties.bad.axis is zero"),
        ("slider", 'axis = "y"', "must lie in the x-z plane"),
        ("hinge", 'axis = "x"', 'ties.bad.axis is "x": in a planar model it must be y'),
        ("hinge", "axis = [1, 2, 0]", "ties.bad.axis is [1.0, 2.0, 0.0]: in a planar model"),
        ("pin", 'rotation = { y = "1 deg" }', "a pin holds no rotation"),
        ("weld", 'rotation = { x = "1 deg" }', "ties.bad.rotation.x"),
    ],
)
def test_bad_ties_are_refused(kind: str, more: str, said: str) -> None:
    with pytest.raises(InputError) as error:
        model(rod("beam", 0.2), tie("bad", kind, '"beam", at = "tip"', "world = {}", more))
    assert said in str(error.value)


def test_a_tie_of_a_body_to_itself_is_refused() -> None:
    with pytest.raises(InputError, match="same rigid link"):
        model(link("bar", 0.1), tie("self", "pin", '"bar", at = "tip"', '"bar", at = "base"'))
    with pytest.raises(InputError, match="the same place"):
        model(rod("beam", 0.1), tie("self", "pin", '"beam", at = "tip"', '"beam", at = "tip"'))
    with pytest.raises(InputError, match="one of two places that are tied is on a body"):
        model(link("bar", 0.1), tie("self", "pin", "world = {}", "world = {}"))
    fixed = link("bar", 0.1, joint='kind = "fixed"')
    with pytest.raises(InputError, match="same rigid body"):
        model(fixed, tie("self", "pin", '"bar", at = "tip"', "world = {}"))
    with pytest.raises(InputError, match='"motor" of the model "loop" is driven by a rotation'):
        _ = four_bar().evaluation_loads


@pytest.mark.parametrize("planar", [True, False])
def test_derivatives_agree_with_differences(planar: bool) -> None:
    strain = PLANAR if planar else SPATIAL
    made = model(
        rod("left", 0.2, f"placement = {{ {UP} }}", strain, 3),
        rod("top", 0.1, 'parent = "left"\nplacement = { rotation = { y = "80 deg" } }', strain, 2),
        rod("right", 0.19, f'placement = {{ x = "11 cm", {UP} }}', strain, 3),
        link("arm", 0.05, 'parent = "right"\nplacement = { rotation = { y = "10 deg" } }'),
        tie("corner", "weld", '"top", at = "tip"', '"arm", at = 0.4', 'drive = "rotation"'),
        tie("rail", "slider", '"top", at = 0.5', 'world = { x = "5 cm", z = "22 cm" }'),
        push("left", 'x = "0.2 N"'),
        planar=planar,
    )
    loads = np.array([[0.0, 0.0], [0.02, 0.3]])
    path = solved(made, loads)
    assert not path.events
    outputs, slots = made.engine.outputs, made.engine.slots
    n = max(stop for _, stop in outputs.values())
    wanted = [outputs["joints"][0], *range(*outputs["ties"]), *range(*outputs["rod_bending"])]
    wanted = [column for column in wanted if column != outputs["ties"][0] + 5]  # rail has no drive

    def values(parameters: np.ndarray, last: np.ndarray) -> np.ndarray:
        every = np.arange(made.parameters.size)
        found = made.engine.path(every, parameters[None], np.array([loads[0], last]), 1)
        assert (found["status"] == 0).all()
        ties = found["tie_loads"][0, 1]
        sizes = [[np.linalg.norm(each[:3]), np.linalg.norm(each[3:6]), each[6]] for each in ties]
        out = np.zeros(n)
        out[outputs["joints"][0]] = found["q"][0, 1, made.joint_columns[0]]
        out[slice(*outputs["ties"])] = np.ravel(sizes)
        out[slice(*outputs["rod_bending"])] = found["rod_bending"][0, 1]
        return out[wanted]

    chosen = {
        "left.length": [0], "top.length": [0], "arm.length": [0], "right.length": [0],
        "left.young_modulus": [0], "right.radius": [0], "right.translation": [0, 2],
        "top.rotation": [1], "arm.rotation": [1], "arm.radius_base": [0],
    }  # fmt: skip
    if not planar:
        chosen |= {"right.translation": [0, 1, 2], "top.rotation": [0, 1, 2]}
    indices = np.array([slots[name][0] + i for name, each in chosen.items() for i in each])
    rows = [
        Differential(((np.array([1]), weights(made, 1, {}) + np.eye(n)[column]),))
        for column in wanted
    ]
    slopes = differentiate(path.as_batch, rows, indices)
    p, last = made.parameters, loads[1]
    for k, index in enumerate(indices):
        h = 1e-4 * (abs(p[index]) or 1e-1)
        moved = [values(p + np.eye(len(p))[index] * s * h, last) for s in (-2, -1, 1, 2)]
        difference = (moved[0] - 8 * moved[1] + 8 * moved[2] - moved[3]) / (12 * h)
        exact = slopes.by_slots[0, :, k]
        scale = np.abs(values(p, last)) / (abs(p[index]) or 1.0) + np.abs(exact)
        assert (np.abs(difference - exact) <= 1e-6 * scale).all(), (k, difference, exact)
    for k in range(2):
        h = 1e-4
        moved = [values(p, last + np.eye(2)[k] * s * h) for s in (-2, -1, 1, 2)]
        difference = (moved[0] - 8 * moved[1] + 8 * moved[2] - moved[3]) / (12 * h)
        exact = slopes.by_loads[0, :, 1, k]
        assert (np.abs(difference - exact) <= 1e-6 * np.abs(exact).max()).all(), (k, exact)


def test_reactions_are_reported() -> None:
    path = solved(four_bar(), np.radians([0.0, 30.0]))
    shown = path.to_dict()["ties"]
    assert set(shown) == {"motor", "loop"} and set(shown["loop"]) == {"force", "moment"}
    assert shown["motor"]["drive"] == path.tie_drives()["motor"].tolist()
    np.testing.assert_allclose(
        np.linalg.norm(shown["loop"]["force"], axis=1), path.tie_forces()["loop"]
    )
    # Of a planar pin the moment vanishes, and so do all forces out of the plane.
    np.testing.assert_allclose(path.tie_loads[:, 1, [1, 3, 4, 5]], 0.0, atol=1e-15)


FOOT = """
name = "foot"
planar = {planar}
{gravity}
[bodies.foot]
kind = "link"
length = "1 cm"
radius = "2 mm"
{density}
joint = {{ {joint} }}
placement = {{ z = "{height} mm" }}
[spheres.sole]
points = [{{ body = "foot", at = "base" }}, {{ body = "foot", at = "tip" }}]
[obstacles.ground]
kind = "half-space"
normal = "z"
spheres = ["sole"]
stiffness = "10 kN/m"
[wrenches.push]
body = "foot"
at = "centroid"
force = {{ z = "-1 N" }}
input = true
"""


@pytest.mark.parametrize("planar", [True, False])
@pytest.mark.parametrize("weight", [False, True])
@pytest.mark.parametrize("gap", [0.0, 0.5, 5.0])
def test_a_guided_body_falls_on_the_ground_as_one_on_a_joint(
    planar: bool, weight: bool, gap: float
) -> None:
    """Nothing but the ground has stiffness, and steps to it are long and rejected at first."""
    height = 2.0 + gap

    def foot(joint: str) -> str:
        return FOOT.format(
            planar=str(planar).lower(),
            gravity='gravity = { z = "-9.81 m/s^2" }' if weight else "",
            density='density = "1000 kg/m^3"' if weight else "",
            joint=joint,
            height=height,
        )

    guide = tie(
        "guide", "slider", f'world = {{ z = "{height} mm" }}', '"foot", at = "base"', 'axis = "z"'
    )
    loads = [0.0, 0.5, 1.0]
    free = solved(Model(parse(foot('kind = "free"') + guide)), loads)
    jointed = Model(parse(foot('kind = "prismatic", axis = "z"'))).equilibrium(loads)
    assert free.stable[1:].all() and jointed.stable[1:].all()
    np.testing.assert_allclose(
        free.obstacle_forces()["ground"][1:], jointed.obstacle_forces()["ground"][1:], rtol=1e-8
    )
    assert free.iterations.sum() < 200


def twisted_platform(more: str = "") -> Model:
    """Return a platform on two rods, one of which is twisted at its base."""

    def twin(name: str, y: int) -> str:
        place = f'joint.kind = "free"\nplacement = {{ y = "{y} mm" }}'
        slender = rod(name, 0.15, place, SPATIAL.replace("quadratic", "linear"), elements=8)
        return slender.replace('"1 mm"', '"3 mm"').replace("0.3\n", "0.45\n")

    return model(
        twin("left", -30),
        twin("right", 30),
        link("platform", 0.02, 'placement = { x = "150 mm" }', 'kind = "free"'),
        tie(
            "twist",
            "hinge",
            'world = { y = "-30 mm" }',
            '"left", at = "base"',
            'axis = "x"\ndrive = "rotation"',
        ),
        tie(
            "left_end",
            "weld",
            '"left", at = "tip"',
            '"platform", at = "base", offset = { y = "-30 mm" }',
        ),
        tie("clamp", "weld", 'world = { y = "30 mm" }', '"right", at = "base"'),
        tie(
            "right_end",
            "pin",
            '"right", at = "tip"',
            '"platform", at = "base", offset = { y = "30 mm" }',
        ),
        more,
        planar=False,
    )


def test_a_platform_snaps_as_one_of_its_rods_is_twisted() -> None:
    """Weak penalties of ties lead from one unstable state to another, and not beyond."""
    path = solved(twisted_platform(), "0:900:45 deg")
    assert path.stable.all()
    # The path beyond one turn and the snap of it repeats that before.
    first, second = (float(event.loads[0]) for event in path.events)
    assert second - first == pytest.approx(2.0 * np.pi, rel=1e-6)


def test_a_loaded_platform_snaps_as_one_of_its_rods_is_twisted() -> None:
    """A moment has no potential: beyond the end of the branch the motion is overdamped."""
    load = """
[wrenches.load]
body = "platform"
at = "tip"
force = { x = "15 N", y = "10 N", z = "-15 N" }
moment = { x = "0.3 N*m", y = "0.6 N*m" }
"""
    path = solved(twisted_platform(load), "0:270:45 deg")
    assert path.stable.all()
    assert [event.kind for event in path.events] == ["snap"]


def test_a_path_that_stalls_with_an_open_tie_names_it() -> None:
    path = solved(four_bar(), [0.0, 0.1])
    status, gaps = path.status.copy(), path.tie_gaps.copy()
    status[1] = "stalled"
    stalled = replace(path, status=status)
    assert why_stalled(stalled).endswith("which is not a stable equilibrium")
    gaps[1, 1] = 2e-3, 0.0
    name = path.model.ties[1]
    said = why_stalled(replace(stalled, tie_gaps=gaps))
    assert said == f"forces balance, but ties.{name} is open by 2 mm in the last state"
    by_arc_length = replace(stalled, tie_gaps=gaps, followed=None)
    assert why_stalled(by_arc_length).endswith("no equilibrium was found beyond it")
