"""Another library: geometric variable strain on a shared configuration, against soromox."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import ExitStack
from typing import Any
from unittest.mock import patch

import numpy as np
from numpy.typing import NDArray

from flexor.model import Model

from .comparison import compare
from .report import Case, load
from .systems import build, rod, si, vector

Array = NDArray[np.float64]
FAMILY = "Other libraries"
GRAVITY, YOUNG, DENSITY = (1.0, -2.0, -9.0), 2e5, 1000.0
MODES = ("twist_x", "bend_y", "bend_z", "extend_x", "shear_y", "shear_z")
SOROMOX_MODES = ("kappa_x", "kappa_y", "kappa_z", "sigma_x", "sigma_y", "sigma_z")
# Length, radii of base and tip [m], basis, degree, Gauss points, which of the modes.
RODS: tuple[tuple[float, tuple[float, float], str, int, int, tuple[int, ...]], ...] = (
    (0.25, (0.012, 0.006), "legendre", 3, 8, (0, 1, 2, 3, 4, 5)),
    (0.15, (0.006, 0.005), "monomial", 2, 6, (1, 2, 3)),
    (0.1, (0.005, 0.005), "chebyshev", 4, 7, (0, 1, 2)),
)
# Of each rod's tendon: (y, z) at base and tip [m].
PATHS = (
    ((0.004, 0.002), (-0.003, 0.003)),
    ((0.003, -0.001), (0.003, 0.002)),
    ((0.0, 0.002), (0.001, -0.002)),
)


def _ours(gravity: tuple[float, float, float]) -> Model:
    bodies: dict[str, Any] = {}
    for i, (length, radii, basis, order, points, modes) in enumerate(RODS):
        strain = {MODES[m]: {"basis": basis, "order": order} for m in modes}
        parent: dict[str, Any] = {"parent": f"rod_{i}"} if i else {}
        bodies[f"rod_{i + 1}"] = rod(
            *(length, radii, strain),
            young_modulus=YOUNG,
            density=si(DENSITY, "kg/m^3"),
            gauss_points=points,
            **parent,
        )
    tendons = {}
    for i, ((y0, z0), (y1, z1)) in enumerate(PATHS):
        path = {"y": [si(y0, "m"), si(y1, "m")], "z": [si(z0, "m"), si(z1, "m")]}
        tendons[f"tendon_{i + 1}"] = {"kind": "cable", "rod": f"rod_{i + 1}", "path": path}
    wrenches = {}
    for i, axis in enumerate(np.eye(3)):
        at = {"body": f"rod_{len(RODS)}", "at": "tip", "input": True}
        wrenches[f"moment_{i}"] = {**at, "moment": vector(axis, "N*m")}
        wrenches[f"force_{i}"] = {**at, "force": vector(axis, "N")}
    return build(
        "rods", bodies, planar=False, gravity=gravity, actuators=tendons, wrenches=wrenches
    )


def _points(N_GQ: int, a: Any = 0.0, b: Any = 1.0) -> tuple[Any, Any, int]:
    """Gauss points on [a, b] between its ends, as soromox lists them."""
    numpy = load("soromox", "jax.numpy")
    x, w = np.polynomial.legendre.leggauss(N_GQ)
    points = np.concatenate([[-1.0], x, [1.0]])
    weights = np.concatenate([[0.0], w, [0.0]])
    return a + (b - a) * numpy.asarray(0.5 + 0.5 * points), (b - a) * weights / 2.0, N_GQ + 2


def _theirs() -> Any:
    load("soromox", "soromox")
    load("soromox", "jax").config.update("jax_enable_x64", True)
    # soromox (0.5) stops its search for Gauss points at single precision, an error of 1e-8 that
    # would hide smaller ones; NumPy's points take their place.
    places = [load("soromox", f"soromox.systems.gvs.{part}") for part in ("core", "construction")]
    with ExitStack() as patched:
        for place in places:
            patched.enter_context(patch.object(place, "gauss_quadrature", _points))
        return _robot()


def _robot() -> Any:
    gvs, parts = (
        load("soromox", "soromox.systems.gvs"),
        load("soromox", "soromox.systems.components"),
    )
    threads = load("soromox", "soromox.actuation.threadlike")
    segments = []
    for length, radii, basis, order, points, modes in RODS:
        segments.append(
            gvs.GVSSegment(
                link=parts.LinkSpec.circular(
                    length=length,
                    radius=parts.LinearProfile(*radii),
                    density=DENSITY,
                    reference_strain=[0.0, 0.0, 0.0, 1.0, 0.0, 0.0],
                    young_modulus=YOUNG,
                    shear_modulus=YOUNG / 3.0,
                ),
                joint=parts.JointSpec(type="fixed"),
                basis=gvs.StrainBasisSpec(basis, tuple(SOROMOX_MODES[m] for m in modes), order),
                num_gauss_points=points,
            )
        )
    # soromox counts s through all rods, Flexor X along each.
    starts = np.concatenate([[0.0], np.cumsum([length for length, *_ in RODS])])[:-1]
    base, tip = (np.array([(0.0, *path[end]) for path in PATHS]) for end in (0, 1))
    slope = (tip - base) / np.array([[length] for length, *_ in RODS])
    numbers = tuple(range(len(RODS)))
    routing = threads.ThreadlikeRouting.linear(
        intercept=base - slope * starts[:, None],
        slope=slope,
        start_segment_index=numbers,
        end_segment_index=numbers,
    )
    return gvs.GVS.from_segments(
        segments,
        gravity=np.array(GRAVITY),
        base_pose=np.array([0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0]),
        scale_rotational_basis_by_length=True,
        actuators=threads.ThreadlikeActuator.tendons(routing),
    )


def test_variable_strain(case: Case) -> None:
    """Geometric variable strain.

    Three tapered rods in a row with Legendre, monomial and Chebyshev strains in six, three and
    three modes, a tendon in each, under gravity, at five random states: every term of the statics
    from soromox's GVS, which has the same Gauss points and 4th-order Magnus steps. (Its Gauss
    points, accurate to 10⁻⁸ only, are replaced by NumPy's.)
    """
    robot, model, weightless = _theirs(), _ours(GRAVITY), _ours((0.0, 0.0, 0.0))
    engine, p = model.engine, model.parameters
    random = np.random.default_rng(5)
    states = random.uniform(-1.0, 1.0, (5, model.dof))
    linear = [any(mode in name for mode in MODES[3:]) for name in engine.coordinates]
    states[:, linear] *= 0.2
    none, units = np.zeros(len(model.inputs)), np.eye(len(model.inputs))
    names = [f"rod_{i + 1}" for i in range(len(RODS))]
    last = [f"{name}[{model.file.rod(name).sample_count - 1}]" for name in names]
    tips = [engine.frame_names().index(name) for name in last]
    # The residual is K q - B u - F: what one unit of each load adds to it, per state.
    rest = np.array([engine.residual(p, q, none) for q in states])
    loads = np.array(
        [
            [rest_q - engine.residual(p, q, u) for u in units]
            for q, rest_q in zip(states, rest, strict=True)
        ]
    )
    rows = [f"{kind}_{i}" for kind in ("moment", "force") for i in range(3)]
    tendons = range(len(PATHS))
    lengths = [
        [engine.energy(p, q, units[i]) - engine.energy(p, q, none) for i in tendons] for q in states
    ]
    stiffness = np.asarray(robot.stiffness_matrix())

    def theirs(term: Callable[[Array], Any]) -> Array:
        return np.stack([np.asarray(term(q)) for q in states])

    poses = [engine.frames(p, q)[tips] for q in states]
    jacobians = loads[:, [model.inputs.index(row) for row in rows]]
    ours_stiffness = weightless.engine.tangent(weightless.parameters, np.zeros(model.dof), none)
    thread = robot.actuators[0]
    case.check(
        (
            compare(
                "frames at the rods' tips", theirs(robot.forward_kinematics_tips), poses, 1e-12, 1.0
            ),
            compare(
                "Jacobian of the last tip", theirs(robot.jacobian_tips)[:, -1], jacobians, 1e-12
            ),
            compare("stiffness matrix K", stiffness, ours_stiffness, 1e-12),
            compare(
                "actuation matrix B(q)",
                theirs(robot.actuation_matrix),
                loads[:, tendons].transpose(0, 2, 1),
                1e-12,
            ),
            compare(
                "lengths of the tendons [m]",
                theirs(lambda q: thread.path_lengths(robot, q)),
                lengths,
                1e-12,
            ),
            compare(
                "generalized gravity",
                theirs(robot.gravitational_force),
                rest - states @ stiffness,
                1e-11,
            ),
        )
    )
