"""Places of straps on rods, and strains of rods in the reference state, as design variables."""

from __future__ import annotations

import numpy as np
import pytest

import flexor
from flexor.design import variables
from flexor.errors import InputError
from flexor.model import Model
from flexor.model.reading import check
from flexor.study import Problem

PLACES = {
    "proximal.at": (0.15, 0.35),
    "middle.at": (0.45, 0.7),
    "exosuit.length": ("9 cm", "11 cm"),
    "exosuit.radius.base": ("7 mm", "9 mm"),
}
STRAINS = {
    "exosuit.reference_strain.bend_y": ("-2 1/m", "4 1/m"),
    "exosuit.reference_strain.extend_x": (0.95, 1.05),
}


@pytest.fixture(scope="module")
def model() -> Model:
    """Return the pneumatic finger, coarse."""
    document = flexor.load("pneumatic-finger").file.to_document()
    # Whether a rod can touch itself is decided once.
    document["bodies"]["exosuit"] |= {"elements": 8, "self_contact": False}
    for name, place in (("proximal", 0.25), ("middle", 0.625), ("distal", 0.875)):
        document["straps"][name]["at"] = place
    return flexor.load(check(document))


def test_a_moving_strap_on_an_element_boundary_is_one_that_is_fixed_there(model: Model) -> None:
    moving = flexor.load(model.file, changes={f"{n}.moving": True for n in model.file.straps})
    one, other = model.equilibrium(), moving.equilibrium()
    np.testing.assert_allclose(other.joint_angles, one.joint_angles, atol=1e-9)
    for name, force in one.strap_forces().items():
        np.testing.assert_allclose(other.strap_forces()[name], force, atol=1e-6)


def test_a_strap_between_boundaries_is_one_on_a_boundary_of_finer_elements(model: Model) -> None:
    """Forces differ by what the finer elements change anyway."""
    place = 0.4375  # a boundary of 16 elements and of 32, but of 8 none

    def angles(at: float, elements: int) -> np.ndarray:
        changes = {"middle.at": at, "exosuit.elements": elements}
        return flexor.load(model.file, changes=changes).equilibrium().joint_angles[-1]

    fine, between, beside = angles(place, 32), angles(place, 8), angles(0.5, 8)
    assert np.abs(between - fine).max() < 0.02 < np.abs(beside - fine).max()


def test_the_path_is_continuous_across_sample_points(model: Model) -> None:
    """With its slopes: differences from both sides agree."""
    rod = model.file.rod("exosuit")
    problem = Problem.of(model, {"middle.at": (0.4, 0.7)}, "maximise bending")
    for x in rod.sample_points[(rod.sample_points > 0.45) & (rod.sample_points < 0.6)]:
        beside = np.array([[x - 1e-9], [x], [x + 1e-9]])
        paths = problem.evaluate(beside, gradient=True)
        np.testing.assert_allclose(paths.value, paths.value[1], atol=2e-8)
        slopes = problem.gradients(paths)
        np.testing.assert_allclose(slopes, slopes[[1, 1, 1]], rtol=1e-6)


@pytest.mark.parametrize("bounds", [PLACES, STRAINS])
def test_designs_are_those_of_files(model: Model, bounds: dict[str, tuple[object, object]]) -> None:
    chosen = variables(bounds, model)
    prepared = chosen.prepared(model)
    random = np.random.default_rng(1)
    designs = random.uniform(chosen.lower, chosen.upper, (5, chosen.size))
    if bounds is PLACES:
        designs[:, 2] = chosen.start[2]  # of another length the tip is another share
        designs[0, :2] = 0.25, 0.625  # on element boundaries
    found, valid = chosen.designs(designs, prepared)
    assert valid.all()
    for design, values in zip(designs, found.values, strict=True):
        other = flexor.load(prepared.file, changes=chosen.changes(design))
        whole = prepared.parameters.copy()
        whole[found.indices] = values
        for name, (start, stop) in prepared.engine.slots.items():
            expected = other.parameters[start:stop]
            error = np.abs(whole[start:stop] - expected).max(initial=0.0)
            assert error <= 1e-10 * np.abs(expected).max(initial=0.0), name


