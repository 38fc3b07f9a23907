"""Another library: rigid trees under gravity and springs, against Pinocchio."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import root

from flexor.model import Model

from .comparison import Comparison, compare
from .pinocchio_tree import PinocchioTree, PointSpring, RigidBody
from .report import Case
from .systems import build, link, si, vector

Array = NDArray[np.float64]
FAMILY = "Other libraries"
GRAVITY, DENSITY = (1.5, -2.0, -9.0), 1200.0  # m/s², kg/m³
TREE = (
    RigidBody("base", None, 0.12, (0.02, 0.015), (0.01, 0.02, 0.0), (0.2, -0.4, 0.1), "free"),
    RigidBody(
        *("upper", "base", 0.1, (0.015, 0.012), (0.0, 0.01, 0.0), (0.0, 0.5, 0.0)),
        *("revolute", (0.6, 0.0, 0.8)),
    ),
    RigidBody("elbow", "upper", 0.08, (0.012, 0.01), (0.0, 0.0, 0.0), (0.3, 0.0, 0.0), "universal"),
    RigidBody(
        *("slide", "base", 0.06, (0.01, 0.01), (0.0, -0.02, 0.01), (0.0, 0.0, -0.9)),
        *("prismatic", (0.48, 0.6, 0.64)),
    ),
    RigidBody("wrist", "slide", 0.07, (0.01, 0.004), (0.0, 0.0, 0.0), (0.0, 0.2, 0.4), "spherical"),
)
CHAIN = (
    RigidBody("a", None, 0.1, (0.02, 0.015), (0.0, 0.0, 0.1), (0.1, 0.3, 0.0), "revolute"),
    RigidBody(
        *("b", "a", 0.08, (0.015, 0.01), (0.0, 0.0, 0.0), (0.0, 0.0, 0.5)),
        *("revolute", (0.6, 0.0, 0.8)),
    ),
    RigidBody(
        *("c", "b", 0.05, (0.01, 0.01), (0.0, 0.01, 0.0), (0.0, 0.7, 0.0)),
        *("prismatic", (0.48, 0.6, 0.64)),
    ),
    RigidBody("d", "a", 0.09, (0.01, 0.005), (0.0, -0.01, 0.0), (0.4, 0.0, 0.0), "revolute"),
    RigidBody(
        *("e", "d", 0.05, (0.005, 0.004), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)),
        *("revolute", (0.0, 0.0, 1.0)),
    ),
)
SPRINGS = (
    PointSpring("elbow", (0.0, 0.01, 0.0), None, (0.1, 0.2, -0.1), 20.0, 0.05),
    PointSpring("wrist", (0.0, 0.0, 0.0), "elbow", (0.01, 0.0, 0.0), 15.0, 0.02),
    PointSpring("wrist", (0.0, 0.004, 0.0), None, (0.3, -0.2, 0.2), 25.0, 0.1, slack=True),
    PointSpring("base", (0.0, 0.0, 0.0), None, (0.1, 0.0, 0.0), 30.0, 0.5, slack=True),
)
# Of each joint's coordinates: N m/rad, or N/m of a translation.
STIFFNESS = {
    "free": [0.6, 0.6, 0.6, 60.0, 60.0, 60.0],
    "revolute": [0.3],
    "universal": [0.2, 0.2],
    "prismatic": [40.0],
    "spherical": [0.15, 0.15, 0.15],
}


def _joint(body: RigidBody, stiff: bool) -> dict[str, Any]:
    joint: dict[str, Any] = {"kind": body.kind}
    if body.kind in ("revolute", "prismatic"):
        joint["axis"] = list(body.axis)
    if stiff:
        joint["stiffness"] = si(
            STIFFNESS[body.kind][0], "N/m" if body.kind == "prismatic" else "N*m/rad"
        )
        if body.kind == "free":
            joint["linear_stiffness"] = si(STIFFNESS["free"][3], "N/m")
    return joint


def _model(bodies: Sequence[RigidBody], ends: Sequence[str], *, loose: bool) -> Model:
    """Build the tree, with six load inputs at each of the ends' tips."""
    tables = {}
    for body in bodies:
        fields: dict[str, Any] = {
            "density": si(DENSITY, "kg/m^3"),
            "placement": {
                **vector(body.place, "m"),
                "rotation": vector(body.turn, "rad"),
            },
            "joint": _joint(body, stiff=not loose),
        }
        if body.parent is not None:
            fields["parent"] = body.parent
        tables[body.name] = link(body.length, body.radii, **fields)
    wrenches = {}
    for end in ends:
        for i, axis in enumerate(np.eye(3)):
            at = {"body": end, "at": "tip", "input": True}
            wrenches[f"{end}_moment_{i}"] = {**at, "moment": vector(axis, "N*m")}
            wrenches[f"{end}_force_{i}"] = {**at, "force": vector(axis, "N")}
    springs = {} if loose else {f"spring_{i}": _spring(s) for i, s in enumerate(SPRINGS)}
    return build("tree", tables, planar=False, gravity=GRAVITY, wrenches=wrenches, springs=springs)


