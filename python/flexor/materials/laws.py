"""Strain energies of fibres and sheets, with their first and second derivatives.

All hyperelastic laws are incompressible and isotropic, and a sum of powers of Ogden's invariants

    I(α) = λ_1^α + λ_2^α + λ_3^α - 3,        w = Σ_i k_i1 I(α_i) + k_i2 I(α_i)² + k_i3 I(α_i)³

per reference volume, with λ_1 λ_2 λ_3 = 1: the invariants I_1 - 3 and I_2 - 3 are I(2) and I(-2).
A law is therefore an array of **terms** (n, 4), one row α, k_1, k_2, k_3 for each i:

=============  ================================================  ==============================
kind           energy w                                          source
=============  ================================================  ==============================
neo-hookean    μ/2 (I_1 - 3)                                     Rivlin (1948)
mooney-rivlin  c_10 (I_1 - 3) + c_01 (I_2 - 3)                   Mooney (1940), Rivlin (1948)
yeoh           c_1 (I_1 - 3) + c_2 (I_1 - 3)² + c_3 (I_1 - 3)³   Yeoh (1993)
ogden          Σ μ_i/α_i I(α_i)                                  Ogden (1972)
linear         E/2 (λ - 1)², with Poisson's ratio ν              Hooke; compressible unless ν = ½
=============  ================================================  ==============================

A free fibre contracts across itself by λ^-½ in both directions (uniaxial tension). A **wound** one
keeps its hoop stretch at 1, and its thickness changes by 1/λ (pure shear); its small-strain modulus
is 4/3 of that of a free one if ν = ½. The nominal stress is w'(λ), the true stress λ w'(λ).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

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


class SheetEnergy(NamedTuple):
    """Energy per reference volume of a sheet as a function of two stretches.

    Attributes
    ----------
    value : array
        w [J/m³].
    axial, hoop : array
        ∂w/∂λ and ∂w/∂h [Pa].
    axial_axial, axial_hoop, hoop_hoop : array
        Second derivatives [Pa].
    """

    value: Array
    axial: Array
    hoop: Array
    axial_axial: Array
    axial_hoop: Array
    hoop_hoop: Array


def uniaxial(terms: Array, stretch: ArrayLike) -> Energy:
    """Return the energy of a free incompressible fibre: stretches λ, λ^-½, λ^-½.

    Parameters
    ----------
    terms : (n, 4) array
        The law [-, Pa, Pa, Pa]; see the module.
    stretch : array_like
        λ > 0, of any shape.

    Returns
    -------
    Energy
        Arrays of the shape of `stretch`.
    """
    return _fibre(terms, stretch, 0.5)


def wound(terms: Array, stretch: ArrayLike) -> Energy:
    """Return the energy of an incompressible fibre whose hoop stretch is 1: stretches λ, 1, 1/λ.

    Parameters
    ----------
    terms : (n, 4) array
        The law [-, Pa, Pa, Pa]; see the module.
    stretch : array_like
        λ > 0, of any shape.

    Returns
    -------
    Energy
        Arrays of the shape of `stretch`.
    """
    return _fibre(terms, stretch, 1.0)


def biaxial(terms: Array, stretch: ArrayLike, hoop: ArrayLike) -> SheetEnergy:
    """Return the energy of an incompressible sheet: stretches λ, h, 1/(λ h).

    Parameters
    ----------
    terms : (n, 4) array
        The law [-, Pa, Pa, Pa]; see the module.
    stretch, hoop : array_like
        λ > 0 and h > 0, of shapes that broadcast.

    Returns
    -------
    SheetEnergy
        Arrays of the common shape.
    """
    a, h = np.broadcast_arrays(np.asarray(stretch, dtype=float), np.asarray(hoop, dtype=float))
    log_a, log_h = np.log(a), np.log(h)
    total = np.zeros((6, *a.shape))
    for alpha, *k in terms:
        along, around = np.exp(alpha * log_a), np.exp(alpha * log_h)
        through = np.exp(-alpha * (log_a + log_h))
        value = np.expm1(alpha * log_a) + np.expm1(alpha * log_h)
        value += np.expm1(-alpha * (log_a + log_h))
        by_a, by_h = alpha * (along - through) / a, alpha * (around - through) / h
        by_aa = alpha * ((alpha - 1.0) * along + (alpha + 1.0) * through) / a**2
        by_hh = alpha * ((alpha - 1.0) * around + (alpha + 1.0) * through) / h**2
        by_ah = alpha**2 * through / (a * h)
        energy, slope, curvature = _polynomial(k, value)
        total[0] += energy
        total[1] += slope * by_a
        total[2] += slope * by_h
        total[3] += slope * by_aa + curvature * by_a**2
        total[4] += slope * by_ah + curvature * by_a * by_h
        total[5] += slope * by_hh + curvature * by_h**2
    return SheetEnergy(*total)


def linear(modulus: float, stretch: ArrayLike) -> Energy:
    """Return the energy w = E/2 (λ - 1)² of a linear fibre.

    Parameters
    ----------
    modulus
        E, or E/(1 - ν²) of a wound fibre [Pa].
    stretch : array_like
        λ, of any shape.

    Returns
    -------
    Energy
        Arrays of the shape of `stretch`.
    """
    strain = np.asarray(stretch, dtype=float) - 1.0
    stress = modulus * strain
    return Energy(0.5 * stress * strain, stress, np.full(strain.shape, float(modulus)))


def linear_sheet(
    modulus: float, poisson_ratio: float, stretch: ArrayLike, hoop: ArrayLike
) -> SheetEnergy:
    """Return the energy of a linear sheet in plane stress, w = E/(2(1 - ν²)) (e² + f² + 2ν e f).

    Parameters
    ----------
    modulus, poisson_ratio
        E [Pa] and ν.
    stretch, hoop : array_like
        1 + e and 1 + f, of shapes that broadcast.

    Returns
    -------
    SheetEnergy
        Arrays of the common shape.
    """
    e, f = np.broadcast_arrays(
        np.asarray(stretch, dtype=float) - 1.0, np.asarray(hoop, dtype=float) - 1.0
    )
    plane = modulus / (1.0 - poisson_ratio**2)
    axial, around = plane * (e + poisson_ratio * f), plane * (f + poisson_ratio * e)
    same = np.full(e.shape, plane)
    return SheetEnergy(
        0.5 * (axial * e + around * f), axial, around, same, poisson_ratio * same, same.copy()
    )


def _fibre(terms: Array, stretch: ArrayLike, contraction: float) -> Energy:
    """Return the energy of a fibre that contracts to λ^-contraction where it is free to."""
    x = np.asarray(stretch, dtype=float)
    log = np.log(x)
    total = np.zeros((3, *x.shape))
    for alpha, *k in terms:
        along, across = np.exp(alpha * log), np.exp(-contraction * alpha * log)
        value = np.expm1(alpha * log) + np.expm1(-contraction * alpha * log) / contraction
        first = alpha * (along - across) / x
        second = alpha * ((alpha - 1.0) * along + (contraction * alpha + 1.0) * across) / x**2
        energy, slope, curvature = _polynomial(k, value)
        total += np.stack([energy, slope * first, slope * second + curvature * first**2])
    return Energy(*total)


def _polynomial(k: list[float], value: Array) -> tuple[Array, Array, Array]:
    """Return k_1 v + k_2 v² + k_3 v³ and its first two derivatives."""
    k_1, k_2, k_3 = k
    return (
        value * (k_1 + value * (k_2 + value * k_3)),
        k_1 + value * (2.0 * k_2 + 3.0 * k_3 * value),
        2.0 * k_2 + 6.0 * k_3 * value,
    )
