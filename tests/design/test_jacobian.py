"""Exact Jacobians of the maps against independent finite differences."""

from __future__ import annotations

import numpy as np
import pytest

from flexor.design import GeometryJacobian, ParameterSet, parameter_set

ALL = ["L", "R01", "Rsc", "RLP", "L+R01", "L+Rsc", "L+RLP", "RLP+L"]
X = np.linspace(0.0, 1.0, 23)


def differences(chosen: ParameterSet, designs: np.ndarray) -> GeometryJacobian:
    """Sixth-order central differences."""
    offsets, weights = np.array([1, 2, 3]), np.array([45.0, -9.0, 1.0]) / 60.0
    columns: dict[str, list[np.ndarray]] = {"length": [], "radius": [], "slope": []}
    for i in range(chosen.size):
        step = 1e-3 * (chosen.upper[i] - chosen.lower[i])
        totals = dict.fromkeys(columns, 0.0)
        for offset, weight in zip(offsets, weights, strict=True):
            for sign in (1, -1):
                moved = designs.copy()
                moved[:, i] += sign * offset * step
                geometry = chosen.geometry(moved, X)
                for field in columns:
                    totals[field] += sign * weight / step * getattr(geometry, field)
        for field in columns:
            columns[field].append(np.asarray(totals[field]))
    return GeometryJacobian(**{field: np.stack(c, axis=-1) for field, c in columns.items()})


@pytest.mark.parametrize("name", ALL)
def test_jacobian_agrees_with_finite_differences(name: str) -> None:
    chosen = parameter_set(name)
    random = np.random.default_rng(3)
    designs = random.uniform(chosen.lower, chosen.upper, (200, chosen.size))
    if "RLP" in name:
        # The kink where the minimum radius begins has no derivative: look away from it.
        free = chosen.geometry(designs, X).radius.min(axis=1) > 0.0055
        assert free.sum() >= 10
        designs = designs[free]
    exact, found = chosen.jacobian(designs, X), differences(chosen, designs)
    assert exact.length.shape == (len(designs), chosen.size)
    assert exact.radius.shape == exact.slope.shape == (len(designs), X.size, chosen.size)
    for field in ("length", "radius", "slope"):
        scale = max(np.abs(getattr(exact, field)).max(), 1e-3)
        np.testing.assert_allclose(
            getattr(found, field), getattr(exact, field), rtol=0, atol=1e-9 * scale
        )


@pytest.mark.parametrize("name", ["RLP", "L+RLP"])
def test_derivative_is_zero_exactly_where_the_radius_is_clamped(name: str) -> None:
    chosen = parameter_set(name)
    design = chosen.start.copy()
    first = chosen.labels.index("a_0")
    design[first : first + 2] = 0.125, 0.75  # S = 0.25 + 0.5 X cm, in binary exact
    held = X <= 0.5
    jacobian = chosen.jacobian(design, X)
    surface = slice(first, first + 10)
    assert np.all(jacobian.radius[0, held] == 0.0)
    assert np.all(jacobian.slope[0, held] == 0.0)
    assert np.all(jacobian.radius[0, ~held, surface][:, 0] == 0.02)
    away = np.abs(X - 0.5) > 0.05
    found = differences(chosen, design[None])
    np.testing.assert_allclose(jacobian.radius[0, away], found.radius[0, away], atol=1e-11)
    np.testing.assert_allclose(jacobian.slope[0, away], found.slope[0, away], atol=1e-10)