def _spring(spring: PointSpring) -> dict[str, Any]:
    second: dict[str, Any] = {"world": vector(spring.place, "m")}
    if spring.other is not None:
        second = {"body": spring.other, "at": "tip", "offset": vector(spring.place, "m")}
    return {
        "first": {"body": spring.body, "at": "tip", "offset": vector(spring.offset, "m")},
        "second": second,
        "stiffness": si(spring.stiffness, "N/m"),
        "rest_length": si(spring.rest, "m"),
        "slack": spring.slack,
    }


def test_rigid_tree(case: Case) -> None:
    """Kinematics and gravity of rigid trees.

    Two branched trees of frusta with oblique joints at twenty random states: one of revolute and
    prismatic joints, one of a free, revolute, universal, prismatic and spherical joint. Tips,
    Jacobians (from the residual under unit loads in Flexor), gravity torques, potential energy and
    the derivative of gravity torques (where the coordinates differ, by central differences) from
    Pinocchio.
    """
    random = np.random.default_rng(7)
    comparisons = []
    for label, bodies, ends in (("chain", CHAIN, ("c", "e")), ("tree", TREE, ("elbow", "wrist"))):
        model = _model(bodies, ends, loose=True)
        reference = PinocchioTree(bodies, GRAVITY, DENSITY)
        states = [random.uniform(-1.2, 1.2, model.dof) for _ in range(20)]
        comparisons += _compare(label, model, reference, states, ends)
    case.check(comparisons)


def _compare(
    label: str,
    model: Model,
    reference: PinocchioTree,
    states: Sequence[Array],
    ends: Sequence[str],
) -> list[Comparison]:
    engine, p = model.engine, model.parameters
    none = np.zeros(len(model.inputs))
    names = engine.frame_names()
    rows = [names.index(f"{name}.tip") for name in reference.joints]
    tips = [list(reference.tips(q).values()) for q in states]
    jacobians = [[reference.jacobian(q, end) for end in ends] for q in states]
    return [
        compare(f"{label}: tips", tips, [engine.frames(p, q)[rows] for q in states], 1e-12, 1.0),
        compare(
            f"{label}: Jacobians", jacobians, [_jacobians(model, q, ends) for q in states], 1e-12
        ),
        compare(
            f"{label}: gravity torques [N m, N]",
            [reference.gravity_torque(q) for q in states],
            [engine.residual(p, q, none) for q in states],
            1e-12,
        ),
        compare(
            f"{label}: potential energy of gravity [J]",
            [reference.gravity_energy(q) for q in states],
            [engine.energy(p, q, none) for q in states],
            1e-12,
        ),
        compare(
            f"{label}: derivative of gravity torques",
            [_tangent(reference, q) for q in states],
            [engine.tangent(p, q, none) for q in states],
            1e-12 if _is_chain(reference) else 1e-8,
        ),
    ]


def _jacobians(model: Model, q: Array, ends: Sequence[str]) -> Array:
    """Read the Jacobians off the residual: unit loads at a tip add minus its rows."""
    residual = model.engine.residual
    rest = residual(model.parameters, q, np.zeros(len(model.inputs)))
    rows = []
    for end in ends:
        for name in [f"{end}_{kind}_{i}" for kind in ("moment", "force") for i in range(3)]:
            load = np.array([float(name == known) for known in model.inputs])
            rows.append(rest - residual(model.parameters, q, load))
    return np.reshape(rows, (len(ends), 6, model.dof))


def _is_chain(reference: PinocchioTree) -> bool:
    return set(reference.kinds) <= {"revolute", "prismatic"}


def _tangent(reference: PinocchioTree, q: Array) -> Array:
    """Pinocchio's own derivative where its coordinates are Flexor's, else central differences."""
    if _is_chain(reference):
        return reference.gravity_tangent(q)
    h = 1e-5
    columns = [
        (reference.gravity_torque(q + h * e) - reference.gravity_torque(q - h * e)) / (2.0 * h)
        for e in np.eye(reference.size)
    ]
    return np.stack(columns, axis=1)


def test_rigid_tree_equilibrium(case: Case) -> None:
    """Equilibrium of a rigid tree under gravity and springs.

    The second tree with stiff joints, two springs, a taut and a slack strap. Reference: the root of
    gravity torques and spring forces, assembled with Pinocchio's kinematics, found by
    `scipy.optimize.root` from the unloaded state.
    """
    model = _model(TREE, (), loose=False)
    reference = PinocchioTree(TREE, GRAVITY, DENSITY)
    stiffness = np.concatenate([STIFFNESS[body.kind] for body in TREE])

    def residual(q: Array) -> Array:
        springs = reference.spring_torque(q, SPRINGS)
        return np.asarray(stiffness * q + reference.gravity_torque(q) + springs)

    path = model.equilibrium()
    q = path.q[0]
    solved = root(residual, np.zeros(reference.size), tol=1e-14)
    tips = np.stack(list(reference.tips(solved.x).values()))[:, :3, 3]
    found = np.stack([path.frames(0)[name][-1, :3, 3] for name in reference.joints])
    weights = np.abs(reference.gravity_torque(solved.x))
    case.check(
        (
            compare("coordinates [rad, m]", solved.x, q, 1e-8, 1.0),
            compare("tips [m]", tips, found, 1e-9, 1.0),
            compare(
                "Pinocchio's residual at Flexor's equilibrium",
                0.0 * q,
                residual(q),
                1e-8,
                float(weights.max()),
            ),
        )
    )
