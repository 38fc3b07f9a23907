"""Random platforms on rods: what must hold whatever the ties are."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from flexor.model import Model, Path, parse

Vector = NDArray[np.float64]
KINDS = ("weld", "pin", "hinge", "slider")


def turn(vector: Vector) -> NDArray[np.float64]:
    """Return the matrix of a rotation vector."""
    angle = float(np.linalg.norm(vector))
    x, y, z = vector / angle
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.asarray(np.eye(3) + np.sin(angle) * cross + (1.0 - np.cos(angle)) * cross @ cross)


def rotation_vector(matrix: NDArray[np.float64]) -> Vector:
    """Return the rotation vector of a matrix, by the eigenvector of its axis."""
    if np.abs(matrix - np.eye(3)).max() < 1e-12:
        return np.zeros(3)
    values, vectors = np.linalg.eig(matrix)
    axis = np.real(vectors[:, np.argmin(np.abs(values - 1.0))])
    angle = np.arccos(np.clip((np.trace(matrix) - 1.0) / 2.0, -1.0, 1.0))
    found = axis * angle
    return found if np.abs(turn(found) - matrix).max() < 1e-9 else -found


def table(vector: Vector, unit: str) -> str:
    return (
        "{ "
        + ", ".join(f'{k} = "{x:.17g} {unit}"' for k, x in zip("xyz", vector, strict=True))
        + " }"
    )


def platform(
    seed: int,
    moved: tuple[NDArray[np.float64], Vector] = (np.eye(3), np.zeros(3)),
    size: float = 1.0,
    modulus: float = 1.0,
) -> Path:
    """Return a link on three rods in random places, with random ties, under a random force.

    All of it may be rotated and translated, and have another size and modulus.
    """
    random = np.random.default_rng(seed)
    rotation, translation = moved
    text = 'name = "platform"\n'
    centre = size * np.array([0.0, 0.0, 0.2])
    for i in range(3):
        angle = 2.0 * np.pi * i / 3.0 + random.uniform(-0.3, 0.3)
        base = size * 0.08 * np.array([np.cos(angle), np.sin(angle), 0.0])
        up = turn(np.array([0.0, -np.pi / 2.0, 0.0]))
        frame = turn(random.uniform(-0.2, 0.2, 3)) @ up
        place = size * random.uniform(-0.03, 0.03, 3)
        kind = KINDS[random.integers(4)]
        axis = random.normal(size=3)
        axed = f"axis = {axis.tolist()}" if kind in ("hinge", "slider") else ""
        text += f"""
[bodies.rod{i}]
kind = "rod"
length = "{0.2 * size!r} m"
radius = "{0.004 * size!r} m"
young_modulus = "{1e6 * modulus!r} Pa"
poisson_ratio = 0.4
elements = 2
gauss_points = 3
strain.twist_x = "nodal_linear"
strain.bend_y = "nodal_quadratic"
strain.bend_z = "nodal_quadratic"
strain.extend_x = "nodal_linear"
[bodies.rod{i}.placement]
rotation = {table(rotation_vector(rotation @ frame), "rad")}
"""
        for k, x in zip("xyz", rotation @ base + translation, strict=True):
            text += f'{k} = "{x:.17g} m"\n'
        text += f"""
[ties.tie{i}]
kind = "{kind}"
first = {{ body = "platform", at = "base", offset = {table(place, "m")} }}
second = {{ body = "rod{i}", at = "tip" }}
{axed}
"""
    force = rotation @ random.normal(size=3) * 0.02 * modulus * size**2
    text += f"""
[bodies.platform]
kind = "link"
length = "{0.02 * size!r} m"
radius = "{0.01 * size!r} m"
joint = {{ kind = "free" }}
[bodies.platform.placement]
rotation = {table(rotation_vector(rotation), "rad")}
"""
    for k, x in zip("xyz", rotation @ centre + translation, strict=True):
        text += f'{k} = "{x:.17g} m"\n'
    text += f"""
[wrenches.push]
body = "platform"
at = "tip"
force = {table(force, "N")}
input = true
"""
    path = Model(parse(text)).equilibrium([0.0, 1.0])
    assert path.converged.all() and path.stable.all(), (path.status, path.stability)
    assert path.tie_gaps[..., 0].max() < 1e-8 * size and path.tie_gaps[..., 1].max() < 1e-8
    return path


@pytest.mark.parametrize("seed", range(6))
def test_reactions_balance_the_load(seed: int) -> None:
    path = platform(seed)
    frames = path.frames(1)
    tip = frames["platform"][-1, :3, 3]
    load = np.array(path.model.file.wrenches["push"].force.components)
    forces, moments = path.tie_loads[1, :, :3], path.tie_loads[1, :, 3:6]
    np.testing.assert_allclose(forces.sum(axis=0), load, atol=1e-8 * np.linalg.norm(load))
    # About the tip of the platform; what acts on the rods acts on it the other way.
    ends = np.array([frames[f"rod{i}"][-1, :3, 3] for i in range(3)])
    total = moments.sum(axis=0) + np.cross(ends - tip, forces).sum(axis=0)
    np.testing.assert_allclose(total, 0.0, atol=1e-8 * np.linalg.norm(load) * 0.2)
    # A pin has no moment, a hinge none about its axis and a slider no force along its own.
    for i, tie in enumerate(path.model.file.ties.values()):
        axis = frames["platform"][0, :3, :3] @ tie.direction
        if tie.kind == "pin":
            np.testing.assert_allclose(moments[i], 0.0, atol=1e-12)
        elif tie.kind == "hinge":
            assert abs(moments[i] @ axis) < 1e-9 * (np.linalg.norm(moments[i]) + 1e-3)
        elif tie.kind == "slider":
            assert abs(forces[i] @ axis) < 1e-9 * np.linalg.norm(forces[i])


@pytest.mark.parametrize("seed", range(4))
def test_nothing_depends_on_the_frame(seed: int) -> None:
    rotation, translation = turn(np.array([0.4, -1.1, 0.7])), np.array([0.3, -0.2, 0.5])
    here, there = platform(seed), platform(seed, (rotation, translation))
    for part in (slice(0, 3), slice(3, 6)):
        expected = here.tie_loads[..., part] @ rotation.T
        np.testing.assert_allclose(there.tie_loads[..., part], expected, rtol=1e-6, atol=1e-9)


@pytest.mark.parametrize("seed", range(4))
def test_nothing_depends_on_units(seed: int) -> None:
    here, there = platform(seed), platform(seed, size=40.0, modulus=1e-4)
    force = 1e-4 * 40.0**2
    for part, unit in ((slice(0, 3), force), (slice(3, 6), force * 40.0)):
        found = there.tie_loads[..., part] / unit
        np.testing.assert_allclose(found, here.tie_loads[..., part], rtol=1e-6, atol=1e-9)
    assert here.iterations.tolist() == there.iterations.tolist()
