"""Exact derivatives of every observable by every kind of variable, against differences of paths."""

from __future__ import annotations

from pathlib import Path as FilePath

import numpy as np
import pytest

import flexor
from benchmarks._variables import FIELDS
from flexor.errors import InputError
from flexor.model import Model, parse
from flexor.observables import observables
from flexor.study import Problem

EXAMPLE = FilePath(__file__).parents[2] / "examples" / "pneumatic-finger.toml"
# Sixth order.
STENCIL = {1: 45 / 60, 2: -9 / 60, 3: 1 / 60, -1: -45 / 60, -2: 9 / 60, -3: -1 / 60}
STEP = 1e-4
# Derivatives are those of the model with its mesh, whatever it is. Straps are between elements.
COARSE = {"exosuit.elements": 8, "proximal.at": 0.25, "middle.at": 0.625, "distal.at": 0.875}
TIGHT = {"tolerance": 1e-12}
NO_SLOPE = ("energy", "snap-margin", "efficiency", "tip-stiffness")  # observables without


def _bounded(model: Model) -> tuple[str, ...]:
    """Return a constraint on every observable with derivatives, at its worst along the path."""
    made = []
    for name, each in observables(model).items():
        sense, unit = (">=" if name == "min-stretch" else "<="), each.unit[1]
        # Above what the loads go to.
        bound = 1000 if name.startswith("pressure") else 1
        made.append(f"{name} {sense} {bound} {unit}".rstrip())
    return tuple(text for text in made if not text.startswith(NO_SLOPE))


