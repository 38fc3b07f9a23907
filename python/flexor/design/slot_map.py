"""The engine's parameters as functions of fields of the model file, and their derivatives.

Each is a polynomial of fields in a box, the reciprocal or the root of one, a quotient of two, or
the rest length of a strap, whose ends are polynomials. `flexor.design.slot_search` finds them.
With them a thousand designs, and their exact derivatives, cost less than one file.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from flexor.arrays import Array
from flexor.design.polynomials import Powers, Terms, legendre
from flexor.model.schema.loop_gap import gap_slopes, gaps

# From a polynomial to the parameter: the inverse, the function and its derivative by its value.
FORMS: dict[str, tuple[Callable[[Array], Array], Callable[[Array], Array], Callable[..., Any]]] = {
    "polynomial": (lambda y: y, lambda z: z, lambda y: np.ones_like(y)),
    "root": (lambda y: y * y, lambda z: np.sqrt(z), lambda y: 0.5 / y),
    "reciprocal": (lambda y: 1.0 / y, lambda z: 1.0 / z, lambda y: -y * y),
}


@dataclass(frozen=True, eq=False)
class Fit:
    """Parameters that are the same function of polynomials in some of the variables."""

    columns: NDArray[np.intp]  # (m,), which columns of the map
    powers: Powers  # (c, k)
    coefficients: Array  # (c, m)
    form: str  # of `FORMS`

    def depending(self, variable: int) -> Fit:
        """Return it with those terms only that depend on a variable."""
        terms = self.powers[:, variable] > 0
        return replace(self, powers=self.powers[terms], coefficients=self.coefficients[terms])


@dataclass(frozen=True, eq=False)
class RestLength:
    """The rest length of a strap: the distance of its ends and an offset, by columns of the map."""

    column: int
    ends: NDArray[np.intp]  # (3,) or (6,), see `flexor.model.schema.strap.Strap.ends`
    offset: int

    def value(self, found: Array) -> Array:
        """Return it, (n,), given all columns (w, n)."""
        ends, offset = found[self.ends], found[self.offset]
        if len(self.ends) == 3:
            return np.asarray(np.sqrt((ends * ends).sum(axis=0)) + offset)
        return np.asarray(gaps(ends.T) + offset)

    def slopes(self, here: Array, slopes: Array) -> Array:
        """Return its derivatives (n, k), given columns (w, n) and their derivatives (n, k, w)."""
        ends = here[self.ends]
        if len(self.ends) == 3:
            length = np.sqrt((ends * ends).sum(axis=0))
            by_ends = np.divide(ends, length, out=np.zeros_like(ends), where=length > 0.0)
        else:
            by_ends = gap_slopes(ends.T).T
        found: Array = slopes[..., self.offset].copy()
        for by_end, column in zip(by_ends, self.ends, strict=True):
            found += by_end[:, None] * slopes[..., column]
        return found


@dataclass(frozen=True, eq=False)
class SlotMap:
    """Parameters of the engine as functions of k fields in a box; made by `slot_map`.

    Attributes
    ----------
    indices : (m,) array
        Which of the engine's parameters vary.
    every : (w,) array
        What its columns are, these first: see `flexor.design.lowered.Lowered`.
    middle, half : (k,) arrays
        Of the box.
    fits : tuple of Fit
        The polynomials.
    straps : tuple of RestLength
        Rest lengths that vary.
    quotients : tuple of pairs of int
        Columns of quotients, and those of their denominators, which are beyond `every`.
    """

    indices: NDArray[np.intp]
    every: NDArray[np.intp]
    middle: Array
    half: Array
    fits: tuple[Fit, ...]
    straps: tuple[RestLength, ...] = ()
    quotients: tuple[tuple[int, int], ...] = ()

    def values(self, x: Array) -> Array:
        """Return the parameters (n, m) of designs (n, k), SI."""
        found = self._evaluate(self._legendre(x)[0])
        for strap in self.straps:
            found[strap.column] = strap.value(found)
        return found[: len(self.indices)].T

    def valid(self, x: Array) -> NDArray[np.bool_]:
        """Return which designs (n, k) can be, (n,): all."""
        return np.ones(len(x), dtype=bool)

    def jacobian(self, x: Array) -> Array:
        """Return the derivatives (n, m, k) of the parameters of designs (n, k)."""
        values, slopes = self._legendre(x)
        here = self._evaluate(values)
        outer = np.ones_like(here)
        for form, columns in self._forms.items():
            outer[columns] = FORMS[form][2](here[columns])
        # Parameters last: those that depend on a variable are often neighbours.
        found = np.zeros((*x.shape, len(here)))
        for variable, terms in enumerate(self._terms[1:]):
            factors = values.copy()
            factors[variable] = slopes[variable]
            own = terms.columns
            found[:, variable, own] = (outer[own] * terms.sums(factors) / self.half[variable]).T
        for column, below in self.quotients:
            rise = found[..., column] - here[column][:, None] * found[..., below]
            found[..., column] = rise / here[below][:, None]
        for strap in self.straps:
            found[..., strap.column] = strap.slopes(here, found)
        return found[..., : len(self.indices)].swapaxes(1, 2)

    def _evaluate(self, values: Array) -> Array:
        """Return all columns but rest lengths, (w, n), for Legendre polynomials."""
        found = np.zeros((len(self.every) + len(self.quotients), values.shape[2]))
        found[self._terms[0].columns] = self._terms[0].sums(values)
        # What rounding leaves of a zero may have the wrong sign.
        found[np.abs(found) <= self._rounding[:, None]] = 0.0
        for form, columns in self._forms.items():
            found[columns] = FORMS[form][1](found[columns])
        for column, below in self.quotients:
            found[column] /= found[below]
        return found

    def _legendre(self, x: Array) -> tuple[Array, Array]:
        """Return Legendre polynomials and their slopes at designs (n, k), (k, degrees, n)."""
        top = max((int(fit.powers.max(initial=0)) for fit in self.fits), default=0)
        values, slopes = legendre(((x - self.middle) / self.half).T, top)
        by_degree = [np.ascontiguousarray(each.swapaxes(1, 2)) for each in (values, slopes)]
        return by_degree[0], by_degree[1]

    @cached_property
    def _rounding(self) -> Array:
        """What may be left of a zero in each column."""
        found = np.zeros(len(self.every) + len(self.quotients))
        for fit in self.fits:
            found[fit.columns] = 2.0 * np.finfo(float).eps * np.abs(fit.coefficients).sum(axis=0)
        return found

    @cached_property
    def _forms(self) -> dict[str, NDArray[np.intp]]:
        """Columns of each form that is not the polynomial itself."""
        found = {
            form: [fit.columns for fit in self.fits if fit.form == form]
            for form in FORMS
            if form != "polynomial"
        }
        return {form: np.concatenate(columns) for form, columns in found.items() if columns}

    @cached_property
    def _terms(self) -> list[Terms]:
        """Terms of the polynomials, and those that depend on each of the variables."""
        k = len(self.half)
        orders = [range(k), *(sorted(range(k), key=i.__ne__) for i in range(k))]
        varied = [self.fits, *([fit.depending(i) for fit in self.fits] for i in range(k))]
        return [
            Terms.of([(f.columns, f.powers, f.coefficients) for f in fits], order)
            for fits, order in zip(varied, orders, strict=True)
        ]
