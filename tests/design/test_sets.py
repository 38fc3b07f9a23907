"""Published parameter sets: Table I, published designs, bounds, unions, names."""

from __future__ import annotations

import numpy as np
import pytest

from flexor.design import (
    DesignSpace,
    catalogue,
    parameter_set,
    register,
    union,
)
from flexor.errors import InputError

ALL = ["L", "R01", "Rsc", "RLP", "L+R01", "L+Rsc", "L+RLP"]
X = np.linspace(0.0, 1.0, 41)
TABLE_I = 0.0116 + (0.008 - 0.0116) * X


@pytest.mark.parametrize("name", ["L", "R01", "RLP", "L+R01", "L+RLP"])
def test_start_is_the_exosuit_of_table_one(name: str) -> None:
    chosen = parameter_set(name)
    geometry = chosen.geometry(chosen.start, X)
    np.testing.assert_allclose(geometry.length, [0.10], rtol=0, atol=0)
    np.testing.assert_allclose(geometry.radius, [TABLE_I], rtol=1e-14)
    np.testing.assert_allclose(geometry.slope, np.full((1, 41), -0.0036), rtol=1e-13)


def test_start_of_rsc_tapers_from_the_base_radius_of_table_one() -> None:
    chosen = parameter_set("Rsc")
    radius = chosen.geometry(chosen.start, X).radius[0]
    assert radius[0] == pytest.approx(0.0116, rel=1e-14)
    assert radius[-1] == pytest.approx(0.9 * 0.0116, rel=1e-14)
    assert np.all(np.diff(radius) < 0.0)


def test_published_sine_cosine_design() -> None:
    # A = -2, B = -1/2, no phase: sin(-2 pi X) + cos(-pi X / 2), R_0 = 1.16 cm.
    geometry = parameter_set("Rsc").geometry([-2.0, -0.5, 0.0, 0.0], [0.0, 0.25, 0.5, 1.0])
    amplitude = 1.16 / 20
    by_hand = [
        1.16 + amplitude * (0.0 + 1.0),
        1.16 + amplitude * (-1.0 + 0.9238795325112867),
        1.16 + amplitude * (0.0 + 0.7071067811865476),
        1.16 + amplitude * (0.0 + 0.0),
    ]
    np.testing.assert_allclose(100 * geometry.radius[0], by_hand, rtol=1e-12)
    slope_at_base = amplitude * (-2 * np.pi)
    assert 100 * geometry.slope[0, 0] == pytest.approx(slope_at_base, rel=1e-12)


def test_published_legendre_design() -> None:
    published = [0.4, 0.7, 0.0, 1.0, 0.8, 0.9, 1.0, 1.0, 1.0, 1.0]
    geometry = parameter_set("RLP").geometry(published, [0.0, 1.0])
    # P_n(1) = 1; at 0 the odd ones vanish and P_4, P_6, P_8 are 3/8, -5/16, 35/128.
    tip = sum(2 * a / 3**n for n, a in enumerate(published))
    base = 0.8 + 3 / 8 * 2 * 0.8 / 81 - 5 / 16 * 2 / 729 + 35 / 128 * 2 / 6561
    np.testing.assert_allclose(100 * geometry.radius[0], [base, tip], rtol=1e-13)
    # P_n'(1) = n (n + 1) / 2.
    slope = sum(2 * a / 3**n * n * (n + 1) / 2 for n, a in enumerate(published))
    assert 100 * geometry.slope[0, 1] == pytest.approx(slope, rel=1e-12)
    assert geometry.radius[0, 0] < geometry.radius[0, 1]  # "a thinner base and a thicker tip"


@pytest.mark.parametrize(
    ("name", "published"),
    [
        ("L", [0.0797]),
        ("R01", [0.0067, 0.0075]),
        ("R01", [0.0053, 0.0052]),
        ("L+R01", [0.108, 0.0065, 0.0074]),
        ("L+R01", [0.104, 0.0062, 0.0080]),
        ("L+R01", [0.096, 0.0088, 0.0057]),
        ("L+Rsc", [0.10, -2.0, -0.5, 0.0, 0.0]),
        ("L+RLP", [0.10, 0.4, 0.7, 0.0, 1.0, 0.8, 0.9, 1.0, 1.0, 1.0, 1.0]),
    ],
)
def test_published_optima_and_starts_lie_within_bounds(name: str, published: list[float]) -> None:
    chosen = parameter_set(name)
    chosen.check_inside(published)
    chosen.check_inside(chosen.start)


