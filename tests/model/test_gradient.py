"""Exact derivatives against central differences of whole paths, for every parameter set."""

from __future__ import annotations

import numpy as np
import pytest

from flexor.design import parameter_set
from flexor.errors import InputError
from flexor.model import Model, Paths, load
from flexor.objectives import objective

SETS = ("L", "R01", "Rsc", "RLP", "L+R01", "L+Rsc", "L+RLP")
# A path of its own for each step, and tighter than by default: differences divide what is left.
TIGHT = {"tolerance": 1e-12}
STEP = 1e-5
# Sixth order.
STENCIL = {1: 45 / 60, 2: -9 / 60, 3: 1 / 60, -1: -45 / 60, -2: 9 / 60, -3: -1 / 60}


@pytest.fixture(scope="module")
def finger() -> Model:
    return load("finger", "calibrated")


def last(batch: Paths) -> np.ndarray:
    return np.concatenate((batch.joint_angles[:, -1], batch.tip_force[:, -1:]), axis=1)


@pytest.mark.parametrize("name", SETS)
def test_derivatives_are_those_of_differences(name: str, finger: Model) -> None:
    model = finger
    chosen = parameter_set(name, model.design)
    span = chosen.upper - chosen.lower
    p = chosen.lower + span * np.random.default_rng(11).uniform(0.05, 0.95, (10, chosen.size))
    here = model.evaluate(chosen.geometry(p, model.X), gradient=True, **TIGHT)
    exact = here.chained(chosen.jacobian(p, model.X)) * span
    assert exact.shape == (10, 4, chosen.size)
    smooth = np.repeat((here.regularity == "regular")[:, None], chosen.size, axis=1)
    differences = np.zeros_like(exact)
    thin = chosen.geometry(p, model.X).radius <= model.design.minimum_radius
    for k in range(chosen.size):
        for at, weight in STENCIL.items():
            moved = p.copy()
            moved[:, k] += at * STEP * span[k]
            geometry = chosen.geometry(moved, model.X)
            batch = model.evaluate(geometry, **TIGHT)
            differences[:, :, k] += weight * last(batch) / STEP
            smooth[:, k] &= batch.pairs[:, -1] == here.pairs[:, -1]
            smooth[:, k] &= (thin == (geometry.radius <= model.design.minimum_radius)).all(axis=1)
            smooth[:, k] &= batch.event_count == here.event_count
    assert smooth.mean() > 0.4
    size = np.abs(exact).max(axis=(1, 2), keepdims=True)
    error = np.abs(exact - differences).max(axis=1) / np.maximum(size[:, 0], 1e-9)
    assert error[smooth].max() < 1e-6


def test_a_base_on_its_underside_moves_with_its_surface(finger: Model) -> None:
    chosen = parameter_set("L+Rsc", finger.design)
    p = chosen.start[None] + 0.1
    jacobian = finger.geometry_slot_jacobian(chosen.jacobian(p, finger.X))[0]
    for k in range(chosen.size):
        values = []
        for sign in (1.0, -1.0):
            moved = p.copy()
            moved[:, k] += sign * 1e-6
            values.append(finger.geometry_slots(chosen.geometry(moved, finger.X))[1][0])
        np.testing.assert_allclose((values[0] - values[1]) / 2e-6, jacobian[:, k], atol=1e-9)


def test_values_do_not_depend_on_whether_they_are_differentiated(finger: Model) -> None:
    chosen = parameter_set("L+R01", finger.design)
    p = chosen.lower + (chosen.upper - chosen.lower) * np.random.default_rng(2).random((30, 3))
    geometry = chosen.geometry(p, finger.X)
    plain, differentiated = finger.evaluate(geometry), finger.evaluate(geometry, gradient=True)
    np.testing.assert_array_equal(plain.q, differentiated.q)
    assert plain.gradient is None
    one = finger.evaluate(geometry, gradient=True, threads=1)
    np.testing.assert_array_equal(one.gradient, differentiated.gradient)
    assert differentiated.regularity is not None
    snapped = differentiated.event_count > 0
    np.testing.assert_array_equal(differentiated.regularity == "snapped", snapped)
    with pytest.raises(InputError, match="evaluate them with gradient=True"):
        plain.chained(chosen.jacobian(p, finger.X))


def test_a_first_load_that_is_not_zero_changes_nothing(finger: Model) -> None:
    chosen = parameter_set("R01", finger.design)
    geometry = chosen.geometry(chosen.start, finger.X)
    paths = [finger.evaluate(geometry, force, gradient=True) for force in ([0, 2], [2])]
    np.testing.assert_array_equal(paths[0].gradient, paths[1].gradient)


def test_objectives_chain_their_gradients_and_residuals(finger: Model) -> None:
    chosen, step = parameter_set("R01", finger.design), 1e-7
    p = np.array([[0.0088, 0.0062]])

    def at(p: np.ndarray, gradient: bool = False) -> Paths:
        return finger.evaluate(chosen.geometry(p, finger.X), gradient=gradient, tolerance=1e-12)

    here = at(p, gradient=True)
    assert here.regularity is not None
    assert here.regularity[0] == "regular"
    derivatives = here.chained(chosen.jacobian(p, finger.X))
    for name in ("f_b", "f_bc", "bending-contact-printed"):
        wanted = objective(name)
        gradient = wanted.gradient(here).chained(derivatives)[0]
        jacobian = wanted.residual_gradient(here).chained(derivatives)[0]
        for k in range(2):
            shift = step * np.eye(2)[k]
            up, down = at(p + shift), at(p - shift)
            assert up.touching[0, -1] == down.touching[0, -1]
            slope = (wanted.value(up) - wanted.value(down))[0] / (2 * step)
            column = (wanted.residual(up) - wanted.residual(down))[0] / (2 * step)
            assert gradient[k] == pytest.approx(slope, rel=1e-5)
            np.testing.assert_allclose(jacobian[:, k], column, rtol=1e-4, atol=1e-4)


def test_a_gradient_at_earlier_loads_is_refused(finger: Model) -> None:
    from flexor.objectives import PathGradient

    angles = np.zeros((1, 6, 3))
    angles[0, 2, 0] = 1.0
    with pytest.raises(InputError, match="loads before the last"):
        PathGradient(angles, np.zeros((1, 6))).chained(np.ones((1, 4, 2)))
