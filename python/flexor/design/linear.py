"""Set R01: the surface tapers linearly from base to tip (equation 10)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexor.model.geometry import FloatArray


@dataclass(frozen=True)
class Linear:
    """S(X) = R_0 + X (R_1 - R_0), parameters [R_0, R_1] in m (10).

    No minimum radius is applied here: the paper searches R_0 and R_1 down to 0.4 cm (Fig. 4, and
    "not at the lower bounds of the radii (0.4 cm)"), under the 0.5 cm it states for surfaces in
    general. A straight surface is nowhere thinner than its ends, so the bounds on the two radii
    already are its minimum; a clamp would flatten the strip 0.4-0.5 cm of that search.
    """

    def value(self, p: FloatArray, X: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return S and dS/dX [m], each (n, m)."""
        base, taper = p[:, :1], p[:, 1:] - p[:, :1]
        return base + X * taper, np.repeat(taper, X.size, axis=1)

    def jacobian(self, p: FloatArray, X: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return dS/dp and d(dS/dX)/dp, each (n, m, 2)."""
        shape = (p.shape[0], X.size, 2)
        radius = np.stack((1.0 - X, X), axis=1)
        return (
            np.broadcast_to(radius, shape).copy(),
            np.broadcast_to(np.array([-1.0, 1.0]), shape).copy(),
        )
