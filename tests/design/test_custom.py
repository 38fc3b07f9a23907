"""User-defined surface functions, with and without derivatives."""

from __future__ import annotations

import numpy as np
import pytest

from flexor.design import custom, parameter_set, union
from flexor.errors import InputError

X = np.linspace(0.0, 1.0, 21)


def bulge(p: np.ndarray, points: np.ndarray) -> np.ndarray:
    return p[0] + p[1] * np.exp(-(((points - p[2]) / 0.3) ** 2))


def make(**more: object):  # type: ignore[no-untyped-def]
    return custom(
        "bulge",
        ["R", "height", "place"],
        [0.006, 0.0, 0.0],
        [0.012, 0.004, 1.0],
        [0.008, 0.002, 0.5],
        bulge,
        units=["cm", "mm", "1"],
        **more,  # type: ignore[arg-type]
    )


def test_missing_slope_and_derivatives_are_computed_by_differences() -> None:
    chosen = make()
    design = np.array([0.007, 0.003, 0.4])
    geometry, jacobian = chosen.geometry(design, X), chosen.jacobian(design, X)
    t = (X - 0.4) / 0.3
    bell = np.exp(-(t**2))
    np.testing.assert_allclose(geometry.radius[0], 0.007 + 0.003 * bell, rtol=1e-15)
    np.testing.assert_allclose(geometry.slope[0], -0.003 * 2 * t / 0.3 * bell, atol=1e-11)
    exact = np.stack((np.ones_like(X), bell, 0.003 * 2 * t / 0.3 * bell), axis=1)
    np.testing.assert_allclose(jacobian.radius[0], exact, atol=1e-9)
    slopes = np.stack(
        (0 * X, -2 * t / 0.3 * bell, 0.003 * 2 / 0.09 * (1 - 2 * t**2) * bell), axis=1
    )
    np.testing.assert_allclose(jacobian.slope[0], slopes, atol=1e-7)
    np.testing.assert_array_equal(jacobian.length, np.zeros((1, 3)))


def test_given_slope_and_jacobian_are_used() -> None:
    def profile(p: np.ndarray, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        return p[0] + p[1] * points, np.full(points.shape, p[1])

    def derivative(p: np.ndarray, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        one = np.ones_like(points)
        return np.stack((one, points), axis=1), np.stack((0 * one, one), axis=1)

    chosen = custom("line", ["R", "t"], [0.006, 0], [0.01, 0.002], [0.007, 0], profile, derivative)
    jacobian = chosen.jacobian([[0.008, 0.001], [0.009, 0.002]], X)
    np.testing.assert_array_equal(jacobian.radius[1], np.stack((X**0, X), axis=1))
    np.testing.assert_array_equal(jacobian.slope[0], np.stack((0 * X, X**0), axis=1))


def test_the_function_is_evaluated_within_the_rod_only() -> None:
    requested: list[np.ndarray] = []

    def profile(p: np.ndarray, points: np.ndarray) -> np.ndarray:
        requested.append(points)
        return p[0] + 0.001 * points**2

    geometry = custom("s", ["R"], [0.006], [0.01], [0.007], profile).geometry([0.007], X)
    assert min(points.min() for points in requested) >= 0.0
    assert max(points.max() for points in requested) <= 1.0
    np.testing.assert_allclose(geometry.slope[0], 0.002 * X, atol=1e-12)


def test_it_combines_with_the_length_and_is_clamped_to_the_minimum_radius() -> None:
    chosen = union(parameter_set("L"), make(minimum_radius=0.0075))
    geometry = chosen.geometry([0.12, 0.007, 0.001, 0.5], X)
    assert chosen.labels == ("L", "R", "height", "place")
    np.testing.assert_array_equal(geometry.length, [0.12])
    assert geometry.radius.min() == 0.0075
    assert geometry.radius.max() == pytest.approx(0.008)
    held = geometry.radius[0] == 0.0075
    assert np.all(chosen.jacobian([0.12, 0.007, 0.001, 0.5], X).radius[0, held] == 0.0)


@pytest.mark.parametrize(
    ("labels", "upper", "message"),
    [
        (["R"], [0.01, 0.01], "upper has shape (2,), but there are 1 labels"),
        (["R"], [0.001], "the lower bound of R, 0.006, is not below its upper bound, 0.001"),
        (["R"], [np.inf], "upper must be finite"),
    ],
)
def test_inconsistent_arguments_are_rejected(
    labels: list[str], upper: list[float], message: str
) -> None:
    with pytest.raises(InputError) as error:
        custom("mine", labels, [0.006], upper, [0.006], lambda p, points: p[0] + 0 * points)
    assert message in str(error.value)


def test_a_result_of_the_wrong_shape_is_rejected() -> None:
    chosen = custom("mine", ["R"], [0.006], [0.01], [0.006], lambda p, points: p)
    with pytest.raises(InputError, match=r"array of shape \(21,\), got one of shape"):
        chosen.geometry([0.006], X)
