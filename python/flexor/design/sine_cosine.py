"""Set Rsc: the surface is a constant plus a sine and a cosine wave (equation 11)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexor.model.geometry import FloatArray


@dataclass(frozen=True)
class SineCosine:
    """S(X) = R_0 + R_0/20 (sin(A pi X + phi_A) + cos(B pi X + phi_B)) (11).

    The parameters are [A, B, phi_A, phi_B] (frequencies in half waves per length, phases in rad).
    R_0, the base radius of the model's exosuit [m], is not a parameter (Table II).
    """

    radius_base: float

    def value(self, p: FloatArray, X: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return S and dS/dX [m], each (n, m)."""
        sine, cosine, amplitude = self._waves(p, X)
        radius = self.radius_base + amplitude * (np.sin(sine) + np.cos(cosine))
        slope = (amplitude * np.pi) * (p[:, 0:1] * np.cos(sine) - p[:, 1:2] * np.sin(cosine))
        return radius, slope

    def jacobian(self, p: FloatArray, X: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return dS/dp and d(dS/dX)/dp, each (n, m, 4)."""
        sine, cosine, amplitude = self._waves(p, X)
        A, B = p[:, 0:1], p[:, 1:2]
        sin_a, cos_a, sin_b, cos_b = np.sin(sine), np.cos(sine), np.sin(cosine), np.cos(cosine)
        radius = np.stack((np.pi * X * cos_a, -np.pi * X * sin_b, cos_a, -sin_b), axis=2)
        slope = np.stack(
            (
                cos_a - np.pi * X * A * sin_a,
                -sin_b - np.pi * X * B * cos_b,
                -A * sin_a,
                -B * cos_b,
            ),
            axis=2,
        )
        return amplitude * radius, (amplitude * np.pi) * slope

    def _waves(self, p: FloatArray, X: FloatArray) -> tuple[FloatArray, FloatArray, float]:
        sine = np.pi * p[:, 0:1] * X + p[:, 2:3]
        cosine = np.pi * p[:, 1:2] * X + p[:, 3:4]
        return sine, cosine, self.radius_base / 20.0
