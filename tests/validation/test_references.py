"""The references themselves, against plain quadrature and integration."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import quad, solve_ivp

from .boundary_value import StrongForm
from .elliptic import first, second
from .test_cantilever import elliptic, follower
from .test_elastica import elastica
from .test_sections import rectangle


@pytest.mark.parametrize("m", [0.0, 0.3, 0.7499999999999999, 0.97])
@pytest.mark.parametrize("phi", [0.0, 0.1, 1.1337796627061758, np.pi / 2.0, 2.0, 4.5, -1.0])
def test_elliptic_integrals(phi: float, m: float) -> None:
    def root(t: float) -> float:
        return float(np.sqrt(1.0 - m * np.sin(t) ** 2))

    assert first(phi, m) == pytest.approx(quad(lambda t: 1.0 / root(t), 0.0, phi)[0], abs=1e-12)
    assert second(phi, m) == pytest.approx(quad(root, 0.0, phi)[0], abs=1e-12)


def _integrated(curvature: float, slope_of_curvature) -> np.ndarray:
    """Integrate x, deflection, θ and θ′ from the clamp; L = 1."""

    def rate(_: float, state: np.ndarray) -> list[float]:
        theta = state[2]
        return [np.cos(theta), np.sin(theta), state[3], slope_of_curvature(theta)]

    start = [0.0, 0.0, 0.0, curvature]
    return solve_ivp(rate, (0.0, 1.0), start, method="DOP853", rtol=1e-12, atol=1e-13).y[:, -1]


@pytest.mark.parametrize("alpha", [0.25, 2.0, 10.0])
def test_cantilever(alpha: float) -> None:
    positions, slope, curvature = elliptic(alpha, np.array([0.0, 1.0]))
    tip = _integrated(curvature[0], lambda theta: -alpha * np.cos(theta))
    np.testing.assert_allclose(tip, [*positions[1], slope[1], 0.0], atol=1e-9)


@pytest.mark.parametrize(("angle", "waves"), [(0.5, 1), (2.5, 1), (1.0, 3)])
def test_elastica(angle: float, waves: int) -> None:
    load, positions, curvature = elastica(angle, np.array([0.0, 1.0]), waves)
    push = load * np.pi**2 / 4.0
    tip = _integrated(curvature[0], lambda theta: -push * np.sin(theta))
    expected = [*positions[1], angle if waves == 1 else -angle, 0.0]
    np.testing.assert_allclose(tip, expected, atol=1e-9)


def test_strong_form_bends_a_rod_to_an_arc() -> None:
    """A moment at the tip alone: EI κ = M, twice around."""
    form = StrongForm(
        1.0,
        lambda s: np.ones((6, len(s))),
        lambda s: np.zeros((3, len(s))),
        lambda s: (np.zeros((3, len(s))), np.zeros((3, len(s)))),
    )
    solution = form.solve(0.0, np.zeros(3), np.array([0.0, 2.0, 0.0]))
    (tip,) = solution.poses(np.array([1.0]))
    np.testing.assert_allclose(tip[:3, 3], [np.sin(2) / 2, 0.0, (np.cos(2) - 1) / 2], atol=1e-7)


def test_strong_form_inverts_the_law_of_the_section() -> None:
    random = np.random.default_rng(3)
    stiffness, offset = random.uniform(1.0, 3.0, 6), np.array([0.0, 0.2, -0.1])
    slope, tension = np.array([0.0, 0.1, 0.3]), 0.4
    form = StrongForm(
        1.0,
        lambda s: np.repeat(stiffness[:, None], len(s), axis=1),
        lambda s: np.zeros((3, len(s))),
        lambda s: tuple(np.repeat(v[:, None], len(s), axis=1) for v in (offset, slope)),
    )
    strain = np.array([0.3, -0.2, 0.1, 1.1, 0.05, -0.1])
    tangent = strain[3:] + np.cross(strain[:3], offset) + slope
    unit = tangent / np.linalg.norm(tangent)
    wrench = stiffness * (strain - [0, 0, 0, 1, 0, 0])
    wrench += tension * np.concatenate([np.cross(offset, unit), unit])
    found = form.strain(np.zeros(1), wrench[:, None], tension)
    np.testing.assert_allclose(found[:, 0], strain, atol=1e-13)


@pytest.mark.parametrize("alpha", [0.5, 4.0, 13.0])
def test_cantilever_under_a_following_load(alpha: float) -> None:
    positions, slope = follower(alpha, np.array([0.0, 0.3, 1.0]))
    tip = slope[-1]
    # L² θ″ = -α cos(θ - θ_tip), and the curvature at the clamp balances the load there.
    clamp = np.sqrt(2.0 * alpha * np.sin(tip))
    found = _integrated(clamp, lambda theta: -alpha * np.cos(theta - tip))
    np.testing.assert_allclose(found, [*positions[-1], tip, 0.0], atol=1e-8)


def test_torsion_of_a_square() -> None:
    """Timoshenko and Goodier, Theory of Elasticity, § 109: 0.1406 a⁴."""
    assert rectangle(1.0, 1.0) == pytest.approx(0.1406, abs=5e-5)
    assert rectangle(2.0, 1.0) == pytest.approx(0.229 * 2.0, abs=2e-3)
