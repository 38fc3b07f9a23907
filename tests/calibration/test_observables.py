from __future__ import annotations

import numpy as np
import pytest

import flexor as package
from flexor.calibration.problem import bind_problem
from flexor.calibration.reading import parse

CONSTANT = """
[[constant]]
name = "E"
fields = ["exosuit.young_modulus"]
range = ["1 MPa", "4 MPa"]
"""


def observed(model, given: str, unit: str = "rad", count: int = 2) -> np.ndarray:
    values = ", ".join([f'"1 {unit}"' if unit else "1"] * count)
    text = f"""{CONSTANT}
    [[target]]
    name = "t"
    {given}
    value = [{values}]
    tolerance = {f'"1 {unit}"' if unit else "1"}
    """
    problem = bind_problem(parse(text, "made"), model, "made")
    return problem.runs[0].evaluate(np.array([[2.2285e6]]))[0]


@pytest.fixture(scope="module")
def path(coarse):
    return coarse.equilibrium([2, 5])


@pytest.mark.parametrize(
    ("given", "unit", "wanted"),
    [
        ('observable = "bending"', "rad", lambda p: p.joint_angles.sum(axis=1)),
        ('observable = "angle"\nof = "ph_2"', "deg", lambda p: p.joint_angles[:, 1]),
        ('observable = "angle"\nof = "ph_2.theta"', "rad", lambda p: p.joint_angles[:, 1]),
        ('observable = "tip-force"', "N", lambda p: p.tip_force),
        ('observable = "contacts"', "", lambda p: p.touching),
        ('observable = "x"\nof = "exosuit"', "cm", lambda p: _frame(p, "exosuit", -1)[:, 0, 3]),
        (
            'observable = "z"\nof = "exosuit"\nat = 0.5',
            "mm",
            lambda p: _frame(p, "exosuit", 6)[:, 2, 3],
        ),
        (
            'observable = "z"\nof = "ph_3"\nat = "base"',
            "mm",
            lambda p: _frame(p, "ph_3", 0)[:, 2, 3],
        ),
        ('observable = "y"\nof = "tip"', "mm", lambda p: np.zeros(2)),
        ('observable = "rotation"\nof = "tip"', "rad", lambda p: p.joint_angles.sum(axis=1)),
        (
            'observable = "rotation"\nof = "ph_2"',
            "rad",
            lambda p: p.joint_angles[:, :2].sum(axis=1),
        ),
    ],
)
def test_it_is_what_the_path_says(coarse, path, given, unit, wanted) -> None:
    found = observed(coarse, f'{given}\nforce = ["2 N", "5 N"]', unit)
    np.testing.assert_allclose(found, wanted(path), rtol=1e-6, atol=1e-9)


def test_the_rotation_of_a_curled_rod_counts_its_turns() -> None:
    # A free rod under a chamber's pure moment: curvature u lever S / (E I), all along.
    changes = {"exosuit.radius": "1 cm", "actuators.chamber.lever": 1.0}
    model = package.load("exosuit-alone", constants="printed", changes=changes)
    found = observed(model, 'observable = "rotation"\nof = "exosuit"\nforce = ["10 N", "60 N"]')
    inertia = np.pi / 4.0 * 0.01**4
    np.testing.assert_allclose(
        found, np.array([10.0, 60.0]) * 0.01 / (2.2285e6 * inertia) * 0.1, rtol=0.02
    )
    assert found[1] > np.pi


def test_only_the_last_force_counts_for_a_single_value(coarse, path) -> None:
    text = f"""{CONSTANT}
    [[target]]
    name = "t"
    observable = "bending"
    force = ["2 N", "5 N"]
    value = "1 rad"
    tolerance = "1 rad"
    """
    problem = bind_problem(parse(text, "made"), coarse, "made")
    found = problem.runs[0].evaluate(np.array([[2.2285e6]]))
    np.testing.assert_allclose(found, [[path.joint_angles[-1].sum()]], rtol=1e-6)


def test_targets_of_one_path_share_it(coarse) -> None:
    text = CONSTANT
    for name, joint, force in (
        ("a", "ph_1", "0:4:2"),
        ("b", "ph_2", "0:4:2"),
        ("c", "ph_1", "0:4:1"),
    ):
        text += f"""
        [[target]]
        name = "{name}"
        observable = "angle"
        of = "{joint}"
        force = "{force}"
        value = "1 rad"
        tolerance = "1 rad"
        """
    problem = bind_problem(parse(text, "made"), coarse, "made")
    assert [run.size for run in problem.runs] == [2, 1]
    x = np.array([[2.2285e6]])
    runs = [run.evaluate(x)[0] for run in problem.runs]
    found = [float(runs[run][part][0]) for run, part in problem.places]
    two, one = coarse.equilibrium("0:4:2"), coarse.equilibrium("0:4:1")
    wanted = [two.joint_angles[-1, 0], two.joint_angles[-1, 1], one.joint_angles[-1, 0]]
    np.testing.assert_allclose(found, wanted, rtol=1e-6)


def test_an_optimum_is_that_of_a_search(coarse) -> None:
    text = f"""{CONSTANT}
    [[target]]
    name = "where"
    observable = "optimum"
    parameters = "R01"
    of = "R_0"
    value = "1 cm"
    weight = "held-out"
    options = {{ starts = 1, tolerance = 0.05 }}
    [[target]]
    name = "how far"
    observable = "optimum"
    parameters = "R01"
    of = "bending"
    value = "1 rad"
    tolerance = "1 rad"
    options = {{ starts = 1, tolerance = 0.05 }}
    """
    problem = bind_problem(parse(text, "made"), coarse, "made")
    assert len(problem.runs) == 1
    found = problem.runs[0].evaluate(np.array([[2.2285e6]]))[0]
    model = package.load(coarse.file, changes={"exosuit.young_modulus": "2.2285 MPa"})
    study = package.optimize(
        model, "R01", "bending", method_options={"starts": 1, "tolerance": 0.05}
    )
    np.testing.assert_allclose(found[problem.places[0][1]], study.best.parameters["R_0"])
    np.testing.assert_allclose(found[problem.places[1][1]], study.best.bending)


def _frame(path, body: str, row: int) -> np.ndarray:
    return np.stack([path.frames(step)[body][row] for step in range(len(path))])
