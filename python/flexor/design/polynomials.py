"""Polynomials of several variables in [-1, 1] as sums of products of Legendre polynomials."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations_with_replacement

import numpy as np
from numpy.typing import NDArray

from flexor.arrays import Array

Powers = NDArray[np.intp]  # (c, k), degrees of each term in each variable


def powers_up_to(pattern: tuple[int, ...], degree: int, k: int) -> Powers:
    """Return the terms in some of k variables up to a total degree, lower ones first, (c, k)."""
    terms = [
        chosen
        for total in range(degree + 1)
        for chosen in combinations_with_replacement(pattern, total)
    ]
    powers = np.zeros((len(terms), k), dtype=np.intp)
    for row, chosen in zip(powers, terms, strict=True):
        for variable in chosen:
            row[variable] += 1
    return powers


def legendre(u: Array, top: int) -> tuple[Array, Array]:
    """Return Legendre polynomials up to a degree and their slopes, each (..., degrees)."""
    values, slopes = np.ones((*u.shape, top + 1)), np.zeros((*u.shape, top + 1))
    if top:
        values[..., 1], slopes[..., 1] = u, 1.0
    for n in range(1, top):
        values[..., n + 1] = ((2 * n + 1) * u * values[..., n] - n * values[..., n - 1]) / (n + 1)
        slopes[..., n + 1] = slopes[..., n - 1] + (2 * n + 1) * values[..., n]
    return values, slopes


def basis(u: Array, powers: Powers) -> Array:
    """Return the terms at points (n, k), (n, c)."""
    values, _ = legendre(u, int(powers.max(initial=0)))
    found = np.ones((len(u), len(powers)))
    for i in np.flatnonzero(powers.any(axis=0)):
        found *= values[:, i, powers[:, i]]
    return found


@dataclass(frozen=True, eq=False)
class Terms:
    """The terms of several sets of polynomials, evaluated together; made by `of`."""

    powers: Powers  # (t, k)
    order: tuple[int, ...]  # in which the variables are multiplied
    columns: NDArray[np.intp]  # (m,), the columns that have a term
    # The first terms of all of these, their second terms and so on: which of them have one, which
    # it is, and its coefficient.
    steps: tuple[tuple[NDArray[np.intp], NDArray[np.intp], Array], ...]

    @classmethod
    def of(
        cls,
        sets: Sequence[tuple[NDArray[np.intp], Powers, Array]],
        order: Sequence[int],
    ) -> Terms:
        """Arrange sets of columns (m,), powers (c, k) and coefficients (c, m)."""
        every = [powers for _, powers, _ in sets]
        powers = np.concatenate([np.zeros((0, len(order)), np.intp), *every])
        first = np.cumsum([0, *map(len, every)]).tolist()
        steps = []
        for step in range(max(map(len, every), default=0)):
            there = [i for i, each in enumerate(every) if len(each) > step]
            which = [np.full(len(sets[i][0]), first[i] + step) for i in there]
            steps.append(
                (
                    np.concatenate([sets[i][0] for i in there]),
                    np.concatenate(which),
                    np.concatenate([sets[i][2][step] for i in there]),
                )
            )
        columns = np.unique(np.concatenate([np.zeros(0, np.intp), *(step[0] for step in steps)]))
        placed = [(np.searchsorted(columns, each), which, of) for each, which, of in steps]
        return cls(powers, tuple(order), columns, tuple(placed))

    def sums(self, factors: Array) -> Array:
        """Return the sum in each of the columns, (m, n), for factors (k, degrees, n)."""
        terms = np.ones((len(self.powers), factors.shape[2]))
        for variable, rows, degrees in self._products:
            terms[rows] *= factors[variable, degrees]
        found = np.zeros((len(self.columns), factors.shape[2]))
        # Term by term: a design must not depend on its neighbours in the batch.
        for columns, which, coefficients in self.steps:
            found[columns] += terms[which] * coefficients[:, None]
        return found

    @cached_property
    def _products(self) -> list[tuple[int, NDArray[np.intp], NDArray[np.intp]]]:
        """The terms that have a factor of each variable, in the order of these, and its degree."""
        chosen = [(each, np.flatnonzero(self.powers[:, each])) for each in self.order]
        return [(each, rows, self.powers[rows, each]) for each, rows in chosen if len(rows)]
