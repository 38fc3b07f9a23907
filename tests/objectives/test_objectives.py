"""Objectives by hand on small paths, their derivatives, and designs that failed."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import flexor
from flexor.errors import InputError
from flexor.model import Paths
from flexor.objectives import (
    Objective,
    PathGradient,
    custom,
    evaluate_objective,
    names,
    objective,
)

N, STEPS, JOINTS = 4, 6, 3


def paths() -> Paths:
    random = np.random.default_rng(11)
    return Paths(
        model=SimpleNamespace(first_spheres=42, show_loads=lambda u: f"{u[0]:g} N"),  # type: ignore[arg-type]
        loads=np.arange(6.0)[:, None],
        joint_angles=random.uniform(-0.2, 1.2, (N, STEPS, JOINTS)),
        tip_force=random.uniform(0.1, 0.5, (N, STEPS)),
        touching=random.integers(1, 20, (N, STEPS)),
        converged=np.ones((N, STEPS), dtype=bool),
        stable=np.ones((N, STEPS), dtype=bool),
    )


def test_values_by_hand() -> None:
    given = paths()
    for i in range(N):
        theta, contacts = given.joint_angles[i, 5], given.touching[i, 5]
        bend = sum((3.141592653589793 - angle) ** 2 for angle in theta)
        by_hand = {
            "bending": (bend**0.5, theta.sum()),
            "tip-force": (-given.tip_force[i, 5], given.tip_force[i, 5]),
            "bending-contact": (
                (bend + (3.141592653589793 * (42 - contacts) / 42) ** 2) ** 0.5,
                theta.sum(),
            ),
            "bending-contact-printed": ((bend + contacts**2) ** 0.5, theta.sum()),
        }
        assert set(by_hand) == set(names())
        for name, (value, shown) in by_hand.items():
            assert objective(name).value(given)[i] == pytest.approx(value, rel=1e-14)
            assert objective(name).shown(given)[i] == pytest.approx(shown, rel=1e-14)


def test_one_reading_rewards_contact_and_the_printed_one_avoids_it() -> None:
    few, many = paths(), replace(paths(), touching=paths().touching + 10)
    intended, printed = objective("bending-contact"), objective("bending-contact-printed")
    assert np.all(intended.value(many) < intended.value(few))
    assert np.all(printed.value(many) > printed.value(few))


def moved(given: Paths, field: str, index: tuple[int, ...], step: float) -> Paths:
    changed = getattr(given, field).copy()
    changed[(slice(None), *index)] += step
    return replace(given, **{field: changed})


@pytest.mark.parametrize("name", names())
def test_gradients_agree_with_finite_differences(name: str) -> None:
    given, chosen, h = paths(), objective(name), 1e-5

    def check(gradient: PathGradient, function: Any) -> None:
        for field in ("joint_angles", "tip_force"):
            found = getattr(gradient, field)
            for index in np.ndindex(getattr(given, field).shape[1:]):
                up, down = moved(given, field, index, h), moved(given, field, index, -h)
                slope = (function(up) - function(down)) / (2 * h)
                np.testing.assert_allclose(found[(..., *index)], slope, atol=1e-9)

    check(chosen.gradient(given), chosen.value)
    if name != "tip-force":
        check(chosen.residual_gradient(given), chosen.residual)
        np.testing.assert_allclose(
            np.linalg.norm(chosen.residual(given), axis=1), chosen.value(given), rtol=1e-14
        )


def test_values_do_not_depend_on_the_batch() -> None:
    given = paths()
    for name in names():
        together = objective(name).value(given)
        alone = [objective(name).value(given[np.arange(N) == i])[0] for i in range(N)]
        assert together.tobytes() == np.array(alone).tobytes()


@pytest.mark.parametrize("chosen", [objective(name) for name in names()])
def test_designs_that_failed_have_a_reason_and_no_number(chosen: Objective) -> None:
    given = paths()
    given.converged[0, 3:] = False
    given.joint_angles[0, 3:] = np.nan
    given.stable[1, 5] = False
    given.tip_force[2, 4] = np.inf
    status = np.full((N, STEPS), "converged", dtype=object)
    status[0, 3] = "iteration limit"
    evaluated = evaluate_objective(chosen, replace(given, status=status))
    assert evaluated.reason.tolist() == [
        "did not converge at 3 N (iteration limit)",
        "is unstable at 5 N",
        "is not a finite number at 4 N",
        "",
    ]
    assert evaluate_objective(chosen, given).reason[0] == "did not converge at 3 N"
    status[0, 3] = "invalid-design"
    reason = evaluate_objective(chosen, replace(given, status=status)).reason[0]
    assert reason.startswith("cannot exist: a number is not finite, a length, radius or modulus")
    np.testing.assert_array_equal(evaluated.value[:3], np.inf)
    assert evaluated.value[3] == chosen.value(given[np.arange(N) == 3])[0]
    assert np.isnan(evaluated.shown[:3]).all()
    assert np.isfinite(evaluated.shown[3])


def test_a_users_own_objective_is_one_function_of_the_path() -> None:
    def first_joint(path: Any) -> float:
        assert path.force.shape == (6,)
        return -float(path.joint_angles[-1, 0])

    mine = custom("first joint", first_joint, quantity="first joint", unit="rad")
    assert mine.loads is None
    given = paths()
    np.testing.assert_array_equal(mine.value(given), -given.joint_angles[:, 5, 0])
    given.converged[1, 2] = False
    asked = []
    watched = custom("watched", lambda path: asked.append(path) or 1.0)
    assert evaluate_objective(watched, given).value.tolist() == [1.0, np.inf, 1.0, 1.0]
    assert len(asked) == 2 * 3  # value and quantity of the three good designs


def test_a_users_nan_is_a_failure_and_a_users_array_is_refused() -> None:
    evaluated = evaluate_objective(custom("nothing", lambda path: float("nan")), paths())
    assert evaluated.value.tolist() == [np.inf] * N
    assert evaluated.reason.tolist() == ['objective "nothing" gave nan'] * N
    with pytest.raises(InputError, match='objective "many" must give one number'):
        evaluate_objective(custom("many", lambda path: path.joint_angles), paths())


def test_a_users_objective_cannot_change_the_path() -> None:
    given = paths()
    before = given.joint_angles.copy()

    def straightened(path: Any) -> float:
        path.joint_angles[:] = 0.0
        return 0.0

    with pytest.raises(InputError, match="failed: assignment destination is read-only"):
        evaluate_objective(custom("straightened", straightened), given)
    np.testing.assert_array_equal(given.joint_angles, before)


def test_loads_can_be_changed() -> None:
    assert objective("bending").at([0, 2.5]).loads == ((0.0,), (2.5,))


@pytest.mark.parametrize(
    ("alias", "name"),
    [
        ("f_b", "bending"),
        ("F_exo", "tip-force"),
        ("f_bc", "bending-contact"),
        ("Tip_Force", "tip-force"),
    ],
)
def test_paper_symbols_are_names_too(alias: str, name: str) -> None:
    assert objective(alias).name == name


def test_both_spellings_of_what_is_sought_are_read() -> None:
    model = flexor.load("pneumatic-finger")
    assert objective("maximize bending", model).name == "maximise bending"
    with pytest.raises(
        InputError, match='"minimise": say what, such as "minimise range-of-motion"'
    ):
        objective("minimise", model)


def test_unknown_names_and_missing_gradients_are_refused() -> None:
    with pytest.raises(InputError, match=r'unknown objective "bendin" \(did you mean "bending"'):
        objective("bendin")
    with pytest.raises(InputError, match='objective "mine" has no gradient'):
        custom("mine", lambda path: 0.0).gradient(paths())
    with pytest.raises(InputError, match="not the norm of a vector"):
        objective("tip-force").residual(paths())
    with pytest.raises(InputError, match="the model has no contact"):
        objective("f_bc").value(replace(paths(), model=SimpleNamespace(first_spheres=0)))
    with pytest.raises(InputError, match="the model has no contact"):
        objective("f_exo").value(replace(paths(), model=SimpleNamespace(first_spheres=0)))
    with pytest.raises(InputError, match="needs joints, but the model has none"):
        objective("f_b").value(replace(paths(), joint_angles=np.zeros((N, STEPS, 0))))