def _compare(problem: Problem, count: int, seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Return errors (n, 1 + c), relative to the largest component, and where they must vanish."""
    chosen = problem.parameters
    span = chosen.upper - chosen.lower
    u = np.random.default_rng(seed).uniform(0.05, 0.95, (count, chosen.size))
    x = chosen.lower + u * span
    here = problem.evaluate(x, gradient=True)
    exact = np.concatenate([here.value_gradient[:, None], here.constraint_gradients], axis=1)
    exact *= span
    regular = np.column_stack([here.regularity, here.constraint_regularity]) == "regular"
    differences = np.zeros_like(exact)
    for k in range(chosen.size):
        for at, weight in STENCIL.items():
            moved = problem.evaluate(x + at * STEP * span * np.eye(chosen.size)[k])
            values = np.column_stack([moved.value, moved.constraint_values])
            differences[:, :, k] += weight * values / STEP
            regular &= (moved.event_count == here.event_count)[:, None]
            regular &= (moved.touching == here.touching).all(axis=1)[:, None]
    # What vanishes, such as the bending at rest, is small against a display unit.
    unit = np.array([1e-2, *(1e-2 * each.scale for each in problem.constraints)])
    size = np.maximum(np.abs(exact).max(axis=2), unit)
    error = np.abs(exact - differences).max(axis=2) / size
    return error, regular


def test_gradients_of_all_observables_are_those_of_differences() -> None:
    """On the pneumatic finger, which cannot touch itself, whatever its length."""
    model = flexor.load(EXAMPLE, changes={**COARSE, "exosuit.self_contact": False})
    problem = Problem.of(
        model, FIELDS, "maximise range-of-motion", subject_to=_bounded(model), options=TIGHT
    )
    error, regular = _compare(problem, 8, 0)
    # At least half of the designs for what is not tied by nature, as the stretch at rest is.
    tied = [each.name in ("min-stretch", "bending") for each in problem.constraints]
    assert (regular[:, ~np.array([False, *tied])].mean(axis=0) >= 0.5).all()
    assert error[regular].max() <= 1e-6


# A strap around a link, an obstacle, a stress limit and constants of a law.
DEVICE = """
[spheres.pad]
points = [{ body = "ph_3", at = "tip" }]

[obstacles.plate]
kind = "half-space"
spheres = ["pad"]
point = { z = "-4 cm" }
normal = [0, 0, 1]
stiffness = "2 kN/m"
"""


def _device() -> Model:
    text = EXAMPLE.read_text(encoding="utf-8")
    silicone = 'silicone = { library = "dragon-skin-30", winding = "hoop" }'
    ogden = (
        'silicone = { kind = "ogden", mu = ["0.2 MPa"], alpha = [2.5], winding = "hoop", '
        'stress_limit = "200 kPa", density = "1080 kg/m^3" }'
    )
    pinned, looped = 'to = { body = "ph_2", at = 0.6 }', 'to = { body = "ph_2", loop = true }'
    assert silicone in text
    assert pinned in text
    text = text.replace(silicone, ogden).replace(pinned, f'{looped}, pretension = "2 N"')
    return Model(parse(text + DEVICE, changes=COARSE))


def test_derivatives_do_not_depend_on_the_batch() -> None:
    """They are the same bits alone and with others, or a repeated study could differ."""
    model = flexor.load("pneumatic-finger", changes=COARSE)
    varied = {name: FIELDS[name] for name in ("exosuit.length", "exosuit.section.wall")}
    problem = Problem.of(model, varied, "minimise mass", subject_to=_bounded(model))
    chosen = problem.parameters
    x = chosen.lower + np.random.default_rng(2).random((8, 2)) * (chosen.upper - chosen.lower)
    batch = problem.evaluate(x, gradient=True)
    for row in range(len(x)):
        alone = problem.evaluate(x[[row]], gradient=True)
        for name in ("value_gradient", "constraint_gradients", "derivatives"):
            assert getattr(alone, name)[0].tobytes() == getattr(batch, name)[row].tobytes()


def test_gradients_of_a_device_that_presses_on_an_obstacle() -> None:
    model = _device()
    fields = {
        "exosuit.length": ("9.5 cm", "10.5 cm"),
        "exosuit.radius.base": ("7 mm", "9 mm"),
        "silicone.alpha.0": (2.4, 2.6),
        "middle.pretension": ("1 N", "3 N"),
        "plate.stiffness": ("1 kN/m", "3 kN/m"),
        "ph_3.radius.tip": ("8 mm", "9 mm"),
    }
    problem = Problem.of(
        model, fields, "maximise obstacle-force", subject_to=_bounded(model), options=TIGHT
    )
    error, regular = _compare(problem, 4, 1)
    assert regular.any(axis=0).sum() >= 15
    assert error[regular].max() <= 1e-6


# The cylinder without friction.
SMOOTH = {"obstacles.cylinder.friction": 0.0}


def test_gradients_by_place_and_size_of_an_obstacle_that_skins_press_on() -> None:
    fields = {
        "obstacles.cylinder.radius": ("2.8 cm", "3.2 cm"),
        "obstacles.cylinder.point.x": ("5 cm", "5.4 cm"),
        "obstacles.cylinder.point.z": ("-4.9 cm", "-4.6 cm"),
        "ph_2.skin.thickness": ("1.5 mm", "2.5 mm"),
        "ph_3.radius.tip": ("8 mm", "9 mm"),
    }
    problem = Problem.of(
        flexor.load(EXAMPLE.with_name("grasp.toml"), changes=SMOOTH),
        fields,
        "maximise obstacle-force",
        force={"chamber": ["0 kPa", "30 kPa", "60 kPa"]},
        subject_to=["tip-force <= 1 N"],
        options=TIGHT,
    )
    error, regular = _compare(problem, 2, 3)
    assert regular[:, 0].all()
    assert error[regular].max() <= 1e-6


def test_gradients_of_the_pressure_of_skins_on_an_obstacle() -> None:
    """The exosuit's floor is soft, so that the pressure is largest on the cylinder."""
    soft = {**SMOOTH, "bodies.exosuit.skin.thickness": "1 m"}
    model = flexor.load(EXAMPLE.with_name("grasp.toml"), changes=soft)
    force = {"chamber": ["0 kPa", "30 kPa", "60 kPa"]}
    assert model.equilibrium(force)[-1].extremes()["max_contact_pressure"].on == "cylinder"
    fields = {
        "obstacles.cylinder.radius": ("2.8 cm", "3.2 cm"),
        "obstacles.cylinder.point.z": ("-4.9 cm", "-4.6 cm"),
        "ph_2.skin.thickness": ("1.8 mm", "2.2 mm"),
    }
    problem = Problem.of(
        model,
        fields,
        "minimise contact-pressure",
        force=force,
        subject_to=["obstacle-force >= 0.1 N"],
        options=TIGHT,
    )
    error, regular = _compare(problem, 2, 3)
    assert regular[:, 0].any()
    assert error[regular].max() <= 1e-6


def test_gradients_of_a_pressure_that_is_found() -> None:
    """The volume of the cavity is given, in addition to that at rest."""
    model = flexor.load(EXAMPLE, changes={"actuators.chamber.control": "volume"})
    fields = {name: FIELDS[name] for name in ("exosuit.length", "exosuit.section.wall")}
    subject = ["pressure.chamber <= 60 kPa", "volume.chamber <= 20 mL", "bending >= 0 deg"]
    problem = Problem.of(
        model,
        fields,
        "minimise pressure",
        force={"chamber": ["0 mL", "0.5 mL", "1 mL"]},
        subject_to=subject,
        options=TIGHT,
    )
    error, regular = _compare(problem, 4, 3)
    assert regular[:, 0].sum() >= 3
    assert error[regular].max() <= 1e-6


def test_what_a_derivative_is_worth_is_said() -> None:
    """Equal stretches at rest are tied; the energy has no derivative, and differences are taken."""
    model = flexor.load(EXAMPLE)
    fields = {"exosuit.length": FIELDS["exosuit.length"]}
    problem = Problem.of(
        model,
        fields,
        "maximise range-of-motion",
        subject_to=["min-stretch >= 0.2", "energy <= 1 J"],
        without=["defaults"],
    )
    paths = problem.evaluate(problem.parameters.start[None], gradient=True)
    assert paths.constraint_regularity.tolist() == [["tied", "no-derivative"]]
    assert not problem.linearizable
    with pytest.raises(InputError, match='objective "minimise energy" has no gradient'):
        Problem.of(model, fields, "minimise energy").gradients(paths)
