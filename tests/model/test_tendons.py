"""Tendons in model files: what is refused, equilibria with known tensions, and derivatives."""

from __future__ import annotations

import numpy as np
import pytest

from flexor.design.drawn_file import drawn_file
from flexor.errors import InputError
from flexor.model import Model, parse
from flexor.observables import observables
from flexor.study import Problem

TEXT = """
name = "two-links"
planar = true
[bodies.a]
kind = "link"
length = "4 cm"
radius = "8 mm"
joint = { kind = "revolute", stiffness = "0.3 N*m/rad" }
[bodies.b]
kind = "link"
parent = "a"
length = "3 cm"
radius = "7 mm"
joint = { kind = "revolute", stiffness = "0.2 N*m/rad" }
[wraps]
knuckle = { kind = "cylinder", point = { body = "b", at = "base" }, radius = "6 mm" }
[tendons.fdp]
kind = "muscle"
max_force = "60 N"
optimal_length = "7 cm"
tendon_slack_length = "1 cm"
path = [
  { world = { x = "-2 cm", z = "-1.1 cm" } },
  { body = "a", at = 0.2, offset = { z = "-1.1 cm" } },
  { body = "a", at = 0.8, offset = { z = "-9 mm" } },
  { body = "b", at = 0.4, offset = { z = "-7 mm" } },
]
[tendons.edc]
kind = "spring"
stiffness = "2 N/mm"
slack_length = "65 mm"
path = [
  { world = { x = "-1 cm", z = "8 mm" } },
  { body = "a", at = 0.3, offset = { z = "7 mm" } },
  { wrap = "knuckle", side = { body = "b", at = "base", offset = { z = "5 cm" } } },
  { body = "b", at = 0.5, offset = { z = "5 mm" } },
]
[evaluation]
loads = { fdp = "0, 0.3, 0.6" }
"""


def test_forces_and_moments_balance() -> None:
    path = Model(parse(TEXT)).equilibrium()
    assert path.converged.all()
    assert path.stable.all()
    lengths, forces, arms = path.tendon_lengths(), path.tendon_forces(), path.moment_arms()
    fibres = (lengths["fdp"] - 0.01) / 0.07
    active = np.exp(-((fibres - 1.0) ** 2) / 0.45)
    rest = np.exp(-5.0 / 0.6)
    passive = (np.exp(5.0 * (fibres - 1.0) / 0.6) - rest) / (np.exp(5.0) - rest)
    activation = np.array([0.0, 0.3, 0.6])
    assert forces["fdp"] == pytest.approx(60.0 * (activation * active + passive), rel=1e-12)
    s, w = lengths["edc"] - 0.065, 0.02 * 0.065
    assert (s[1:] > w).all()
    assert forces["edc"][1:] == pytest.approx(2e3 * (s[1:] - 0.5 * w), rel=1e-12)
    # Over the pulley at the joint.
    assert arms["edc"]["b.theta"][1:] == pytest.approx(-0.006, rel=1e-12)
    for joint, stiffness in (("a.theta", 0.3), ("b.theta", 0.2)):
        angle = path.joint_angles[:, path.model.joints.index(joint)]
        moment = sum(forces[name] * arms[name][joint] for name in forces)
        assert moment == pytest.approx(stiffness * angle, rel=1e-9, abs=1e-9)


def test_a_tendon_that_pushes_is_named() -> None:
    links = TEXT.split("[tendons.fdp]")[0]
    path = '[{ world = { z = "-1.1 cm" } }, { body = "b", at = 0.4, offset = { z = "-7 mm" } }]'
    model = Model(parse(f'{links}[tendons.fdp]\nkind = "cable"\npath = {path}\n'))
    assert model.equilibrium([1.0]).warnings == []
    assert model.equilibrium([1.0, 0.0, -0.5]).warnings == [
        'tendon "fdp" has a tension of -0.5 N, from -0.5 N on below 0: a cable can only pull'
    ]


def test_observables_are_what_the_path_reports() -> None:
    model = Model(parse(TEXT))
    path = model.equilibrium()
    found = {name: each.values(path.as_batch)[0] for name, each in observables(model).items()}
    assert found["tendon-length.edc"] == pytest.approx(path.tendon_lengths()["edc"])
    assert found["tendon-force.fdp"] == pytest.approx(path.tendon_forces()["fdp"])
    assert found["moment-arm.fdp.a"] == pytest.approx(path.moment_arms()["fdp"]["a.theta"])
    assert found["effort"] == pytest.approx([0.0, 0.09, 0.36])
    assert path.to_dict()["tendon_force"]["edc"] == path.tendon_forces()["edc"].tolist()


