"""Fields of a model file as design variables: exact values, exact derivatives, errors."""

from __future__ import annotations

import pickle
from dataclasses import replace

import numpy as np
import pytest

import flexor
from benchmarks._variables import FIELDS
from flexor.design import variables
from flexor.errors import InputError
from flexor.model import Model
from flexor.model.reading import check
from flexor.study import Problem


@pytest.fixture(scope="module")
def model() -> Model:
    """Return the pneumatic finger, which cannot touch itself, whatever its length."""
    return flexor.load("pneumatic-finger", changes={"exosuit.self_contact": False})


def _some(name: str, model: Model) -> flexor.design.Variables:
    return variables({name: FIELDS[name]}, model)


@pytest.mark.parametrize("name", FIELDS)
def test_values_are_those_of_the_changed_file(name: str, model: Model) -> None:
    """A design of one field has the parameters of the file with that field changed."""
    chosen = _some(name, model)
    for fraction in (0.13, 0.5, 0.94):
        x = chosen.lower + fraction * (chosen.upper - chosen.lower)
        found, valid = chosen.designs(x[None, :], model)
        expected = flexor.load(model.file, changes=chosen.changes(x)).parameters
        actual = model.parameters.copy()
        actual[found.indices] = found.values[0]
        assert valid.all()
        np.testing.assert_allclose(actual, expected, rtol=1e-10, atol=1e-14)


def test_values_of_several_fields_are_those_of_the_changed_file(model: Model) -> None:
    """The same for all of the fields at once."""
    chosen = variables(FIELDS, model)
    x = chosen.lower + np.linspace(0.1, 0.9, chosen.size) * (chosen.upper - chosen.lower)
    found, _ = chosen.designs(x[None, :], model)
    actual = model.parameters.copy()
    actual[found.indices] = found.values[0]
    expected = flexor.load(model.file, changes=chosen.changes(x)).parameters
    np.testing.assert_allclose(actual, expected, rtol=1e-9, atol=1e-14)


RING = {"shape": "ring", "radius": 0.9, "wall": 0.3}


@pytest.mark.parametrize(
    "section",
    [
        {"kind": "tube", "wall": "1.5 mm"},
        {"kind": "box", "width": 2.3, "wall": "1.5 mm"},
        {
            "kind": "composite",
            "parts": [RING, {"shape": "disc", "radius": 0.5, "cavity": "bore"}],
        },
    ],
)
def test_the_radius_of_sections_as_wide_as_it_is(section: dict[str, object]) -> None:
    """A half-width or roundness in multiples of S has no part in metres that is rounding."""
    document = flexor.load("pneumatic-finger").file.to_document()
    document["bodies"]["exosuit"]["section"] = section
    model = flexor.load(check(document))
    chosen = variables({"exosuit.radius.tip": ("5.5 mm", "9 mm")}, model)
    x = np.array([8.3e-3])
    found, valid = chosen.designs(x[None, :], model)
    actual = model.parameters.copy()
    actual[found.indices] = found.values[0]
    expected = flexor.load(model.file, changes=chosen.changes(x)).parameters
    assert valid.all()
    np.testing.assert_allclose(actual, expected, rtol=1e-10, atol=1e-14)


def test_a_design_does_not_depend_on_its_neighbours(model: Model) -> None:
    """Values and derivatives are the same bits, alone and in a batch; also after pickling."""
    chosen = variables({name: FIELDS[name] for name in list(FIELDS)[:4]}, model)
    x = chosen.lower + 0.3 * (chosen.upper - chosen.lower) * np.array([[1.0], [2.0], [3.0]])
    again = pickle.loads(pickle.dumps(chosen))
    batch = chosen.designs(x, model)[0].values
    slopes = chosen.slot_jacobian(x, model)
    for row in range(3):
        alone = again.designs(x[[row]], model)[0].values
        assert alone.tobytes() == batch[row].tobytes()
        assert again.slot_jacobian(x[[row]], model).tobytes() == slopes[row].tobytes()


def test_start_is_the_models_own(model: Model) -> None:
    """Values without change are those of the file, and units those of the bounds."""
    chosen = variables({name: FIELDS[name] for name in ("exosuit.length", "proximal.to.at")}, model)
    assert chosen.start.tolist() == [0.1, 0.55]
    assert chosen.units == ("cm", "1")
    assert replace(chosen).changes(chosen.start) == {
        "exosuit.length": "0.1 m",
        "proximal.to.at": 0.55,
    }