def test_general_surfaces_are_clamped_to_the_minimum_radius_and_the_taper_is_not() -> None:
    thin = np.zeros(10)
    thin[0], thin[1] = 0.1, 0.9  # S = 0.2 + 0.6 X cm
    geometry = parameter_set("RLP").geometry(thin, X)
    inside = 0.002 + 0.006 * X > 0.005
    np.testing.assert_allclose(geometry.radius[0], np.maximum(0.002 + 0.006 * X, 0.005), rtol=1e-13)
    np.testing.assert_allclose(geometry.slope[0], np.where(inside, 0.006, 0.0), rtol=1e-13)
    straight = parameter_set("R01").geometry([0.004, 0.004], X)
    np.testing.assert_array_equal(straight.radius, np.full((1, 41), 0.004))


def test_unchanged_geometry_is_that_of_the_rod() -> None:
    rod = DesignSpace(length=0.2, radius_base=0.02, radius_tip=0.01)
    shape = parameter_set("R01").on(rod).geometry([0.006, 0.007], X)
    np.testing.assert_array_equal(shape.length, [0.2])
    length = parameter_set("L").on(rod).geometry([0.09], X)
    np.testing.assert_allclose(length.radius[0], 0.02 - 0.01 * X, rtol=1e-14)


@pytest.mark.parametrize("name", ALL)
def test_a_design_does_not_depend_on_its_batch(name: str) -> None:
    chosen = parameter_set(name)
    random = np.random.default_rng(7)
    designs = random.uniform(chosen.lower, chosen.upper, (37, chosen.size))
    together = chosen.geometry(designs, X)
    for i, design in enumerate(designs):
        alone = chosen.geometry(design, X)
        for field in ("length", "radius", "slope"):
            assert getattr(alone, field)[0].tobytes() == getattr(together, field)[i].tobytes()


def test_union_orders_parameters_as_its_sets() -> None:
    joined = union(parameter_set("R01"), parameter_set("L"))
    assert joined.name == "R01+L"
    assert joined.labels == ("R_0", "R_1", "L")
    assert joined.units == ("cm", "cm", "cm")
    geometry = joined.geometry([0.006, 0.008, 0.09], [0.0, 1.0])
    np.testing.assert_allclose(geometry.radius[0], [0.006, 0.008], rtol=1e-15)
    np.testing.assert_array_equal(geometry.length, [0.09])


@pytest.mark.parametrize(
    ("text", "canonical"), [("l + r01", "L+R01"), ("R_LP", "RLP"), ("L+R0,1", "L+R01")]
)
def test_names_are_normalized(text: str, canonical: str) -> None:
    assert parameter_set(text).name == canonical


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("L+R10", 'unknown parameter set "R10" (did you mean "R01"?)'),
        ("RPL", 'did you mean "RLP"?'),
        ("L+", 'unknown parameter set ""'),
        ("R01+Rsc", "more than one set changes the surface"),
        ("L+L", "more than one set changes the length"),
    ],
)
def test_unknown_names_are_rejected_with_one_sentence(text: str, message: str) -> None:
    with pytest.raises(InputError) as error:
        parameter_set(text)
    assert message in str(error.value)
    assert "\n" not in str(error.value)


def test_a_design_out_of_bounds_is_reported_in_display_units() -> None:
    with pytest.raises(InputError, match=r"R_0 = 1\.3 cm is outside its bounds 0\.4 to 1\.2 cm"):
        parameter_set("L+R01").check_inside([0.1, 0.013, 0.008])
    with pytest.raises(InputError, match="has 3 parameters"):
        parameter_set("L+R01").geometry([0.1, 0.01], X)
    with pytest.raises(InputError, match="R_0 = nan"):
        parameter_set("R01").check_inside([np.nan, 0.008])


def test_bounds_can_be_replaced_by_label() -> None:
    wide = parameter_set("L+R01").with_bounds({"L": (0.05, 0.2)})
    np.testing.assert_array_equal(wide.lower, [0.05, 0.004, 0.004])
    np.testing.assert_array_equal(wide.upper, [0.2, 0.012, 0.012])
    with pytest.raises(InputError, match='unknown parameter of the set L\\+R01 "R_2"'):
        wide.with_bounds({"R_2": (0.1, 0.2)})
    with pytest.raises(InputError, match=r"the lower bound of L, 0\.2, is not below"):
        wide.with_bounds({"L": (0.2, 0.1)})


def test_a_registered_set_can_be_combined_by_name(monkeypatch: pytest.MonkeyPatch) -> None:
    # Not for the tests that follow in this process.
    monkeypatch.setattr(catalogue, "_FACTORIES", dict(catalogue._FACTORIES))
    register("straight_again", lambda space: parameter_set("R01", space))
    assert parameter_set("L+straight_again").labels == ("L", "R_0", "R_1")
    with pytest.raises(InputError, match="already exists"):
        register("r01", lambda space: parameter_set("R01", space))
