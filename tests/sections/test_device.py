"""The strapped pneumatic finger, and devices drawn at random."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import tomli_w

from flexor.design import parameter_set
from flexor.errors import InputError
from flexor.model import MEANINGS, Model, load, parse

EXAMPLE = Path(__file__).parents[2] / "examples" / "pneumatic-finger.toml"
# Tighter than by default: differences divide what is left.
TIGHT = {"tolerance": 1e-12}
STEP = 1e-5
# Sixth order.
STENCIL = {1: 45 / 60, 2: -9 / 60, 3: 1 / 60, -1: -45 / 60, -2: 9 / 60, -3: -1 / 60}


@pytest.fixture(scope="module")
def device() -> Model:
    return load(EXAMPLE)


def test_the_example_bends_the_finger(device: Model) -> None:
    path = device.equilibrium()
    assert path.stable.all()
    bending = path.joint_angles.sum(axis=1)
    assert (np.diff(bending) > 0.0).all()
    assert bending[-1] > 0.5
    assert path.warnings == []
    assert (np.diff(path.volume[:, 0]) > 0.0).all()
    assert all(forces[-1] > 0.0 for forces in path.strap_forces().values())


def test_derivatives_are_those_of_differences(device: Model) -> None:
    chosen = parameter_set("L+R01", device.design)
    span = chosen.upper - chosen.lower
    p = chosen.lower + span * np.random.default_rng(5).uniform(0.1, 0.9, (6, chosen.size))
    here = device.evaluate(chosen.geometry(p, device.X), gradient=True, **TIGHT)
    exact = here.chained(chosen.jacobian(p, device.X)) * span
    smooth = np.repeat((here.regularity == "regular")[:, None], chosen.size, axis=1)
    differences = np.zeros((len(p), 3, chosen.size))
    for k in range(chosen.size):
        for at, weight in STENCIL.items():
            moved = p.copy()
            moved[:, k] += at * STEP * span[k]
            batch = device.evaluate(chosen.geometry(moved, device.X), **TIGHT)
            differences[:, :, k] += weight * batch.joint_angles[:, -1] / STEP
            smooth[:, k] &= batch.pairs[:, -1] == here.pairs[:, -1]
            smooth[:, k] &= batch.event_count == here.event_count
    assert smooth.mean() > 0.5
    size = np.abs(exact[:, :3]).max(axis=(1, 2))[:, None]
    error = np.abs(exact[:, :3] - differences).max(axis=1) / size
    assert error[smooth].max() < 1e-6


def test_results_do_not_depend_on_threads(device: Model) -> None:
    chosen = parameter_set("L+R01", device.design)
    p = np.random.default_rng(2).uniform(chosen.lower, chosen.upper, (40, chosen.size))
    geometry = chosen.geometry(p, device.X)
    one, two = (device.evaluate(geometry, threads=threads, gradient=True) for threads in (1, 2))
    for name in ("q", "volume", "stretch", "gradient"):
        assert getattr(one, name).tobytes() == getattr(two, name).tobytes()


LAWS: list[dict[str, Any]] = [
    {"kind": "linear", "young_modulus": "0.4 MPa", "poisson_ratio": 0.45},
    {"kind": "neo-hookean", "shear_modulus": "0.1 MPa"},
    {"kind": "mooney-rivlin", "c10": "40 kPa", "c01": "10 kPa"},
    {"kind": "yeoh", "c1": "24 kPa", "c2": "3 kPa", "c3": "-0.1 kPa"},
    {"kind": "ogden", "mu": ["114 kPa", "-0.47 kPa"], "alpha": [3.08, 6.18]},
]


def random_device(random: np.random.Generator) -> dict[str, Any]:
    """A free or clamped rod with any section, material and load."""
    planar = bool(random.integers(2))
    wound = {"winding": "hoop"} if random.integers(2) else {}
    law: dict[str, Any] = LAWS[random.integers(len(LAWS))]
    sizes = {"wall": float(random.uniform(0.1, 1.1)), "stretch": float(random.uniform(0.9, 1.2))}
    floor = {"floor": float(random.uniform(0.1, 1.0))}
    layer = {"layer": {"thickness": "0.3 mm", "material": "fabric"}} if random.integers(2) else {}
    sections: list[dict[str, Any]] = [
        {"kind": "tube", **sizes, "winding": str(random.choice(["inside", "outside"]))},
        {"kind": "half-round", **sizes, **floor, **layer},
        {"kind": "box", "width": float(random.uniform(1.0, 4.0)), **sizes, **floor, **layer},
    ]
    modes = ["bend_y", "extend_x", "shear_z"]
    if not planar:
        modes += ["twist_x", "bend_z", "shear_y"]
    return {
        "name": "random",
        "planar": planar,
        "gravity": {"z": "-9.81 m/s^2"},
        "materials": {
            "soft": {**law, **wound, "density": "1 g/cm^3"},
            "fabric": {"kind": "linear", "young_modulus": "20 MPa"},
        },
        "bodies": {
            "rod": {
                "kind": "rod",
                "length": f"{random.uniform(4, 20)} cm",
                "radius": {
                    "base": f"{random.uniform(3, 12)} mm",
                    "tip": f"{random.uniform(3, 12)} mm",
                },
                "material": "soft",
                "section": sections[random.integers(3)],
                "strain": dict.fromkeys(modes, "nodal_linear"),
                "reference_strain": {"bend_y": f"{random.uniform(-5, 5)} 1/m"},
                "elements": int(random.integers(1, 6)),
                "gauss_points": 2,
            }
        },
        "actuators": {"air": {"kind": "pressure", "rod": "rod", "span": [0.1, 0.9]}},
        "wrenches": {
            "pull": {"body": "rod", "at": "tip", "force": {"x": f"{random.normal()} N"}},
        },
    }


def test_random_devices_end_in_a_status() -> None:
    random = np.random.default_rng(7)
    solved = refused = 0
    for _ in range(60):
        content = random_device(random)
        try:
            model = Model(parse(tomli_w.dumps(content)))
        except InputError as error:
            assert "bodies.rod.section cannot be made: " in str(error)
            refused += 1
            continue
        loads = random.uniform(-20e3, 150e3, 3)
        path = model.equilibrium(loads, max_iterations=300)
        assert set(path.status) <= set(MEANINGS)
        solved += bool(path.converged.all())
        assert np.isfinite(path.q[path.converged]).all()
        assert np.isfinite(path.volume[path.converged]).all()
    assert solved > 20
    assert refused >= 3
