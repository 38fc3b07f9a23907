"""Aggregates: one number for what a design does in all scenarios."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from flexor.arrays import Array
from flexor.errors import InputError, unknown_name
from flexor.model.quantity import parse_quantity
from flexor.model.units import Dimension

NAMES = ("mean", "worst", "quantile", "served")
# Of the mean shortfall of those who are not served, at most 1: less than one of a hundred wearers,
# so that a search sees which way leads to the next.
SHORTFALL = 1e-3


@dataclass(frozen=True)
class Aggregate:
    """How the values of S scenarios become one value to minimise; made by `aggregate`.

    Attributes
    ----------
    kind : str
        ``"mean"``, weighted; ``"worst"``, the largest; ``"quantile"``, the smallest value that a
        share ``level`` of the weight does not exceed; ``"served"``, minus the share of the weight
        whose value does not exceed ``level`` and that keeps all constraints.
    level : float
        Of a quantile, in (0, 1]; for ``"served"`` the bound of the value, SI.
    text : str
        As it was written.
    """

    kind: str
    level: float
    text: str

    @property
    def everywhere(self) -> bool:
        """Whether constraints have to be kept in every scenario."""
        return self.kind != "served"

    @property
    def differentiable(self) -> bool:
        """Whether it has a gradient."""
        return self.kind != "served"

    def value(self, values: Array, weights: Array, broken: Array) -> Array:
        """Aggregate the values of n designs.

        Parameters
        ----------
        values : (n, S) array
            Values to minimise; +inf where a design failed.
        weights : (S,) array
            Weights, of any sum.
        broken : (n, S) array
            Violations of the constraints.

        Returns
        -------
        (n,) array
            One value for each design; +inf if it failed in a scenario, except for ``"served"``.
        """
        if self.kind == "served":
            short = self.shortfalls(values, broken)
            share = weights / weights.sum()
            return _sum(np.where(short > 0.0, SHORTFALL * np.minimum(short, 1.0), -1.0) * share)
        shares = self.shares(values, weights)
        # A share of zero of an infinite value is nothing, but a design that fails has no value.
        failed = np.isinf(values).any(axis=1)
        found = _sum(np.where(np.isinf(values), 0.0, values) * shares)
        return np.where(failed, np.inf, found)

    def shares(self, values: Array, weights: Array) -> Array:
        """Return the derivative of the aggregate by the value of each scenario, (n, S).

        Of the worst and of a quantile that of the one scenario that decides.
        """
        share = weights / weights.sum()
        if self.kind == "mean":
            return np.broadcast_to(share, values.shape)
        if self.kind == "served":
            return np.zeros(values.shape)
        chosen = np.zeros(values.shape)
        chosen[np.arange(len(values)), self._deciding(values, share)] = 1.0
        return chosen

    def shortfalls(self, values: Array, broken: Array) -> Array:
        """Return how far each scenario is from being served, (n, S); 0 where it is."""
        scale = abs(self.level) or 1.0
        with np.errstate(invalid="ignore"):
            short = np.maximum((values - self.level) / scale, 0.0) + broken
        return np.where(np.isnan(short), np.inf, short)

    def _deciding(self, values: Array, share: Array) -> NDArray[np.intp]:
        if self.kind == "worst":
            return np.asarray(np.argmax(values, axis=1))
        order = np.argsort(values, axis=1, kind="stable")
        reached = np.cumsum(share[order], axis=1)
        # The rounding of the sum must not ask for one scenario more.
        first = (reached >= self.level - 1e-12).argmax(axis=1)
        return np.asarray(order[np.arange(len(values)), first])


def aggregate(text: str, sign: float = 1.0, dimension: Dimension | None = None) -> Aggregate:
    """Read an aggregate.

    Parameters
    ----------
    text
        ``"mean"``, ``"worst"``, ``"quantile 0.9"`` or ``"served 60 deg"``, the last with what the
        objective's quantity has to reach.
    sign
        -1 if that is to be maximised, 1 if it is to be minimised.
    dimension
        What it is measured in.

    Raises
    ------
    InputError
        If it is none of these, or its number is missing or out of range.

    Examples
    --------
    >>> aggregate("quantile 0.9").level
    0.9
    """
    name, _, rest = (text if isinstance(text, str) else "").strip().partition(" ")
    rest = rest.strip()
    if name not in NAMES:
        raise InputError(f"{unknown_name('aggregate', str(text), NAMES)}.")
    if name in ("mean", "worst"):
        if rest:
            raise InputError(f'aggregate "{text}": "{name}" takes no number.')
        return Aggregate(name, math.nan, name)
    if name == "quantile":
        try:
            level = float(rest)
        except ValueError:
            level = math.nan
        if not 0.0 < level <= 1.0:
            raise InputError(
                f'aggregate "{text}": write the share of scenarios that have to be at least as '
                'good, above 0 and at most 1, such as "quantile 0.9".'
            )
        return Aggregate(name, level, f"quantile {level!r}")
    if not rest:
        raise InputError(
            f'aggregate "{text}": write what has to be reached, such as "served 60 deg".'
        )
    value: object = rest
    if dimension is None:
        try:
            value = float(rest)
        except ValueError:
            value = rest
    number, _ = parse_quantity(value, dimension, f'aggregate "{text}": what has to be reached')
    return Aggregate(name, sign * number, f"served {rest}")


def _sum(terms: Array) -> Array:
    """Add scenario by scenario: a row must not depend on how many rows there are."""
    total = np.zeros(len(terms))
    for column in range(terms.shape[1]):
        total += terms[:, column]
    return total
