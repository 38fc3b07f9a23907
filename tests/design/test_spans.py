"""Spans of pressures as design variables."""

from __future__ import annotations

import numpy as np
import pytest

import flexor
from flexor.design import variables
from flexor.errors import InputError
from flexor.model import Model
from flexor.model.reading import check
from flexor.model.schema.cavity import shares
from flexor.study import Problem

BOUNDS = {
    "chamber.span.0": (0.0, 0.35),
    "chamber.span.1": (0.6, 1.0),
    "exosuit.section.wall": ("1.5 mm", "3 mm"),
    "exosuit.length": ("8 cm", "11 cm"),
}


@pytest.fixture(scope="module")
def model() -> Model:
    """Return the pneumatic finger, coarse; its thread encloses the wall around the chamber."""
    document = flexor.load("pneumatic-finger").file.to_document()
    document["bodies"]["exosuit"]["elements"] = 8
    document["bodies"]["exosuit"]["gauss_points"] = 3
    for name, place in (("proximal", 0.25), ("middle", 0.625), ("distal", 0.875)):
        document["straps"][name]["at"] = place
    return flexor.load(check(document))


def test_shares_integrate_polynomials_exactly(model: Model) -> None:
    """Of degrees that the points of an interval resolve; slopes are the integrand at the ends."""
    rod = model.file.rod("exosuit")
    nodes, weights = np.polynomial.legendre.leggauss(rod.gauss_points)
    # Elements, the last in three parts.
    last = 1.0 - 1.0 / rod.elements
    ends = np.concatenate([np.linspace(0.0, last, rod.elements), np.linspace(last, 1.0, 4)[1:]])
    lengths = np.diff(ends)
    place = ends[:-1, None] + 0.5 * lengths[:, None] * (nodes + 1.0)
    weight = (0.5 * lengths[:, None] * weights).ravel()
    spans = np.random.default_rng(0).uniform(0.0, 1.0, (50, 2))
    spans = np.concatenate(
        [np.sort(spans, axis=1), [[0.0, 1.0], [0.25, 0.75], [0.1, 0.11], [0.9, last + 0.01]]]
    )
    share, slopes = shares(rod, spans)
    for power in range(rod.gauss_points):
        integrand = place.ravel() ** power
        found = (share * weight) @ integrand
        exact = (spans[:, 1] ** (power + 1) - spans[:, 0] ** (power + 1)) / (power + 1)
        np.testing.assert_allclose(found, exact, rtol=1e-12, atol=1e-15)
        by_ends = np.einsum("nge,g->ne", slopes, weight * integrand)
        signs = np.array([-1.0, 1.0])
        np.testing.assert_allclose(by_ends, signs * spans**power, rtol=1e-10, atol=1e-12)


def test_designs_are_those_of_files_with_the_spans(model: Model) -> None:
    chosen = variables(BOUNDS, model)
    assert chosen.start.tolist()[:2] == [0.0, 1.0]
    random = np.random.default_rng(1)
    designs = random.uniform(chosen.lower, chosen.upper, (6, 4))
    designs[0, :2] = 0.25, 0.75  # at element boundaries
    designs[:, 3] = chosen.start[3]  # of another length the tip is another share
    found, valid = chosen.designs(designs, model)
    assert valid.all()
    for design, values in zip(designs, found.values, strict=True):
        changes = chosen.changes(design)
        assert changes["actuators.chamber.span"] == design[:2].tolist()
        other = flexor.load(model.file, changes=changes)
        whole = model.parameters.copy()
        whole[found.indices] = values
        for name, (start, stop) in model.engine.slots.items():
            expected = other.parameters[start:stop]
            error = np.abs(whole[start:stop] - expected).max(initial=0.0)
            assert error <= 1e-10 * np.abs(expected).max(initial=0.0), name


def test_gradients_are_those_of_differences(model: Model) -> None:
    """Of 200 random designs, but where the difference crosses an element boundary."""
    chosen = variables(BOUNDS, model)
    aim = "maximise range-of-motion"
    kept = ["overlap <= 1 mm", "volume.chamber <= 20 mL at end"]
    problem = Problem.of(model, chosen, aim, subject_to=kept, options={"tolerance": 1e-12})
    designs = np.random.default_rng(2).uniform(chosen.lower, chosen.upper, (200, 4))
    step = 1e-4 * (chosen.upper - chosen.lower)
    places = designs[:, :2] * 8.0
    inside = (np.abs(places - np.round(places)) > 8.0 * 3.0 * step[:2]).all(axis=1)
    here = problem.evaluate(designs, gradient=True)
    good = inside & np.isfinite(here.value) & (here.event_count == 0)
    good &= here.regularity == "regular"
    assert good.sum() > 100
    exact = [problem.gradients(here), *np.moveaxis(here.constraint_gradients, 1, 0)]
    values = [here.value, *here.constraint_values.T]
    for i in range(4):
        ends = []
        for factor in (-2.0, -1.0, 1.0, 2.0):
            moved = designs.copy()
            moved[:, i] += factor * step[i]
            paths = problem.evaluate(moved)
            ends.append(np.stack([paths.value, *paths.constraint_values.T]))
            good &= paths.event_count == 0
        slope = (ends[0] - 8.0 * ends[1] + 8.0 * ends[2] - ends[3]) / (12.0 * step[i])
        for row, gradient, value in zip(slope, exact, values, strict=True):
            # Of the whole range, in units of the value.
            span = chosen.upper[i] - chosen.lower[i]
            error = np.abs(row - gradient[:, i])[good] * span / np.abs(value[good]).max()
            assert np.median(error) < 1e-8
            assert np.mean(error < 1e-6) > 0.97, error.max()  # others have a kink in between


def test_a_search_finds_the_best_span(model: Model) -> None:
    """By exact slopes, as good as the best of a dense grid, and its file has the span."""
    varied = {"chamber.span.1": (0.4, 1.0)}
    problem = Problem.of(model, varied, "maximise angle.ph_2")
    grid = np.linspace(0.4, 1.0, 601)[:, None]
    study = flexor.optimize(model, varied, "maximise angle.ph_2", budget=400)
    assert study.best.shown >= problem.evaluate(grid).shown.max() * (1.0 - 1e-6)
    again = flexor.load(study.best.model.file)
    assert again.file.actuators["chamber"].span[1] == study.best.vector[0]


@pytest.mark.parametrize(
    ("bounds", "message"),
    [
        ({"chamber.span.1": (0.5, 1.2)}, "chamber.span.1 = 0.5:1.2: the bounds of a place along"),
        ({"chamber.span.1": ("5 cm", "6 cm")}, "expected a plain number"),
        ({"chamber.span.2": (0.5, 0.6)}, 'the list has no entry "2"'),
        ({"chamber.span": (0.5, 0.6)}, "which is not a number"),
    ],
)
def test_bad_bounds(model: Model, bounds: dict[str, object], message: str) -> None:
    with pytest.raises(InputError, match=message):
        variables(bounds, model)  # type: ignore[arg-type]


def test_a_span_that_ends_before_its_begin_is_no_design(model: Model) -> None:
    chosen = variables({"chamber.span.0": (0.0, 0.9), "chamber.span.1": (0.1, 1.0)}, model)
    _, valid = chosen.designs(np.array([[0.5, 0.4], [0.4, 0.5]]), model)
    assert valid.tolist() == [False, True]
