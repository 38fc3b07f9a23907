"""Closed forms: two spheres, and a sphere and a round cone, pressed together by a spring."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from flexor.model import Model

from .comparison import compare
from .report import Case
from .systems import build, link, si, vector

Array = NDArray[np.float64]
FAMILY = "Closed forms"
Fields = dict[str, Any]
RADII = (0.012, 0.008)  # m
CONTACT, SPRING, REST = 1000.0, 50.0, 0.01  # N/m, N/m, m
PUSHES = np.array([0.0, 0.2, 0.4, 0.8, 1.6, 3.2])  # N
# From the first sphere to where the spring is held, in space and in the plane.
LINES = {"space": (0.6, 0.48, 0.64), "plane": (0.8, 0.0, 0.6)}
START = 0.03  # m between the centres without load
CONE, CONE_LENGTH = (0.016, 0.01), 0.1  # m, m
SLIDER = {"body": "slider", "at": "base"}


def _pressed(
    where: str, name: str, still: Fields, spheres: Fields, contact: Fields
) -> tuple[Model, Array]:
    """Build a fixed body, and a sphere on a slide that a spring and a push press against it."""
    line = np.array(LINES[where])
    bodies = {
        "still": still,
        "slider": link(
            0.01,
            RADII[1],
            placement={axis: si(START * v, "m") for axis, v in zip("xyz", line, strict=True)},
            joint={"kind": "prismatic", "axis": line.tolist()},
        ),
    }
    model = build(
        name,
        bodies,
        planar=where == "plane",
        spheres=spheres,
        contacts={"touch": {**contact, "stiffness": si(CONTACT, "N/m")}},
        springs={
            "spring": {
                "first": SLIDER,
                # Beyond the origin, so that it pulls all along the slide.
                "second": {"world": vector(-0.02 * line, "m")},
                "stiffness": si(SPRING, "N/m"),
                "rest_length": si(REST, "m"),
            }
        },
        wrenches={"push": {**SLIDER, "force": vector(-line, "N"), "input": True}},
    )
    return model, line


def _spheres(where: str) -> tuple[Model, Array]:
    """Build two spheres."""
    spheres = {body: {"points": [{"body": body, "at": "base"}]} for body in ("still", "slider")}
    contact = {"first": "still", "second": "slider"}
    return _pressed(where, "spheres", link(0.01, RADII[0]), spheres, contact)


def _cone(where: str) -> tuple[Model, Array]:
    """Build a sphere, and a round cone whose axis, the x axis, the slide meets in its middle."""
    still = link(CONE_LENGTH, CONE, placement={"x": si(-0.5 * CONE_LENGTH, "m")})
    spheres = {"ball": {"points": [SLIDER]}, "cone": {"bodies": ["still"]}}
    contact = {"first": "ball", "second": "cone", "shape": "round-cones"}
    return _pressed(where, "cone", still, spheres, contact)


def test_pressed_spheres(case: Case) -> None:
    """Two spheres pressed by a spring.

    A sphere on a prismatic joint is pulled against a fixed one by a spring and pushed by a force.
    The contact law (8) is linear in the overlap, so the distance x solves k (R₁ + R₂ − x) = k_s (x
    + a − ℓ₀) + P. In space and in the plane, along oblique lines.
    """
    comparisons = []
    for where in LINES:
        model, line = _spheres(where)
        path = model.equilibrium(PUSHES)
        # k (R - x) = k_s (x + 2 cm - rest) + push, while it gives an overlap.
        reach = sum(RADII)
        x = (CONTACT * reach - SPRING * (0.02 - REST) - PUSHES) / (CONTACT + SPRING)
        overlap = reach - x
        touches = [path.contact_forces(step) for step in range(len(path))]
        found = [START + q[0] for q in path.q]
        stored = 0.5 * SPRING * (x + 0.02 - REST) ** 2 + 0.5 * CONTACT * overlap**2 + PUSHES * x
        forces = np.stack([touch.force[0] for touch in touches])
        comparisons += [
            compare(f"{where}: distance [m]", x, found, 1e-10),
            compare(f"{where}: overlap [m]", overlap, [t.depth[0] for t in touches], 1e-9),
            compare(
                f"{where}: force on the first [N]", -CONTACT * overlap[:, None] * line, forces, 1e-9
            ),
            compare(f"{where}: potential [J]", stored, path.energy, 1e-10),
        ]
    case.check(comparisons)


def test_pressed_cone(case: Case) -> None:
    """A sphere pressed against a round cone by a spring.

    A sphere on a prismatic joint is pulled and pushed against the side of a fixed round cone. In
    the plane through its axis the side of a cone is a straight line, so the overlap is linear in
    the distance and k c (R + r − c x) = k_s (x + a − ℓ₀) + P, c being the cosine of the angle
    between the joint's axis and the side's normal. In space and in the plane, along oblique lines.
    """
    comparisons = []
    taper = CONE[1] - CONE[0]
    sine = -taper / CONE_LENGTH
    cosine = np.sqrt(1.0 - sine**2)
    for where in LINES:
        model, line = _cone(where)
        path = model.equilibrium(PUSHES)
        # d = R + r(middle) - c x: seen from outside, the cone's side is a plane.
        across = float(np.hypot(line[1], line[2]))
        normal = np.array([sine, cosine * line[1] / across, cosine * line[2] / across])
        reach, c = RADII[1] + 0.5 * sum(CONE), float(normal @ line)
        x = (CONTACT * c * reach - SPRING * (0.02 - REST) - PUSHES) / (CONTACT * c**2 + SPRING)
        overlap = reach - c * x
        touches = [path.contact_forces(step) for step in range(len(path))]
        forces = np.stack([touch.force[0] for touch in touches])
        points = np.stack([touch.point[0] for touch in touches])
        middle = x[:, None] * line - (RADII[1] - 0.5 * overlap)[:, None] * normal
        comparisons += [
            compare(f"{where}: distance [m]", x, [START + q[0] for q in path.q], 1e-10),
            compare(f"{where}: overlap [m]", overlap, [t.depth[0] for t in touches], 1e-9),
            compare(
                f"{where}: force on the sphere [N]",
                CONTACT * overlap[:, None] * normal,
                forces,
                1e-9,
            ),
            compare(f"{where}: where it acts [m]", middle, points, 1e-9),
        ]
    case.check(comparisons)