def test_derivatives_of_tendons_by_their_sizes_and_loads() -> None:
    """Against sixth-order differences of paths."""
    model = Model(parse(TEXT))
    fields = {
        "evaluation.loads.fdp": (0.3, 0.6),
        "fdp.max_force": ("40 N", "80 N"),
        "fdp.tendon_slack_length": ("5 mm", "15 mm"),
        "fdp.optimal_length": ("6 cm", "8 cm"),
        "edc.stiffness": ("1 N/mm", "3 N/mm"),
        "edc.slack_length": ("62 mm", "68 mm"),
        "knuckle.radius": ("5.5 mm", "6.5 mm"),
        "a.length": ("38 mm", "42 mm"),
    }
    bounded = ["tendon-length.edc <= 1 mm at end", "tendon-force.fdp <= 1 N at end"]
    bounded += ["tendon-force.edc <= 1 N at end", "effort <= 0.1 at end"]
    bounded += ["angle.b <= 1 deg at end"]
    problem = Problem.of(
        model, fields, "minimise effort", subject_to=bounded, options={"tolerance": 1e-12}
    )
    chosen = problem.parameters
    span = chosen.upper - chosen.lower
    x = (chosen.lower + 0.4 * span)[None]
    here = problem.evaluate(x, gradient=True)
    assert here.regularity[0] == "regular"
    exact = np.vstack([here.value_gradient, here.constraint_gradients[0]]) * span
    differences = np.zeros_like(exact)
    stencil = {1: 45 / 60, 2: -9 / 60, 3: 1 / 60, -1: -45 / 60, -2: 9 / 60, -3: -1 / 60}
    step = 1e-3
    for k in range(chosen.size):
        for at, weight in stencil.items():
            moved = problem.evaluate(x + at * step * span * np.eye(chosen.size)[k])
            values = np.concatenate([moved.value, moved.constraint_values[0]])
            differences[:, k] += weight * values / step
    size = np.abs(exact).max(axis=1)
    assert (size > 0.0).all()
    assert (np.abs(exact - differences).max(axis=1) / size).max() < 1e-6


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('wrap = "knuckle"', 'wrap = "knukle"', 'unknown wrap "knukle" (did you mean "knuckle"?)'),
        ('{ body = "a", at = 0.3', '{ branch = 2 }, { body = "a", at = 0.3', "before two points"),
        ('kind = "spring"', 'kind = "string"', 'unknown kind "string" (did you mean "spring"?)'),
        ('stiffness = "2 N/mm"\n', "", "tendons.edc.stiffness is missing"),
        ('slack_length = "65 mm"', 'slack_length = "0 mm"', "tendons.edc.slack_length is"),
        ('max_force = "60 N"', 'max_force = "-1 N"', "tendons.fdp.max_force is"),
        ('max_force = "60 N"', "max_force = 60", "a number without a unit"),
        ('body = "a", at = 0.2', 'body = "c", at = 0.2', 'unknown body "c"'),
        ('radius = "6 mm"', 'radius = "6 mm", axis = "x"', "in a planar model it must be y"),
        ('kind = "cylinder"', 'kind = "sphere", axis = "y"', "is given, but a sphere has none"),
        ("at = 0.2, offset = { z", "at = 0.2, offset = { y", "tendons.fdp.path[1].offset"),
        (
            'kind = "muscle"',
            'kind = "muscle"\ncurve = { kind = "parabolic", lower_length = 1.1 }',
            "lower_length is 1.1: it must be below 1",
        ),
        ("[tendons.edc]", "[tendons.a]", "has the same name as bodies.a"),
    ],
)
def test_tendons_that_are_refused(old: str, new: str, message: str) -> None:
    assert old in TEXT
    with pytest.raises(InputError) as error:
        parse(TEXT.replace(old, new, 1))
    assert message in str(error.value)


def test_a_design_with_loads_among_its_variables_can_be_drawn() -> None:
    model = Model(parse(TEXT))
    fields = {"evaluation.loads.fdp": (0.3, 0.6), "knuckle.radius": ("5 mm", "7 mm")}
    problem = Problem.of(model, fields, "minimise effort")
    drawn = drawn_file(problem.parameters, np.array([0.5, 0.0065]), model)
    assert float(drawn.wraps["knuckle"].radius) == 0.0065
    assert drawn.evaluation == model.file.evaluation
