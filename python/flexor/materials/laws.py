"""Strain energies of fibres, with their first and second derivatives, from the engine.

=============  ================================================  ==============================
kind           energy w per reference volume                     source
=============  ================================================  ==============================
neo-hookean    μ/2 (I_1 - 3)                                     Rivlin (1948)
mooney-rivlin  c_10 (I_1 - 3) + c_01 (I_2 - 3)                   Mooney (1940), Rivlin (1948)
yeoh           c_1 (I_1 - 3) + c_2 (I_1 - 3)² + c_3 (I_1 - 3)³   Yeoh (1993)
ogden          Σ μ_i/α_i (λ_1^α_i + λ_2^α_i + λ_3^α_i - 3)       Ogden (1972)
linear         E/2 (λ - 1)², with Poisson's ratio ν              Hooke; compressible unless ν = ½
=============  ================================================  ==============================

All hyperelastic laws are incompressible and isotropic. A free fibre contracts across itself by λ^-½
in both directions (uniaxial tension). A **wound** one keeps its hoop stretch at 1, and its
thickness changes by 1/λ (pure shear); its small-strain modulus is 4/3 of that of a free one if
ν = ½. The nominal stress is w'(λ), the true stress λ w'(λ).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from flexor import _engine
from flexor.arrays import Array


class Energy(NamedTuple):
    """Energy per reference volume of a fibre as a function of its stretch λ.

    Attributes
    ----------
    value : array
        w [J/m³].
    first : array
        w'(λ), the nominal stress [Pa].
    second : array
        w''(λ), the tangent modulus [Pa].
    """

    value: Array
    first: Array
    second: Array


def fibre_energy(
    kind: str, constants: Sequence[float], stretch: ArrayLike, wound: bool = False
) -> Energy:
    """Return the energy of a fibre, free or wound.

    Parameters
    ----------
    kind
        The law, as in the table of this module.
    constants
        Its constants in the order of the formula (E, ν; μ_1, α_1, μ_2, α_2, ...) [Pa, -].
    stretch : array_like
        λ, of any shape.
    wound
        Whether the hoop stretch is kept at 1.

    Returns
    -------
    Energy
        Arrays of the shape of `stretch`; NaN at stretches that are not positive, unless the
        material is linear.
    """
    x = np.asarray(stretch, dtype=float)
    found = _engine.fibre_energy(engine_name(kind), list(constants), wound, x.ravel())
    return Energy(*(each.reshape(x.shape) for each in found))


def engine_name(kind: str) -> str:
    """Return the name of a law in descriptions for the engine."""
    return kind.replace("-", "_")
