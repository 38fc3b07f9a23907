"""Constants of hyperelastic laws, fitted to tensile tests."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import least_squares

from flexor.arrays import Array
from flexor.errors import InputError, unknown
from flexor.materials.laws import fibre_energy
from flexor.materials.material import Constant, Material
from flexor.materials.tensile import TensileTest

POINTS = 60  # of the mean curve
BLOCKS = 5  # of the cross-validation
CLOSE = 1.1  # a simpler law is preferred if its error is at most this times the smallest
RELATIVE, ABSOLUTE = 0.03, 0.01  # assumed scatter of a single specimen: of σ, and of the largest σ
TOE = 0.3  # strain to which the beginning of the curve is extrapolated to zero stress
COMPRESSED = 0.5  # stretch down to which a law must be stable


@dataclass(frozen=True)
class Curve:
    """The mean of tensile tests.

    Attributes
    ----------
    stretch, stress, scatter : (POINTS,) array
        λ without slack, nominal stress [Pa], and its standard deviation [Pa]: of the specimens, or
        assumed for one.
    slack
        Strain at which the specimens began to carry, which was removed.
    specimens
        Their number.
    """

    stretch: Array
    stress: Array
    scatter: Array
    slack: float
    specimens: int


@dataclass(frozen=True)
class Fit:
    """A law fitted to a curve.

    Attributes
    ----------
    law
        One of `LAWS`.
    material
        With the fitted constants.
    rms, largest
        Deviation of the stress from the mean curve, relative to it: root mean square, and largest,
        above a tenth of the strains.
    error
        Root mean square of the deviations over the scatter, each fifth of the strains predicted
        from the other four.
    stable
        Whether w'' is positive, free and wound, from a stretch of 0.5 to the end of the curve.
    """

    law: str
    material: Material
    rms: float
    largest: float
    error: float
    stable: bool


def mean_curve(tests: Sequence[TensileTest], strains: tuple[float, float] | None = None) -> Curve:
    """Average tests after removal of slack.

    Parameters
    ----------
    tests
        Specimens of one material.
    strains
        Smallest and largest strain; by default those that all specimens reach.

    Raises
    ------
    InputError
        If there are no tests, or they do not cover the strains.

    Notes
    -----
    Slack is removed as in the toe compensation of ASTM D638 (annex A1), with a parabola through the
    points up to 30 % of strain instead of a line, because elastomers soften from the start.
    """
    if not tests:
        raise InputError("there are no tensile tests to fit.")
    slack = [_slack(test) for test in tests]
    shifted = [test.stretch / (1.0 + e) for test, e in zip(tests, slack, strict=True)]
    low = max(1.0, *(stretch[0] for stretch in shifted))
    high = min(stretch[-1] for stretch in shifted)
    if strains is not None:
        low, high = max(low, 1.0 + strains[0]), min(high, 1.0 + strains[1])
    if not high - low > 1e-3:
        raise InputError(
            f"the tensile tests have no common strains within the range: they reach {low - 1:.3g} "
            f"to {high - 1:.3g}."
        )
    stretch = np.linspace(low, high, POINTS)
    stresses = np.array(
        [np.interp(stretch, x, test.stress) for x, test in zip(shifted, tests, strict=True)]
    )
    stress = stresses.mean(axis=0)
    floor = RELATIVE * np.abs(stress) + ABSOLUTE * float(np.max(stress))
    scatter = floor
    if len(tests) > 1:
        # Correlated along the curve: a smooth share of the stress, at least a third of the floor.
        share = float(np.sqrt(np.mean(np.var(stresses, axis=0, ddof=1) / floor**2)))
        scatter = floor * max(share, 1.0 / 3.0)
    return Curve(stretch, stress, scatter, float(np.mean(slack)), len(tests))


def _slack(test: TensileTest) -> float:
    start = test.stretch - 1.0 <= TOE
    if np.unique(test.stress[start]).size < 4:
        return 0.0
    # Strain as a polynomial of stress, at zero stress.
    at_zero = float(np.polynomial.polynomial.polyfit(test.stress[start], test.stretch[start], 2)[0])
    return min(max(at_zero - 1.0, 0.0), max(float(test.stretch[0]) - 1.0, 0.0))


def _linear(
    kind: str, names: Sequence[str]
) -> Callable[[Array, Array, Array], list[dict[str, Constant]]]:
    """Return the fit of a law that is linear in its constants."""

    def solve(stretch: Array, stress: Array, scatter: Array) -> list[dict[str, Constant]]:
        units = np.eye(len(names)).tolist()
        basis = np.stack([fibre_energy(kind, unit, stretch).first for unit in units], axis=1)
        found = np.linalg.lstsq(basis / scatter[:, None], stress / scatter, rcond=None)[0]
        return [dict(zip(names, map(float, found), strict=True))]

    return solve


def _ogden(
    *starts: tuple[float, ...],
) -> Callable[[Array, Array, Array], list[dict[str, Constant]]]:
    """Return the fit of Ogden's law: exponents by least squares, moduli eliminated."""

    def moduli(alpha: Array, stretch: Array, stress: Array, scatter: Array) -> tuple[Array, Array]:
        columns = [fibre_energy("ogden", (1.0, a), stretch).first for a in alpha.tolist()]
        basis = np.stack(columns, axis=1) / scatter[:, None]
        size = np.linalg.norm(basis, axis=0)
        mu = np.linalg.lstsq(basis / size, stress / scatter, rcond=1e-8)[0] / size
        return mu, basis @ mu - stress / scatter

    def solve(stretch: Array, stress: Array, scatter: Array) -> list[dict[str, Constant]]:
        given = (stretch, stress, scatter)
        found = []
        for start in starts:
            signs = np.sign(start)
            bounds = np.sort(np.stack([0.2 * signs, 12.0 * signs]), axis=0)
            best = least_squares(lambda alpha: moduli(alpha, *given)[1], start, bounds=bounds)
            mu, _ = moduli(best.x, *given)
            found.append((float(best.cost), best.x, mu))
        found.sort(key=lambda each: each[0])
        return [{"mu": tuple(mu.tolist()), "alpha": tuple(a.tolist())} for _, a, mu in found]

    return solve


