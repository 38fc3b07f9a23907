"""Parameter sets from a user-defined surface function."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from flexor.arrays import Array
from flexor.design.parameter_set import ParameterSet
from flexor.design.profile import Clamped, Profile
from flexor.errors import InputError
from flexor.model.geometry import PAPER, DesignSpace

# Step of the fourth-order central differences as a fraction of a variable's range. For a smooth
# surface the truncation and the rounding error are then both about 1e-12.
STEP = 1e-3
_OFFSETS = np.array([-2.0, -1.0, 1.0, 2.0])
_WEIGHTS = np.array([1.0, -8.0, 8.0, -1.0]) / 12.0

ProfileResult = Array | tuple[Array, Array]
ProfileFunction = Callable[[Array, Array], ProfileResult]


@dataclass(frozen=True)
class FunctionProfile:
    """A `Profile` from a function of one design.

    Derivatives that are not given are computed by fourth-order central differences with step
    ``STEP`` (of X, and of each parameter's range). X stays within [0, 1].
    """

    function: ProfileFunction  # p (k,), X (m,) -> S (m,) [m], or the pair S, dS/dX
    derivative: ProfileFunction | None  # p, X -> dS/dp (m, k), or the pair dS/dp, d(dS/dX)/dp
    span: Array  # (k,): range of each parameter, which scales its differences

    def value(self, p: Array, X: Array) -> tuple[Array, Array]:
        """Return S and dS/dX [m], each (n, m)."""
        return self._batch(lambda design: self._with_slope(self.function, design, X, (X.size,)), p)

    def jacobian(self, p: Array, X: Array) -> tuple[Array, Array]:
        """Return dS/dp and d(dS/dX)/dp, each (n, m, k)."""
        derivative = self.derivative
        if derivative is not None:
            shape = (X.size, p.shape[1])
            return self._batch(lambda design: self._with_slope(derivative, design, X, shape), p)
        return self._batch(lambda design: self._differences(design, X), p)

    def _batch(
        self, evaluate: Callable[[Array], tuple[Array, Array]], p: Array
    ) -> tuple[Array, Array]:
        pairs = [evaluate(design) for design in p]
        return np.stack([pair[0] for pair in pairs]), np.stack([pair[1] for pair in pairs])

    def _with_slope(
        self, function: ProfileFunction, design: Array, X: Array, shape: tuple[int, ...]
    ) -> tuple[Array, Array]:
        """Evaluate a function; if it returns no slope, compute it by differences in X."""
        result = function(design, X)
        if isinstance(result, tuple):
            return _checked(result[0], shape), _checked(result[1], shape)
        radius = _checked(result, shape)
        # The stencil is shifted inwards at the ends, so its weights depend on the point.
        centre = np.clip(X, 2 * STEP, 1 - 2 * STEP)
        nodes = STEP * np.arange(-2.0, 3.0)
        points = centre[:, None] + nodes
        samples = function(design, points.ravel())
        if isinstance(samples, tuple):
            raise InputError("the surface function returned a slope in some calls only.")
        values = _checked(samples, (points.size, *shape[1:])).reshape(*points.shape, *shape[1:])
        weights = _slope_weights((X - centre) / STEP) / STEP
        slope = np.zeros(shape)
        for node in range(nodes.size):
            weight = weights[:, node].reshape(-1, *(1,) * (len(shape) - 1))
            slope += weight * values[:, node]
        return radius, slope

    def _differences(self, design: Array, X: Array) -> tuple[Array, Array]:
        radius = np.zeros((X.size, design.size))
        slope = np.zeros_like(radius)
        for i, span in enumerate(self.span):
            for offset, weight in zip(_OFFSETS, _WEIGHTS, strict=True):
                shifted = design.copy()
                shifted[i] += offset * STEP * span
                value = self._with_slope(self.function, shifted, X, (X.size,))
                radius[:, i] += weight / (STEP * span) * value[0]
                slope[:, i] += weight / (STEP * span) * value[1]
        return radius, slope


def _slope_weights(t: Array) -> Array:
    """Return the weights (m, 5) for the derivative at t of the quartic on the nodes -2 ... 2."""
    nodes = np.arange(-2.0, 3.0)
    weights = np.zeros((t.size, nodes.size))
    for j, node in enumerate(nodes):
        others = np.delete(nodes, j)
        polynomial = np.poly(others) / np.prod(node - others)
        weights[:, j] = np.polyval(np.polyder(polynomial), t)
    return weights


def _checked(values: Array, shape: tuple[int, ...]) -> Array:
    array = np.asarray(values, dtype=np.float64)
    if array.shape != shape:
        raise InputError(
            f"the surface function must return an array of shape {shape}, "
            f"got one of shape {array.shape}."
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
    rod: DesignSpace = PAPER,
) -> ParameterSet:
    """Create a parameter set from a function that describes the surface of the exosuit.

    Parameters
    ----------
    name : str
        Name of the set.
    labels : sequence of k str
        Names of the parameters.
    lower, upper, start : (k,) array
        Bounds and starting design, SI.
    profile : callable
        ``profile(p, X)``, for one design p (k,) and points X (m,) in [0, 1], returns S (m,) [m] or
        the pair S, dS/dX. A missing slope is computed by fourth-order differences in X.
    jacobian : callable, optional
        ``jacobian(p, X)`` returns dS/dp (m, k) or the pair dS/dp, d(dS/dX)/dp. By default both are
        computed by fourth-order central differences in p.
    units : sequence of k str, optional
        Display units: "1", "m", "cm", "mm", "rad" or "deg". Default "1".
    minimum_radius : float, optional
        Lower limit of the surface radius [m]; the rod's minimum radius by default.
    rod : DesignSpace
        The exosuit whose length is used; `flexor.optimize` substitutes that of its model.

    Returns
    -------
    ParameterSet
        Combine it with the length by ``union(parameter_set("L"), custom(...))``.

    Raises
    ------
    InputError
        If labels, units, bounds and start are inconsistent.
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
