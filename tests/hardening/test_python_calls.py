"""Arguments of Python calls in the forms that the commands take, and wrong ones in one sentence."""

from __future__ import annotations

import pickle
from typing import Any

import numpy as np
import pytest

import flexor
from flexor.design import parameter_set
from flexor.errors import InputError


@pytest.fixture(scope="module")
def model() -> Any:
    return flexor.load("finger")


def designs(study: Any) -> Any:
    return study.record.designs()


@pytest.mark.parametrize(
    ("given", "same"),
    [
        ({"force": {"chamber": "0:4:1"}}, {"force": [0, 1, 2, 3, 4]}),
        ({"force": "0:4:1"}, {"force": [0, 1, 2, 3, 4]}),
        ({"start": "9 cm, 0.7 cm, 0.8 cm"}, {"start": [0.09, 0.007, 0.008]}),
        ({"start": ["L=9 cm"]}, {"start": [0.09, 0.0116, 0.008]}),
        ({"bounds": {"L": ("7 cm", "12 cm")}}, {"bounds": {"L": (0.07, 0.12)}}),
        ({"parameters": ["L", "R01"]}, {"parameters": "L+R01"}),
    ],
)
def test_forms_of_the_command_line(model: Any, given: Any, same: Any) -> None:
    first, second = (flexor.optimize(model, budget=4, **each) for each in (given, same))
    np.testing.assert_allclose(designs(first), designs(second), rtol=1e-15)
    assert first.best.value == pytest.approx(second.best.value, rel=1e-12)


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"force": {"cable": 5}}, 'unknown input "cable"'),
        ({"start": "9 kg, 1, 1"}, 'start has L = "9 kg"'),
        ({"start": "50 cm, 0.7 cm, 0.8 cm"}, "outside its bounds 6 to 14 cm"),
        ({"start": [object()]}, "start must be numbers"),
        ({"bounds": {"L": ("7 kg", "1 m")}}, 'bounds has L = "7 kg"'),
        ({"bounds": {"L": 7}}, "expected a lower and an upper bound"),
        ({"bounds": {"L": (0.07, 10**400)}}, "bounds has L: a number is too large"),
        ({"bounds": [("7 cm", "12 cm")]}, 'must be a mapping of parameters to pairs, such as {"L"'),
        ({"bounds": {"L": (None, 1)}}, "bounds has L = None"),
        ({"parameters": []}, "parameter set is []"),
        ({"folder": 3}, "folder is 3: it must be a path."),
        ({"method_options": [1]}, "method_options is a list: it must be a mapping of options"),
        ({"seed": -1}, "seed is -1: it must be at least 0."),
        ({"seed": 1.5}, "seed is 1.5: it must be an integer of at least 0."),
        ({"budget": "x"}, 'budget is "x": it must be an integer of at least 1.'),
        ({"budget": 2.5}, "budget is 2.5: it must be an integer of at least 1."),
        ({"budget": True}, "budget is true: it must be an integer of at least 1."),
        ({"progress": 3}, "progress is 3: it must be a function."),
        ({"finish": 3}, "finish is 3: it must be a function."),
        ({"executor": len}, "executor is a builtin_function_or_method: give a concurrent.futures"),
        ({"engine_options": {"max_iterations": 0}}, "solver option max_iterations is 0"),
    ],
)
def test_wrong_forms(model: Any, tmp_path: Any, given: Any, words: str) -> None:
    with pytest.raises(InputError) as caught:
        flexor.optimize(model, **{"budget": 4, "folder": tmp_path / "s", **given})
    assert words in str(caught.value)
    assert list(tmp_path.iterdir()) == []


def test_a_seed_may_be_of_numpy(model: Any, tmp_path: Any) -> None:
    flexor.optimize(model, budget=np.int64(3), seed=np.int32(2), folder=tmp_path / "s").close()
    assert flexor.study.resume(tmp_path / "s", budget=np.int64(4)).evaluations == 4


def test_geometry_and_threads(model: Any) -> None:
    with pytest.raises(InputError, match="the geometry is a list"):
        model.evaluate([1, 2, 3])
    geometry = parameter_set("L", model.design).geometry([[0.1]], model.X)
    for wrong in (-1, 1.5, "2", True):
        with pytest.raises(InputError, match="threads is"):
            model.evaluate(geometry, threads=wrong)
    few = model.evaluate(geometry, threads=1)
    for many in (100_000, 2**64):
        assert np.array_equal(model.evaluate(geometry, threads=many).q, few.q)


def test_pickled_study(model: Any) -> None:
    study = flexor.optimize(model, "L", budget=4)
    assert pickle.loads(pickle.dumps(study)).best.value == study.best.value


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"exosuit.E": "1 MPa"}, 'did you mean "young_modulus"?'),
        ({"ph_1.joint.stiffness": "0.05 Nm/rad"}, 'did you mean "N*m/rad"?'),
        ({"design.minimum_radius": "5 cm"}, "must not be above the upper of radius_bounds"),
        (
            {"exosuit.strain.bend_y": {"basis": "monomial", "order": 11}},
            'use the basis "legendre"',
        ),
    ],
)
def test_models(changes: Any, words: str) -> None:
    with pytest.raises(InputError) as caught:
        flexor.load("finger", changes=changes)
    assert words in str(caught.value)


def test_no_model() -> None:
    with pytest.raises(InputError, match="expected a file"):
        flexor.load(None)  # type: ignore[arg-type]