@dataclass(frozen=True)
class _Law:
    kind: str
    size: int  # number of constants
    solve: Callable[[Array, Array, Array], list[dict[str, Constant]]]


LAWS: Mapping[str, _Law] = {
    "neo-hookean": _Law("neo-hookean", 1, _linear("neo-hookean", ["shear_modulus"])),
    "mooney-rivlin": _Law("mooney-rivlin", 2, _linear("mooney-rivlin", ["c10", "c01"])),
    "yeoh": _Law("yeoh", 3, _linear("yeoh", ["c1", "c2", "c3"])),
    "ogden-1": _Law("ogden", 2, _ogden((2.0,), (4.0,), (-2.0,))),
    "ogden-2": _Law("ogden", 4, _ogden((1.3, 5.0), (2.0, -2.0), (4.0, -4.0))),
}


def fit(curve: Curve, law: str, name: str = "material") -> Fit | None:
    """Fit the constants of a law to a curve by least squares, weighted by the scatter.

    Parameters
    ----------
    curve
        The mean of tensile tests.
    law
        One of `LAWS`.
    name
        Of the material.

    Returns
    -------
    Fit or None
        The stable minimum with the smallest misfit, or else the smallest; None if no material has a
        positive modulus at rest.
    """
    if law not in LAWS:
        raise unknown("law", law, LAWS)
    kind = LAWS[law].kind
    best: Fit | None = None
    for constants in LAWS[law].solve(curve.stretch, curve.stress, curve.scatter):
        try:
            material = Material(
                name,
                kind,
                constants,
                stretch_range=(float(curve.stretch[0]), float(curve.stretch[-1])),
            )
        except InputError:
            continue
        stretch, stress = curve.stretch[POINTS // 10 :], curve.stress[POINTS // 10 :]
        size = np.maximum(np.abs(stress), ABSOLUTE * np.max(np.abs(stress)))
        deviation = (material.nominal_stress(stretch) - stress) / size
        stable = is_stable(material, float(curve.stretch[-1]))
        if best is None or (stable and not best.stable):
            best = Fit(
                law,
                material,
                float(np.sqrt(np.mean(deviation**2))),
                float(np.max(np.abs(deviation))),
                _cross_validated(curve, law),
                stable,
            )
    return best


def is_stable(material: Material, end: float) -> bool:
    """Say whether the tangent modulus is positive, free and wound, from λ = 0.5 to `end`."""
    stretch = np.linspace(COMPRESSED, end, 400)
    return all(
        bool(np.all(fibre_energy(material.kind, material.numbers, stretch, wound).second > 0.0))
        for wound in (False, True)
    )


def _cross_validated(curve: Curve, law: str) -> float:
    """Return the rms of what a law predicts of each block from the others, over the scatter."""
    blocks = np.array_split(np.arange(curve.stretch.size), BLOCKS)
    total = 0.0
    for block in blocks:
        rest = np.setdiff1d(np.arange(curve.stretch.size), block)
        constants = LAWS[law].solve(curve.stretch[rest], curve.stress[rest], curve.scatter[rest])[0]
        try:
            material = Material("trial", LAWS[law].kind, constants)
        except InputError:
            return math.inf
        off = material.nominal_stress(curve.stretch[block]) - curve.stress[block]
        total += float(np.sum((off / curve.scatter[block]) ** 2))
    return math.sqrt(total / curve.stretch.size)


def fit_laws(curve: Curve, names: Sequence[str] = tuple(LAWS), name: str = "material") -> list[Fit]:
    """Fit laws, and put the one to use first.

    Parameters
    ----------
    curve
        The mean of tensile tests.
    names
        The laws, of `LAWS`.
    name
        Of the material.

    Returns
    -------
    list of Fit
        First the stable law with the fewest constants whose cross-validated error is within 10 %
        of the smallest of stable laws, or at most a third of the scatter; the others by that error.

    Raises
    ------
    InputError
        If no law fits with a positive modulus at rest.
    """
    fits = [found for law in names if (found := fit(curve, law, name)) is not None]
    if not fits:
        raise InputError("no law fits the tensile tests with a positive modulus at rest.")
    fits.sort(key=lambda found: (not found.stable, found.error))
    enough = max(CLOSE * fits[0].error, 1.0 / 3.0)
    simple = [found for found in fits if found.stable == fits[0].stable and found.error <= enough]
    chosen = min(simple, key=lambda found: (LAWS[found.law].size, found.error))
    return [chosen, *(found for found in fits if found is not chosen)]
