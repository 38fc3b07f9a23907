"""Constants through the engine's parameters are the constants of a rebuilt model."""

from __future__ import annotations

import numpy as np
import pytest

import flexor as package
from flexor.calibration.constants import Constant
from flexor.calibration.problem import bind_problem
from flexor.calibration.reading import parse
from flexor.calibration.system import System
from flexor.design import parameter_set
from flexor.model.quantity import infer_quantity

RANGES = {
    "exosuit.young_modulus": ("1 MPa", "4 MPa"),
    "chamber.lever": (2.0, 5.0),
    "skin.stiffness": ("20 N/m", "300 N/m"),
    "bodies.exosuit.placement.z": ("2 cm", "2.4 cm"),
    "exosuit.placement.x": ("-1 cm", "1 cm"),
    "ph_1.joint.stiffness": ("0.02 N*m/rad", "0.08 N*m/rad"),
    "ph_2.length": ("2 cm", "3 cm"),
    "ph_3.radius.tip": ("0.6 cm", "1 cm"),
    "exosuit.length": ("9 cm", "11 cm"),
    "exosuit.radius.base": ("1 cm", "1.2 cm"),
    "exosuit.density": ("0 kg/m^3", "1000 kg/m^3"),
    "gravity.z": ("-9.81 m/s^2", "0 m/s^2"),
    "ph_1.joint.limit_stiffness": ("1 N*m/rad", "100 N*m/rad"),
    "exosuit.poisson_ratio": (0.3, 0.5),
}
NOT_PARAMETERS = {"gravity.z"}


def constants(*fields: str) -> tuple[Constant, ...]:
    made = []
    for field in fields:
        low, high = RANGES[field]
        (least, _), (most, unit) = infer_quantity(low, "low"), infer_quantity(high, "high")
        made.append(Constant(field, (field,), least, most, False, unit))
    return tuple(made)


def system(model, *fields: str) -> System:
    return System("finger", model.file, constants(*fields), "made")


@pytest.mark.parametrize("field", sorted(set(RANGES) - {"exosuit.poisson_ratio"}))
def test_one_constant(coarse, field: str) -> None:
    made = system(coarse, field)
    assert (made.rates is None) == (field in NOT_PARAMETERS)
    if made.rates is not None:
        for share in (0.0, 0.3, 1.0):
            x = made.constants[0].value(np.array([share]))
            expected = made.model(x).parameters
            found = made.reference.parameters + made.rates @ (x - made.middle)
            np.testing.assert_allclose(found, expected, rtol=1e-9, atol=1e-300)


def test_what_is_not_proportional_is_seen(coarse) -> None:
    # The shear modulus is E / (2 (1 + nu)).
    assert system(coarse, "exosuit.young_modulus", "exosuit.poisson_ratio").rates is None


TARGETS = """
[[constant]]
name = "E"
fields = ["exosuit.young_modulus"]
range = ["1 MPa", "4 MPa"]
scale = "log"
[[constant]]
name = "lever"
fields = ["chamber.lever"]
range = [2.0, 5.0]
[[constant]]
name = "height"
fields = ["exosuit.placement.z"]
range = ["2.1 cm", "2.2 cm"]
[[constant]]
name = "limit"
fields = [{limit}]
range = [{between}]
[[target]]
name = "own"
observable = "bending"
force = ["1 N", "3 N"]
value = ["0.2 rad", "0.5 rad"]
tolerance = "0.01 rad"
[[target]]
name = "design"
observable = "bending"
parameters = "L+R01"
design = {{ L = "10.8 cm", R_0 = "0.65 cm", R_1 = "0.74 cm" }}
force = "0:3:1"
value = "1 rad"
tolerance = "0.01 rad"
"""
SPREAD = np.array([[0.5, 0.5, 0.5, 0.5], [0.1, 0.8, 0.2, 0.9], [0.9, 0.3, 1.0, 0.0]])


@pytest.mark.parametrize(
    ("field", "between", "rebuilt"),
    [
        ("ph_1.joint.limit_stiffness", '"0.03 N*m/rad", "0.05 N*m/rad"', False),
        ("gravity.z", '"-9.81 m/s^2", "0 m/s^2"', True),
    ],
)
def test_paths_are_those_of_the_model_with_these_constants(
    coarse, field: str, between: str, rebuilt: bool
) -> None:
    text = TARGETS.format(limit=f'"{field}"', between=between)
    problem = bind_problem(parse(text, "made"), coarse, "made")
    x = problem.x(SPREAD)
    assert [run.system.rates is None for run in problem.runs] == [rebuilt, rebuilt]
    for run in problem.runs:
        found = run.evaluate(x)
        for row, values in zip(found, x, strict=True):
            model = run.system.model(values)
            design = None
            if run.design is not None:
                chosen = parameter_set("L+R01", model.design)
                design = chosen.geometry([[0.108, 0.0065, 0.0074]], model.X)
            path = model.equilibrium(run.loads[:, 0], design=design)
            bending = path.joint_angles.sum(axis=1)
            wanted = bending if len(row) == 2 else bending[-1:]
            np.testing.assert_allclose(row, wanted, rtol=1e-7)


def test_one_constant_sets_fields_of_several_models_and_bodies() -> None:
    text = """
    [models]
    two = "finger-2-links"
    [[constant]]
    name = "K"
    fields = ["ph_1.joint.stiffness", "ph_12.joint.stiffness", "ph_3.joint.stiffness"]
    range = ["0.01 N*m/rad", "0.1 N*m/rad"]
    [[target]]
    name = "t"
    observable = "bending"
    value = "1 rad"
    tolerance = "1 rad"
    """
    problem = bind_problem(parse(text, "made"), package.load("finger", "calibrated"), "made")
    three, two = (system.model([0.05]) for system in problem.systems.values())
    for model, joints in ((three, ("ph_1", "ph_3")), (two, ("ph_12", "ph_3"))):
        for joint in joints:
            assert model.slot(f"{joint}.joint_stiffness").tolist() == [0.05]
    assert three.slot("ph_2.joint_stiffness").tolist() == [0.03]
