"""Closed form: a finger of hinges bent against their limits by a moment."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from flexor.model import Model

from .comparison import compare
from .drawing import SERIES, dots
from .report import Case
from .systems import build, link, si, vector

Array = NDArray[np.float64]
FAMILY = "Closed forms"
LENGTHS = (0.045, 0.025, 0.02)  # m
STIFFNESS = (0.04, 0.03, 0.02)  # N m/rad
RESTS = (0.1, 0.0, -0.05)  # rad
LOWER, UPPER = (-0.17, -0.09, -0.09), (1.2, 0.9, 1.57)  # rad
LIMIT, WIDTH = 5.0, 0.0175  # N m/rad, rad
MOMENTS = np.linspace(-0.1, 0.15, 51)  # N m


def _finger() -> Model:
    bodies = {}
    for i, length in enumerate(LENGTHS):
        joint = {
            "kind": "revolute",
            "axis": "y",
            "stiffness": si(STIFFNESS[i], "N*m/rad"),
            "rest": si(RESTS[i], "rad"),
            "lower": si(LOWER[i], "rad"),
            "upper": si(UPPER[i], "rad"),
            "limit_stiffness": si(LIMIT, "N*m/rad"),
            "limit_width": si(WIDTH, "rad"),
        }
        parent = {"parent": f"ph_{i}"} if i else {}
        bodies[f"ph_{i + 1}"] = link(length, 0.01, joint=joint, **parent)
    moment = vector((0.0, 1.0, 0.0), "N*m")
    tip = {"body": f"ph_{len(LENGTHS)}", "at": "tip", "moment": moment, "input": True}
    return build("finger", bodies, wrenches={"moment": tip})


def _angle(moment: float, i: int) -> float:
    """Solve K (θ - rest) + limit(θ) = M for one hinge."""
    k, rest = STIFFNESS[i], RESTS[i]
    free = rest + moment / k
    sign, bound = (1.0, UPPER[i]) if free > UPPER[i] else (-1.0, LOWER[i])
    if LOWER[i] <= free <= UPPER[i]:
        return free
    excess = sign * (moment - k * (bound - rest))  # what the limit and the hinge's own rise carry
    quadratic = WIDTH / LIMIT * (np.sqrt(k * k + 2.0 * LIMIT / WIDTH * excess) - k)
    linear = (excess + 0.5 * LIMIT * WIDTH) / (k + LIMIT)
    return float(bound + sign * (quadratic if quadratic <= WIDTH else linear))


def test_joint_limits(case: Case) -> None:
    """A finger at its joint limits.

    A moment at the tip of three hinged links acts equally on each hinge: K (θ − rest) + V′(θ) = M,
    with the documented energy V beyond a limit by s, k s³/6w up to the width w and k (s²/2 − w s/2
    + w²/6) beyond. The equation is quadratic within the width and linear elsewhere.
    """
    path = _finger().equilibrium(MOMENTS)
    wanted = np.array([[_angle(moment, i) for i in range(3)] for moment in MOMENTS])
    inside = np.abs(wanted - RESTS - MOMENTS[:, None] / STIFFNESS) < 1e-12
    beyond = (wanted > np.add(UPPER, WIDTH)) | (wanted < np.subtract(LOWER, WIDTH))
    regimes = {"between the limits": inside, "beyond the width": beyond}
    regimes["within the width"] = ~inside & ~beyond
    comparisons = [
        compare(f"{name}: angles [rad]", wanted[chosen], path.joint_angles[chosen], 1e-9)
        for name, chosen in regimes.items()
    ]
    heading = np.cumsum(wanted, axis=1)
    tip = np.stack([np.cos(heading) @ LENGTHS, -np.sin(heading) @ LENGTHS], axis=1)
    found = [path.frames(step)["ph_3"][-1, [0, 2], 3] for step in range(len(path))]
    energy = [
        sum(_energy(a, i) for i, a in enumerate(row)) - m * row.sum()
        for row, m in zip(wanted, MOMENTS, strict=True)
    ]
    comparisons += [
        compare("fingertip x, z [m]", tip, found, 1e-9),
        compare("potential [J]", energy, path.energy, 1e-9),
    ]
    case.check(
        comparisons,
        lambda figure: _draw(figure, wanted, path.joint_angles),
        "Joint angles over the moment: closed form (lines) and Flexor (dots).",
    )


def _energy(angle: float, i: int) -> float:
    s = max(angle - UPPER[i], LOWER[i] - angle, 0.0)
    beyond = LIMIT * (s * s / 2.0 - WIDTH * s / 2.0 + WIDTH**2 / 6.0)
    limit = LIMIT * s**3 / (6.0 * WIDTH) if s <= WIDTH else beyond
    return 0.5 * STIFFNESS[i] * (angle - RESTS[i]) ** 2 + limit


def _draw(figure: Figure, wanted: Array, found: Array) -> None:
    axes = figure.subplots()
    for i, name in enumerate(("first", "second", "third")):
        axes.plot(1e3 * MOMENTS, wanted[:, i], color=SERIES[i], label=f"{name} joint")
        dots(axes, 1e3 * MOMENTS[::2], found[::2, i])
    axes.set(xlabel="moment / N mm", ylabel="angle / rad")
    axes.legend()
