"""Compressed springs and contacts that are pushed through themselves snap at their load."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from flexor.model import Model, parse

SLIDE = """
name = "slide"
planar = true
[bodies.a]
kind = "link"
length = "1 m"
radius = "0.2 m"
joint = { kind = "prismatic", axis = "z", stiffness = "1 N/m" }
[wrenches.w]
body = "a"
at = "tip"
force = { z = "1 N" }
input = true
"""
SPRING = """
[springs.s]
first = { body = "a", at = "tip" }
second = { world = { x = "1 m" } }
stiffness = "10 N/m"
rest_length = "0.3 m"
"""
SPHERES = """
[bodies.b]
kind = "link"
length = "1 m"
radius = "0.2 m"
placement = { z = "0.5 m" }
[spheres.a]
points = [{ body = "a", at = "tip" }]
[spheres.b]
points = [{ body = "b", at = "tip" }]
[contacts.c]
first = "a"
second = "b"
stiffness = "10 N/m"
"""
UP_AND_DOWN = [*np.linspace(0, 5, 6), *np.linspace(4, -5, 10), *np.linspace(-4, 5, 10)]


@pytest.mark.parametrize("loads", [[0, -2.9, -3.1], [0, 5, 0, -2.9, -3.1, -4], UP_AND_DOWN])
def test_a_spring_snaps_through_its_own_anchor(loads: Any) -> None:
    # ½z² + 5(|z| − 0.3)² − Fz: the branch ends at z = 0, F = ∓3, and the other begins at ∓6/11.
    path = Model(parse(SLIDE + SPRING)).equilibrium(loads)
    assert path.converged.all()
    ends = [-3.0, 3.0] if loads is UP_AND_DOWN else [-3.0]
    assert [event.kind for event in path.events] == ["snap"] * len(ends)
    assert [event.force for event in path.events] == pytest.approx(ends, rel=1e-4)
    assert path.q[-1, 0] == pytest.approx((loads[-1] + np.sign(loads[-1]) * 3.0) / 11.0, abs=1e-9)


@pytest.mark.parametrize("loads", [[0, 6], [0, 4.49, 4.51], np.linspace(0, 6, 30)])
def test_a_sphere_snaps_through_another(loads: Any) -> None:
    path = Model(parse(SLIDE + SPHERES)).equilibrium(loads)
    assert path.converged.all()
    assert [event.kind for event in path.events] == ["snap"]
    assert path.events[0].force == pytest.approx(4.5, rel=1e-3)
    assert path.q[-1, 0] == pytest.approx(loads[-1], abs=1e-9)


TRUSS = """
name = "truss"
planar = true
[bodies.c]
kind = "link"
length = "1 mm"
radius = "1 mm"
placement = { x = "-2 mm", z = "0.3 m" }
joint = { kind = "prismatic", axis = "x" }
[bodies.node]
kind = "link"
parent = "c"
length = "1 mm"
radius = "1 mm"
joint = { kind = "prismatic", axis = "z" }
[springs.l]
stiffness = "1000 N/m"
rest_length = "0.31622776601683794 m"
first = { body = "node", at = "tip" }
second = { world = { x = "-10 cm" } }
[springs.r]
stiffness = "1000 N/m"
rest_length = "0.31622776601683794 m"
first = { body = "node", at = "tip" }
second = { world = { x = "10 cm" } }
[wrenches.push]
body = "node"
at = "tip"
input = true
force = { z = "-1 N" }
"""


@pytest.mark.parametrize("steps", [2, 3, 7, 30])
def test_a_steep_truss_leaves_its_plane_of_symmetry(steps: int) -> None:
    # The lateral stiffness 2k(1 − l₀/l + l₀a²/l³) vanishes at 78.3498 N, far below the limit load.
    path = Model(parse(TRUSS)).equilibrium(np.linspace(0.0, 300.0, steps))
    assert path.converged.all()
    assert [event.kind for event in path.events] == ["snap"]
    assert path.events[0].force == pytest.approx(78.3498, rel=1e-2)