def test_a_constant_radius_is_one_variable(model: Model) -> None:
    """It is the same as both ends, at once; those of a taper are two."""
    round_one = flexor.load(model.file, changes={"exosuit.radius": "7 mm"})
    chosen = variables({"exosuit.radius": ("6 mm", "9 mm")}, round_one)
    ends = {f"exosuit.radius.{end}": ("6 mm", "9 mm") for end in ("base", "tip")}
    both = variables(ends, round_one)
    assert (chosen.labels, chosen.start.tolist()) == (("exosuit.radius",), [7e-3])
    assert chosen.changes(np.array([8e-3])) == both.changes(np.array([8e-3, 8e-3]))
    here, there = np.array([[8e-3]]), np.array([[8e-3, 8e-3]])
    found, _ = chosen.designs(here, round_one)
    expected, _ = both.designs(there, round_one)
    np.testing.assert_array_equal(found.values, expected.values)
    slopes = chosen.slot_jacobian(here, round_one)[0, :, 0]
    np.testing.assert_allclose(slopes, both.slot_jacobian(there, round_one)[0].sum(axis=1))


@pytest.mark.parametrize(
    ("bounds", "message"),
    [
        ({"exosuit.lenght": ("8 cm", "9 cm")}, 'did you mean "length"'),
        ({"exosuitt.length": ("8 cm", "9 cm")}, 'did you mean "exosuit"'),
        ({"exosuit.length": ("9 cm", "8 cm")}, "lower bound must be below"),
        ({"exosuit.length": (8, 9)}, "expected a value with its unit"),
        ({"exosuit.length": ("8 kPa", "9 kPa")}, "expected a value with its unit"),
        ({"exosuit.material": (1, 2)}, "not a number"),
        ({"exosuit.elements": (10, 20)}, "20 is a whole number: give values to choose from"),
        ({"exosuit.radius": ("7 mm", "9 mm")}, 'numbers are "exosuit.radius.base" and'),
        ({"exosuit.young_modulus": ("1 MPa", "2 MPa")}, "not given in the file"),
        ({"exosuit.length": ("8 cm", "9 cm"), "bodies.exosuit.length": ("8 cm", "9 cm")}, "same"),
        ({"exosuit.length": ("0 cm", "9 cm")}, 'the bound "0 cm": it must be greater than zero'),
        ({"exosuit.skin.thickness": ("-1 mm", "3 mm")}, '"-1 mm": it must be greater than zero'),
        ({"middle.slack": ("-1 mm", "1 mm")}, '"-1 mm": it must not be negative'),
        ({"proximal.width": ("0 mm", "9 mm")}, '"0 mm": it must be greater than zero'),
        ({"evaluation.loads.chamber": ("9 kPa", "60 kPa")}, "those of evaluation.pressure: vary"),
        ({"chamber.span.1": (0.5, 1.5)}, "the bounds of a place along a rod are from 0 to 1"),
        ({"exosuit.length": None}, "exosuit.length = None: expected a field, and its lower"),
        ({3: ("8 cm", "9 cm")}, "expected a field, and its lower"),
        ({}, "at least one field"),
    ],
)
def test_bad_variables(
    bounds: dict[str, tuple[object, object]], message: str, model: Model
) -> None:
    """Each is one clear sentence."""
    with pytest.raises(InputError, match=message):
        variables(bounds, model)


def test_only_what_makes_no_model_is_blamed(model: Model) -> None:
    bounds = {"exosuit.length": ("8 cm", "9 cm"), "gravity.y": ("-9.81 m/s^2", "0 m/s^2")}
    with pytest.raises(InputError, match=r'^"gravity.y" cannot have all values between the bounds'):
        variables(bounds, model).slots(model)


def test_friction_that_the_file_has_not_is_said_to_be_absent() -> None:
    """Beside other friction, of which the model is made."""
    grasp = flexor.load("grasp")
    with pytest.raises(InputError, match="zero in the file, and the model is made without"):
        variables({"exosuit.friction": (0.0, 0.5)}, grasp).slots(grasp)


def test_what_changes_the_structure_or_nothing_is_refused(model: Model) -> None:
    """A place between elements and a field without effect cannot be varied."""
    plate = {"kind": "half-space", "point": {"z": "-20 cm"}, "normal": [0.0, 0.0, 1.0]}
    model = flexor.load(check(model.file.to_document() | {"obstacles": {"plate": plate}}))
    for bounds, message in (
        ({"proximal.at": (0.2, 0.3)}, '"proximal.at" cannot be varied: .* --choose'),
        ({"evaluation.pressure_step": ("10 kPa", "12 kPa")}, "no effect"),
        (
            {"exosuit.length": ("8 cm", "9 cm"), "plate.normal.0": (-0.1, 0.1)},
            '^"plate.normal.0" cannot be varied: it is fixed when the model is made',
        ),
    ):
        with pytest.raises(InputError, match=message):
            chosen = variables(bounds, model)
            chosen.designs(chosen.start[None, :], model)


def test_bounds_that_nothing_can_be_computed_with_are_refused() -> None:
    fields = {"exosuit.length": ("8 cm", "1e50 m")}
    problem = Problem.of("pneumatic-finger", fields, "maximise bending")
    with pytest.raises(InputError, match="a number is too large or too small to compute with"):
        problem.evaluate(problem.parameters.start[None])
