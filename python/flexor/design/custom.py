"""A user's own surface as a parameter set: one function."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from flexor.design.geometry import FloatArray
from flexor.design.parameter_set import ParameterSet
from flexor.design.profile import Clamped, Profile
from flexor.design.space import PAPER, Space
from flexor.errors import InputError

# Fourth-order central differences: with this step, as a fraction of the range of a variable, the
# error of truncation and that of rounding are both about 1e-12 of a smooth surface.
STEP = 1e-3
_OFFSETS = np.array([-2.0, -1.0, 1.0, 2.0])
_WEIGHTS = np.array([1.0, -8.0, 8.0, -1.0]) / 12.0

ProfileResult = FloatArray | tuple[FloatArray, FloatArray]
ProfileFunction = Callable[[FloatArray, FloatArray], ProfileResult]


@dataclass(frozen=True)
class FunctionProfile:
    """A `Profile` from a function of one design.

    What the functions leave out is found by fourth-order central differences of step ``STEP``
    (of X, and of each parameter's range). Nothing is evaluated outside X in [0, 1].

    Attributes
    ----------
    function : callable
        ``function(p (k,), X (m,))`` -> S (m,) [m], or the pair S, dS/dX.
    derivative : callable or None
        The same for the derivative: dS/dp (m, k), or the pair dS/dp, d(dS/dX)/dp.
    span : (k,) array
        Range of each parameter, the scale of its differences.
    """

    function: ProfileFunction
    derivative: ProfileFunction | None
    span: FloatArray

    def value(self, p: FloatArray, X: FloatArray) -> tuple[FloatArray, FloatArray]:
        """S and dS/dX [m], each (n, m)."""
        return self._batch(lambda design: self._with_slope(self.function, design, X, (X.size,)), p)

    def jacobian(self, p: FloatArray, X: FloatArray) -> tuple[FloatArray, FloatArray]:
        """dS/dp and d(dS/dX)/dp, each (n, m, k)."""
        given = self.derivative
        if given is not None:
            shape = (X.size, p.shape[1])
            return self._batch(lambda design: self._with_slope(given, design, X, shape), p)
        return self._batch(lambda design: self._differences(design, X), p)

    def _batch(
        self, one: Callable[[FloatArray], tuple[FloatArray, FloatArray]], p: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        pairs = [one(design) for design in p]
        return np.stack([pair[0] for pair in pairs]), np.stack([pair[1] for pair in pairs])

    def _with_slope(
        self, function: ProfileFunction, design: FloatArray, X: FloatArray, shape: tuple[int, ...]
    ) -> tuple[FloatArray, FloatArray]:
        """Evaluate a function and, if it gives no slope, difference it in X."""
        found = function(design, X)
        if isinstance(found, tuple):
            return _shaped(found[0], shape), _shaped(found[1], shape)
        radius = _shaped(found, shape)
        # The stencil slides inwards at the ends, so its weights depend on the point.
        centre = np.clip(X, 2 * STEP, 1 - 2 * STEP)
        nodes = STEP * np.arange(-2.0, 3.0)
        points = centre[:, None] + nodes
        around = function(design, points.ravel())
        if isinstance(around, tuple):
            raise InputError("the surface function gave a slope at some points and not at others.")
        values = _shaped(around, (points.size, *shape[1:])).reshape(*points.shape, *shape[1:])
        weights = _slope_weights((X - centre) / STEP) / STEP
        slope = np.zeros(shape)
        for node in range(nodes.size):
            weight = weights[:, node].reshape(-1, *(1,) * (len(shape) - 1))
            slope += weight * values[:, node]
        return radius, slope

    def _differences(self, design: FloatArray, X: FloatArray) -> tuple[FloatArray, FloatArray]:
        radius = np.zeros((X.size, design.size))
        slope = np.zeros_like(radius)
        for i, span in enumerate(self.span):
            for offset, weight in zip(_OFFSETS, _WEIGHTS, strict=True):
                moved = design.copy()
                moved[i] += offset * STEP * span
                value = self._with_slope(self.function, moved, X, (X.size,))
                radius[:, i] += weight / (STEP * span) * value[0]
                slope[:, i] += weight / (STEP * span) * value[1]
        return radius, slope


def _slope_weights(t: FloatArray) -> FloatArray:
    """Weights (m, 5) of the derivative at t of the quartic through the nodes -2 ... 2."""
    nodes = np.arange(-2.0, 3.0)
    weights = np.zeros((t.size, nodes.size))
    for j, node in enumerate(nodes):
        others = np.delete(nodes, j)
        polynomial = np.poly(others) / np.prod(node - others)
        weights[:, j] = np.polyval(np.polyder(polynomial), t)
    return weights


def _shaped(values: FloatArray, shape: tuple[int, ...]) -> FloatArray:
    array = np.asarray(values, dtype=np.float64)
    if array.shape != shape:
        raise InputError(
            f"a surface function must give an array of shape {shape} here, "
            f"it gave one of shape {array.shape}."
        )
    return array


def custom(
    name: str,
    labels: Sequence[str],
    lower: ArrayLike,
    upper: ArrayLike,
    start: ArrayLike,
    profile: ProfileFunction,
    jacobian: ProfileFunction | None = None,
    *,
    units: Sequence[str] | None = None,
    minimum_radius: float | None = None,
    rod: Space = PAPER,
) -> ParameterSet:
    """Make a parameter set from one function that describes the surface of the exosuit.

    Parameters
    ----------
    name : str
        Name of the set.
    labels : sequence of k str
        Names of its parameters.
    lower, upper, start : (k,) array
        Bounds and starting design, SI.
    profile : callable
        ``profile(p, X)`` with one design p (k,) and points X (m,) in [0, 1] gives S (m,) [m], or
        the pair S, dS/dX. Without the slope, fourth-order differences in X supply it.
    jacobian : callable, optional
        ``jacobian(p, X)`` gives dS/dp (m, k), or the pair dS/dp, d(dS/dX)/dp. Without it,
        fourth-order central differences in p supply both.
    units : sequence of k str, optional
        Display units: "1", "m", "cm", "mm", "rad" or "deg". Default "1".
    minimum_radius : float, optional
        The surface is held at this radius [m] where the function falls below it; the rod's minimum
        radius by default.
    rod : Space
        The exosuit whose length is used; `flexor.optimize` replaces it by its model's.

    Returns
    -------
    ParameterSet
        To be used as it is, or with the length: ``union(parameter_set("L"), custom(...))``.

    Raises
    ------
    InputError
        If labels, units, bounds and start do not fit together.
    """
    low, high = np.asarray(lower, dtype=np.float64), np.asarray(upper, dtype=np.float64)
    minimum = rod.minimum_radius if minimum_radius is None else minimum_radius
    if not minimum > 0.0:
        raise InputError(f"parameter set {name}: minimum_radius must be positive, got {minimum:g}.")
    surface: Profile = FunctionProfile(profile, jacobian, high - low)
    return ParameterSet(
        name=name,
        labels=tuple(labels),
        units=tuple(units) if units is not None else ("1",) * len(labels),
        lower=low,
        upper=high,
        start=np.asarray(start, dtype=np.float64),
        profile=Clamped(surface, minimum),
        rod=rod,
    )
