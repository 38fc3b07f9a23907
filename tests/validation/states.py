"""Equilibria that no path ends at: Newton's method on Flexor's residual, and their stability.

`Model.equilibrium` follows stable equilibria only. Where a reference also knows unstable ones,
these functions find and judge them from residual and tangent alone.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from flexor.model import Model

Array = NDArray[np.float64]


def newton(model: Model, q: Array, load: Array, iterations: int = 50) -> Array:
    """Return the equilibrium that Newton's method with full steps reaches, stable or not."""
    engine, parameters = model.engine, model.parameters
    for _ in range(iterations):
        step = np.linalg.solve(
            engine.tangent(parameters, q, load), engine.residual(parameters, q, load)
        )
        q = q - step
        if np.max(np.abs(step)) < 1e-13 * (1.0 + np.max(np.abs(q))):
            return q
    return np.full_like(q, np.nan)


def stability(model: Model, q: Array, load: Array) -> str:
    """Judge an equilibrium by the curvature of the potential around it."""
    tangent = model.engine.tangent(model.parameters, q, load)
    try:
        np.linalg.cholesky(tangent)
    except np.linalg.LinAlgError:
        return "unstable"
    return "stable"
