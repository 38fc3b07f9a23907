"""The adapter of an independent suite, `benchmarks/cosserat.py`, without the suite itself."""

from __future__ import annotations

import importlib
from dataclasses import dataclass, replace
from enum import Enum
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.optimize import brentq

BENCHMARKS = Path(__file__).resolve().parents[2] / "benchmarks"
Points = tuple[tuple[float, float, float], ...]


class Condition(Enum):
    FREE = "free"
    PINNED = "pinned"
    CLAMPED = "clamped"


class End(Enum):
    START = "start"
    END = "end"


@dataclass(frozen=True)
class Material:
    youngs_modulus: float = 1e6
    shear_modulus: float = 1e6 / 3.0
    density: float = 1000.0


@dataclass(frozen=True)
class Rod:
    centerline: Points
    radius: float
    start: Condition
    end: Condition
    loads: tuple[Any, ...] = ()
    end_motion: Any = None
    normal: tuple[float, float, float] = (0.0, 1.0, 0.0)
    material: Material = Material()
    rest_arc_length: tuple[float, ...] | None = None
    start_motion: Any = None

    @property
    def bending(self) -> float:
        return float(1e6 * np.pi / 4.0 * self.radius**4)


@pytest.fixture
def rods(monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    monkeypatch.syspath_prepend(str(BENCHMARKS))
    return importlib.import_module("_cosserat_model")


def load(x: float, z: float) -> SimpleNamespace:
    return SimpleNamespace(force=(x, 0.0, z), at=End.END)


def along(*points: NDArray[np.float64]) -> Points:
    return tuple((float(x), float(y), float(z)) for x, y, z in np.stack(points, axis=1))


def twisted(tension: float, turn: float, wave: float = 0.0) -> Rod:
    """A clamped rod, drawn by ``tension`` EI/L^2, whose end slides and turns."""
    s = np.linspace(0.0, 1.0, 101)
    line = along(s, wave * (1.0 - np.cos(2.0 * np.pi * s)), 0.0 * s)
    motion = SimpleNamespace(
        times=(0.0, 1.0),
        displacement=((0.0, 0.0, 0.0),) * 2,
        rotation=((0.0, 0.0, 0.0), (turn, 0.0, 0.0)),
        slides_along=(1.0, 0.0, 0.0),
    )
    clamped = Rod(line, 0.01, Condition.CLAMPED, Condition.CLAMPED, end_motion=motion)
    return replace(clamped, normal=(0.0, 0.0, 1.0), loads=(load(tension * clamped.bending, 0.0),))


def test_a_cantilever_deflects_as_a_beam(rods: ModuleType) -> None:
    ends = ((0.0, 0.0, 0.0), (1.0, 0.0, 0.0))
    rod = Rod(ends, 0.02, Condition.CLAMPED, Condition.FREE, loads=(load(0.0, -1e-4),))
    model, start = rods.build(rod, (0.0, 0.0, 0.0), 20)
    path = model.equilibrium(np.zeros((1, 0)), start=start)
    nodes, across = rods.placed(path[-1])
    # Timoshenko's beam, whose shear is carried by the whole area.
    area = np.pi * rod.radius**2
    expected = 1e-4 * (1.0 / (3.0 * rod.bending) + 1.0 / (rod.material.shear_modulus * area))
    assert -nodes[-1, 2] == pytest.approx(expected, rel=3e-4)
    np.testing.assert_allclose(across, [(0.0, 1.0, 0.0)] * 20, atol=1e-12)


@pytest.mark.parametrize("turn", [0.0, 0.7])
def test_a_cable_hangs_as_an_elastic_catenary(rods: ModuleType, turn: float) -> None:
    # It begins as an arc of a circle, in a plane through the vertical that is turned by `turn`.
    span, radius = 0.8, 0.002
    half = brentq(lambda a: np.sin(a) / a - span, 1e-9, np.pi)
    angles = np.linspace(-half, half, 301)
    x, z = (span + np.sin(angles) / half) / 2.0, (np.cos(half) - np.cos(angles)) / (2.0 * half)
    line = along(np.cos(turn) * x, np.sin(turn) * x, z)
    pinned = Rod(line, radius, Condition.PINNED, Condition.PINNED)
    rod = replace(pinned, normal=(-float(np.sin(turn)), float(np.cos(turn)), 0.0))
    model, start = rods.build(rod, (0.0, 0.0, -9.81), 60)
    path = model.equilibrium(np.zeros((1, 0)), start=start)
    assert path.stable.all() and path.tie_gaps.max() < 1e-8
    nodes, _ = rods.placed(path[-1])
    axial, weight = 1e6 * np.pi * radius**2, 1000.0 * 9.81 * np.pi * radius**2
    s = np.linspace(0.0, 1.0, 61)

    def across(tension: float) -> NDArray[np.float64]:
        hang = np.arcsinh((weight * s - weight / 2.0) / tension) + np.arcsinh(
            weight / 2.0 / tension
        )
        return np.asarray(tension * s / axial + tension / weight * hang)

    tension = brentq(lambda force: across(force)[-1] - span, 1e-3 * weight, 1e3 * weight)
    slope = np.hypot(tension, weight * (s - 0.5)) - np.hypot(tension, weight / 2.0)
    down = weight * (s**2 - s) / (2.0 * axial) + slope / weight
    expected = np.stack([np.cos(turn) * across(tension), np.sin(turn) * across(tension), down])
    # The cable bends over a length of sqrt(EI / tension), 6 mm, at its ends.
    np.testing.assert_allclose(nodes, expected.T, atol=3e-4)


@pytest.mark.parametrize("tension", [1.0, 30.0])
def test_a_rod_under_tension_buckles_when_it_is_twisted(rods: ModuleType, tension: float) -> None:
    # Clamped: B w'''' - i M w''' - T w'' = 0 and w = w' = 0 at both ends, as Greenhill's.
    def determinant(moment: float) -> float:
        root = np.sqrt(complex(4.0 * tension - moment**2))
        one, two = (1j * moment + root) / 2.0, (1j * moment - root) / 2.0
        rows = [(1, 0, 1, 1), (0, 1, one, two)]
        rows += [(1, 1, np.exp(one), np.exp(two)), (0, 1, one * np.exp(one), two * np.exp(two))]
        phase = np.exp(-0.5j * moment)
        return float((np.linalg.det(np.array(rows)) / (one - two) * phase).real)

    grid = np.linspace(2.0 * np.sqrt(tension) + 1e-3, 40.0, 2000)
    signs = np.sign([determinant(each) for each in grid])
    first = int(np.flatnonzero(np.diff(signs))[0])
    critical = brentq(determinant, grid[first], grid[first + 1]) * 1e6 / (2.0 * 1e6 / 3.0)
    twist = importlib.import_module("_cosserat_twist")
    assert twist.critical_twist(twisted(tension, critical, 1e-4), 20) == pytest.approx(
        critical, rel=1e-3
    )
    assert np.isnan(twist.critical_twist(twisted(tension, 0.5 * critical), 20))


def test_a_driven_end_turns_and_slides(rods: ModuleType) -> None:
    rod = twisted(1.0, 2.0)
    model, start = rods.build(rod, (0.0, 0.0, 0.0), 10)
    loads = rods.driven(rod.end_motion, np.array([0.25, 0.5, 9.0]))
    np.testing.assert_allclose(loads, [0.5, 1.0, 2.0])
    nodes, across = rods.placed(model.equilibrium(loads, start=start)[-1])
    stretch = rod.bending / (1e6 * np.pi * rod.radius**2)
    assert nodes[-1, 0] - 1.0 == pytest.approx(stretch, rel=1e-2)
    # The middle of the last element has turned by 19/20 of the end's rotation.
    assert np.arctan2(-across[-1, 1], across[-1, 2]) == pytest.approx(1.9, rel=1e-6)


def test_a_pinned_rod_spins_with_its_clamped_end(rods: ModuleType) -> None:
    rod = replace(twisted(1.0, 0.5), start=Condition.PINNED)
    model, start = rods.build(rod, (0.0, 0.0, 0.0), 10)
    path = model.equilibrium(np.array([0.5]), start=start)
    _, across = rods.placed(path[-1])
    expected = [(0.0, -np.sin(0.5), np.cos(0.5))] * 10
    np.testing.assert_allclose(across, expected, atol=1e-9)


def test_two_beams_that_cross_push_each_other_apart(rods: ModuleType) -> None:
    # Both sag alike; pins that are too close by 1e-5 m bend each beam by half of that.
    crossing = importlib.import_module("_cosserat_crossing")
    ends = [-0.5, 0.0, 0.0], [0.5, 0.0, 0.0]
    low = Rod(along(*np.transpose(ends)), 0.02, Condition.PINNED, Condition.PINNED)
    turned = np.array([[y, x, z + 0.04 - 1e-5] for x, y, z in ends])
    high = replace(low, centerline=along(*turned.T), normal=(1.0, 0.0, 0.0))
    states, force = crossing.crossed(low, high, (0.0, 0.0, -1e-3), 11)
    area = np.pi * low.radius**2
    yielding = 1.0 / (48.0 * low.bending) + 1.0 / (4.0 * low.material.shear_modulus * area)
    assert force == pytest.approx(0.5e-5 / yielding, rel=1e-3)
    apart = rods.middle(states[1]) - rods.middle(states[0])
    np.testing.assert_allclose(apart, [0.0, 0.0, 0.04], atol=1e-9)
    clear = replace(high, centerline=along(*np.transpose(turned + np.array([0.0, 0.0, 1.0]))))
    with pytest.raises(RuntimeError, match="clear of each other"):
        crossing.crossed(low, clear, (0.0, 0.0, -1e-3), 11)


def test_a_rope_over_a_cylinder_is_held_by_friction(rods: ModuleType) -> None:
    # 8 cm and 12 cm hang down: a ratio of 1.5, where friction holds e^(0.3 pi) = 2.57 and more.
    capstan = importlib.import_module("_cosserat_capstan")
    turn = np.linspace(0.0, np.pi, 61)
    x = np.concatenate([[-0.051], -0.051 * np.cos(turn), [0.051]])
    z = np.concatenate([[-0.08], 0.051 * np.sin(turn), [-0.12]])
    rope = Rod(along(x, 0.0 * x, z), 1e-3, Condition.FREE, Condition.FREE)
    post = SimpleNamespace(center=(0.0, 0.0, 0.0), radius=0.05, friction=0.3)
    scenario = SimpleNamespace(rods=(rope,), obstacles=(post,), gravity=(0.0, 0.0, -9.81))
    laid = capstan.laid(scenario, 40)
    path = laid.path
    assert path.stable.all()
    weight = 1000.0 * np.pi * 1e-6 * rods.shape(rope, 40).length * 9.81
    # What pushes on the rope is the normal force of each point and friction along the cylinder.
    normal, tangential = path.contact_forces(0), path.friction_forces(0)
    up = float(np.sum(normal.force[:, -1]) + np.sum(tangential.force[:, -1]))
    assert abs(up) == pytest.approx(weight, rel=1e-6)
    # It stretches by up to 4e-4, and nothing else moves it.
    assert abs(rods.in_plane(path[-1])[0, 2] - laid.nodes[0, 2]) < 1e-4


def test_what_is_not_static_or_not_modelled_is_refused(rods: ModuleType) -> None:
    with pytest.raises(NotImplementedError, match="start of a rod is free"):
        rods.build(replace(twisted(1.0, 1.0), start=Condition.FREE), (0.0, 0.0, 0.0), 5)
    rod = twisted(1.0, 1.0)
    rod.end_motion.displacement = ((0.0, 0.0, 0.0), (0.0, 0.1, 0.0))
    with pytest.raises(NotImplementedError, match="one rotation or displacement"):
        rods.build(rod, (0.0, 0.0, 0.0), 5)
