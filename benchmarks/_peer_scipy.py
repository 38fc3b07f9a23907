"""SciPy's `fsolve` with finite differences on Flexor's residual: what the paper's toolbox does."""

from __future__ import annotations

import numpy as np
import scipy
from _contest import Contest
from _random_designs import random_designs
from numpy.typing import NDArray
from scipy.optimize import fsolve

import flexor

Array = NDArray[np.float64]


def contests(quick: bool) -> list[Contest]:
    """Equilibria of random designs of the finger."""
    model = flexor.load("finger", "calibrated")
    count, ours = (8, 100) if quick else (32, 400)
    geometry, many = random_designs(model, count, seed=4), random_designs(model, ours, seed=4)
    indices, values = model.geometry_slots(geometry)
    forces = model.evaluation_loads[:, 0]

    def design(row: Array) -> tuple[Array, bool]:
        parameters = model.parameters.copy()
        parameters[indices] = row
        q, good = np.zeros(model.dof), True
        # Coordinates scaled as in the engine: L κ, strains, angles.
        length = model.slot("exosuit.length", parameters)[0]
        scale = np.array([1.0 / length if "bend" in n else 1.0 for n in model.engine.coordinates])
        for force in forces[1:]:
            x, _, status, _ = fsolve(
                lambda x, u: model.engine.residual(parameters, scale * x, [u]) * scale,
                q / scale,
                args=(force,),
                full_output=True,
                xtol=1e-9,
            )
            q, good = scale * x, good and status == 1
        return q, good

    def theirs() -> list[tuple[Array, bool]]:
        return [design(row) for row in values]

    def deviation() -> tuple[float, str]:
        found = theirs()
        last, columns = model.evaluate(geometry, threads=1).q[:, -1], model.joint_columns
        gaps = [
            float(np.abs(q[columns] - p[columns]).max())
            for (q, _), p in zip(found, last, strict=True)
        ]
        solved = [gap for gap, (_, good) in zip(gaps, found, strict=True) if good]
        alike = [gap for gap in solved if gap < 1e-3]
        text = f"{len(solved)} of {count} designs solved at every force, "
        text += f"{len(alike)} on the same branch"
        return max(alike, default=float("nan")), text

    return [
        Contest(
            f"SciPy {scipy.__version__} fsolve",
            f"equilibria of random designs of finger and exosuit, {model.dof} DOF, contact, "
            "0 to 5 N in 1 N steps",
            "fsolve finds any root, stable or not, and where it fails it goes on to the next "
            "force; each of its residuals also pays for Flexor's tangent and a new workspace",
            theirs,
            lambda: model.evaluate(many, threads=1),
            (count, ours),
            deviation,
            1e-5,
            "joint angles at 5 N where it found the same branch",
        )
    ]