@pytest.mark.parametrize("bounds", [PLACES, STRAINS])
def test_gradients_are_those_of_differences(
    model: Model, bounds: dict[str, tuple[object, object]]
) -> None:
    """Of 200 random designs, of the objective and of each constraint."""
    kept = ["strap-force.middle <= 20 N", "overlap <= 1 mm", "volume.chamber <= 20 mL at end"]
    options = {"tolerance": 1e-12}
    problem = Problem.of(model, bounds, "maximise bending", subject_to=kept, options=options)
    chosen = problem.parameters
    designs = np.random.default_rng(2).uniform(chosen.lower, chosen.upper, (200, chosen.size))
    here = problem.evaluate(designs, gradient=True)
    good = np.isfinite(here.value) & (here.event_count == 0) & (here.regularity == "regular")
    assert good.sum() > 100
    exact = [problem.gradients(here), *np.moveaxis(here.constraint_gradients, 1, 0)]
    values = [here.value, *here.constraint_values.T]
    for i, span in enumerate((chosen.upper - chosen.lower).tolist()):
        step, ends = 1e-4 * span, []
        for factor in (-2.0, -1.0, 1.0, 2.0):
            moved = designs.copy()
            moved[:, i] += factor * step
            paths = problem.evaluate(moved)
            ends.append(np.stack([paths.value, *paths.constraint_values.T]))
            good &= np.isfinite(paths.value)
        with np.errstate(invalid="ignore"):
            slope = (ends[0] - 8.0 * ends[1] + 8.0 * ends[2] - ends[3]) / (12.0 * step)
        for row, gradient, value in zip(slope, exact, values, strict=True):
            # Of the whole range, in units of the value.
            error = np.abs(row - gradient[:, i])[good] * span / np.abs(value[good]).max()
            assert np.median(error) < 1e-8
            assert np.mean(error < 1e-6) > 0.97, error.max()  # others have a kink in between


def test_a_search_moves_a_strap_and_its_file_has_the_place(model: Model) -> None:
    """As far as the best of a grid, by exact slopes."""
    varied = {"middle.at": (0.45, 0.7)}
    problem = Problem.of(model, varied, "maximise angle.ph_2")
    grid = np.linspace(0.45, 0.7, 51)[:, None]
    study = flexor.optimize(model, varied, "maximise angle.ph_2", budget=400)
    assert study.best.shown >= problem.evaluate(grid).shown.max() * (1.0 - 1e-6)
    again = flexor.load(model.file, changes=problem.parameters.changes(study.best.vector))
    assert again.file.straps["middle"].at == study.best.vector[0]
    assert not again.file.straps["middle"].moving


def test_a_tolerance_of_the_place_alone(model: Model) -> None:
    """Its errors are those of files."""
    words = {"subject_to": ["overlap <= 2 mm"], "tolerance": {"middle.at": 0.01}, "budget": 40}
    study = flexor.optimize(
        model, {"exosuit.length": ("9 cm", "11 cm")}, "maximise bending", **words
    )
    problem = study.problem
    error = np.array([0.01])
    found = problem.path_of(study.best.vector, error).joint_angles[-1]
    moved = {"middle.at": 0.635, "exosuit.length": f"{float(study.best.vector[0])!r} m"}
    # The share of the rod that is its tip is that of the model as it is.
    other = flexor.load(model.file, changes=moved).equilibrium(problem.loads).joint_angles[-1]
    np.testing.assert_allclose(found, other, atol=1e-3)


@pytest.mark.parametrize(
    ("bounds", "message"),
    [
        ({"middle.at": (0.5, 1.2)}, "middle.at = 0.5:1.2: the bounds of a place along a rod are"),
        ({"middle.at": ("5 cm", "6 cm")}, "expected a plain number"),
        ({"middle.at": (0.5, float("inf"))}, 'has the bound "inf": it must be a finite number'),
        ({"exosuit.length": ("nan cm", "12 cm")}, 'the bound "nan cm": it must be a finite number'),
    ],
)
def test_bad_bounds(model: Model, bounds: dict[str, object], message: str) -> None:
    with pytest.raises(InputError, match=message):
        variables(bounds, model)  # type: ignore[arg-type]


def test_loops_stay(model: Model) -> None:
    looped = flexor.load(model.file, changes={"middle.to": {"body": "ph_2", "loop": True}})
    with pytest.raises(
        InputError, match="a loop is at an element boundary of its rod; give values"
    ):
        variables({"middle.at": (0.5, 0.7)}, looped)
    with pytest.raises(InputError, match=r"straps.middle.at is 0.61: that of a loop must be"):
        flexor.load(looped.file, changes={"middle.at": 0.61})
