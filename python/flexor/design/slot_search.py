"""Finding how the engine's parameters depend on fields of a model file.

Lowering a model file makes each of the engine's parameters a function of its fields: the numbers of
a fibre are polynomials of the thicknesses of a section, a stiffness in series is one over a
polynomial, the torsion of a hollow section is a quotient of two, the ends of a strap are where
polynomials of whatever moves them put them. These are found by lowering the file at points of the
box and are checked at others, to rounding, vertices of the box among them. A parameter is a
polynomial of those fields only that move it, which is seen at the ends of the box.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from flexor.arrays import Array
from flexor.design.box_points import points_of_box, sobol_points, vertices
from flexor.design.fitting import (
    MAX_DEGREE,
    Fitting,
    enough,
    quotient,
    quotient_degrees,
    rounds,
    trimmed,
)
from flexor.design.lowered import Lowered
from flexor.design.polynomials import powers_up_to
from flexor.design.slot_map import Fit, RestLength, SlotMap
from flexor.errors import InputError
from flexor.model.structure import Structure

# Of the largest number of the same parameter: what is smaller is what rounding leaves of a zero,
# such as the moment about an axis of symmetry.
ROUNDING = 1e-16
CHECKS = 8  # points inside the box at which the polynomials are checked, besides vertices

Pattern = tuple[int, ...]  # the fields that some parameters depend on


def slot_map(
    model: Structure,
    fields: Sequence[tuple[str, ...]],
    names: Sequence[str],
    lower_bounds: Array,
    upper_bounds: Array,
) -> SlotMap:
    """Find how the engine's parameters depend on fields of a model file.

    Parameters
    ----------
    model
        The model.
    fields
        Keys of the k fields; see `flexor.design.fields`.
    names
        What they are called, for messages.
    lower_bounds, upper_bounds : (k,) arrays
        The box, SI.

    Raises
    ------
    InputError
        If a field has no effect, or changes what the model is made of.
    """
    middle, half = 0.5 * (lower_bounds + upper_bounds), 0.5 * (upper_bounds - lower_bounds)
    lowered = Lowered(model, tuple(fields), names)
    if not fields:
        none = np.zeros(0, dtype=np.intp)
        return SlotMap(none, none, middle, half, ())
    centre = lowered.at(middle)
    noise = noise_of(lowered, np.abs(centre))
    moved = _moved(lowered, middle, half, centre, noise, names)
    varied = np.flatnonzero(moved.any(axis=0))
    straps = [each for each in lowered.straps if moved[:, each[1].start : each[2] + 1].any()]
    constant = {
        column for _, ends, offset in straps for column in range(ends.start, offset + 1)
    } - set(varied.tolist())
    every = sorted({*varied.tolist(), *constant, *(rest for rest, _, _ in straps)})
    position = {column: i for i, column in enumerate(every)}
    search = _Search(lowered, middle, half, centre, noise, position)
    if constant:
        search.keep(sorted(constant))
    left = search.run(_patterns(lowered, moved))
    for pattern, columns in left.items():
        raise _no_polynomial(lowered, names, pattern, int(columns[0]))
    return SlotMap(
        indices=np.array([column for column in every if column < lowered.size], dtype=np.intp),
        every=np.array(every, dtype=np.intp),
        middle=middle,
        half=half,
        fits=tuple(search.fits),
        straps=tuple(
            RestLength(
                position[rest],
                np.array([position[column] for column in range(ends.start, ends.stop)]),
                position[offset],
            )
            for rest, ends, offset in straps
        ),
        quotients=tuple(search.quotients),
    )


def noise_of(lowered: Lowered, sizes: Array) -> Array:
    """Return what rounding may leave of a zero in each column, given sizes of all columns."""
    noise = np.zeros(len(sizes))
    for start, stop in lowered.ranges:
        noise[start:stop] = ROUNDING * sizes[start:stop].max(initial=0.0)
    return noise


def _moved(
    lowered: Lowered,
    middle: Array,
    half: Array,
    centre: Array,
    noise: Array,
    names: Sequence[str],
) -> NDArray[np.bool_]:
    """Return which columns each field moves from the middle to an end of its range, (k, w)."""
    moved = np.zeros((len(middle), len(centre)), dtype=bool)
    for i, name in enumerate(names):
        for end in (-1.0, 1.0):
            x = middle.copy()
            x[i] += end * half[i]
            there = lowered.at(x, name)
            moved[i] |= (there != centre) & (np.maximum(np.abs(there), np.abs(centre)) > noise)
        if not moved[i].any():
            raise InputError(f'"{name}" cannot be varied: it has no effect on the model.')
    return moved


def _patterns(lowered: Lowered, moved: NDArray[np.bool_]) -> dict[Pattern, NDArray[np.intp]]:
    """Return the columns that vary, by the fields that they depend on.

    The entries of one parameter, such as the numbers of all fibres, have the same.
    """
    varied = np.asarray(moved.any(axis=0))
    patterns: dict[Pattern, list[int]] = {}
    for start, stop in lowered.ranges:
        inside = start + np.flatnonzero(varied[start:stop])
        if inside.size:
            pattern = tuple(np.flatnonzero(moved[:, start:stop].any(axis=1)).tolist())
            patterns.setdefault(pattern, []).extend(inside.tolist())
    return {pattern: np.array(columns) for pattern, columns in patterns.items()}


def _no_polynomial(
    lowered: Lowered, names: Sequence[str], pattern: Pattern, column: int
) -> InputError:
    which = ", ".join(f'"{names[i]}"' for i in pattern)
    several = len(pattern) > 1
    return InputError(
        f"{which} cannot be varied{' together' if several else ''} over "
        f"{'these ranges' if several else 'this range'}: {lowered.name(column)} is no "
        f"polynomial of degree {MAX_DEGREE} of {'them' if several else 'it'}, nor a quotient "
        f"of two; make the {'ranges' if several else 'range'} smaller."
    )


class _Search:
    """The search for the polynomials of all columns, with more and more points."""

    def __init__(
        self,
        lowered: Lowered,
        middle: Array,
        half: Array,
        centre: Array,
        noise: Array,
        position: Mapping[int, int],
    ) -> None:
        self._k = len(middle)
        self._size, self._centre, self._noise = lowered.size, centre, noise
        self._position = position
        self._sampled = _Sampled(lowered, middle, half)
        self.fits: list[Fit] = []
        self.quotients: list[tuple[int, int]] = []

    def keep(self, columns: Sequence[int]) -> None:
        """Let columns keep the value that they have in the middle of the box."""
        powers = np.zeros((1, self._k), dtype=np.intp)
        places = self._places(columns)
        self.fits.append(Fit(places, powers, self._centre[None, list(columns)], "polynomial"))

    def run(self, left: dict[Pattern, NDArray[np.intp]]) -> dict[Pattern, NDArray[np.intp]]:
        """Fit columns, by the fields that they depend on; return those that nothing fits."""
        most = max(map(len, left))
        few = enough(most)
        # A few points suffice for most files; others take more besides them.
        for count in rounds(most):
            u, samples = self._sampled.first(count, np.concatenate([*left.values()]))
            tried = {
                pattern: self._quotients(
                    u,
                    samples,
                    pattern,
                    self._polynomials(u, samples, pattern, columns, count),
                    count,
                    few,
                )
                for pattern, columns in left.items()
            }
            left = {pattern: columns for pattern, columns in tried.items() if columns.size}
            if not left:
                break
        return left

    def _polynomials(
        self,
        u: Array,
        samples: Array,
        pattern: Pattern,
        columns: NDArray[np.intp],
        count: int,
    ) -> NDArray[np.intp]:
        """Fit polynomials; return the columns that are none."""
        fitting = Fitting(u, pattern, count)
        for form, degree in fitting.attempts():
            if not columns.size:
                break
            powers, coefficients, good = fitting.fit(samples[:, columns], form, degree)
            if good.any():
                fit = trimmed(powers, coefficients[:, good])
                self.fits.append(Fit(self._places(columns[good]), *fit, form))
                columns = columns[~good]
        return columns

    def _quotients(
        self,
        u: Array,
        samples: Array,
        pattern: Pattern,
        columns: NDArray[np.intp],
        count: int,
        few: int,
    ) -> NDArray[np.intp]:
        """Fit quotients, and what is but rounding; return the columns that are neither."""
        # Ends of straps are none.
        others = columns[columns < self._size]
        for degree in quotient_degrees(len(pattern), count, few, len(others)):
            powers = powers_up_to(pattern, degree, self._k)
            for column in others.tolist():
                both = quotient(u, samples[:, column], powers, count)
                if both is not None:
                    below = len(self._position) + len(self.quotients)
                    self.quotients.append((self._position[column], below))
                    for place, coefficients in zip(self.quotients[-1], both, strict=True):
                        fit = trimmed(powers, coefficients[:, None])
                        self.fits.append(Fit(np.array([place]), *fit, "polynomial"))
                    columns = columns[columns != column]
            others = np.intersect1d(others, columns)
        # No polynomial, but rounding of a zero that differs from file to file.
        zero = np.abs(samples[:, columns]).max(axis=0, initial=0.0) <= 1e4 * self._noise[columns]
        if count >= few and zero.any():
            self.keep(columns[zero].tolist())
            columns = columns[~zero]
        return columns

    def _places(self, columns: Sequence[int] | NDArray[np.intp]) -> NDArray[np.intp]:
        return np.array([self._position[int(column)] for column in columns], dtype=np.intp)


class _Sampled:
    """The engine's parameters at points of the box: some to fit them, and others to check that.

    Among the latter are vertices of the box, in which every three variables take all combinations
    of their ends: what has a kink where up to three variables reach a limit differs in one of them.
    """

    def __init__(self, lowered: Lowered, middle: Array, half: Array) -> None:
        self._lowered, self._middle, self._half = lowered, middle, half
        k = len(middle)
        checks = np.concatenate([points_of_box(CHECKS, k), vertices(k)])
        # Not every vertex is a design.
        found = [self._at(row, must=i < CHECKS) for i, row in enumerate(checks)]
        self._checks = checks[[each is not None for each in found]]
        self._checked = np.array([each for each in found if each is not None])
        self._fitted = np.zeros((0, self._checked.shape[1]))

    def first(self, count: int, wanted: NDArray[np.intp]) -> tuple[Array, Array]:
        """Return ``count`` points to fit, and those to check, with the wanted columns there."""
        u = sobol_points(count, len(self._middle), seed=1)
        at = self._of_straps if (wanted >= self._lowered.size).all() else self._at
        more = [at(row) for row in u[len(self._fitted) :]]
        self._fitted = np.concatenate([self._fitted, np.array(more)])
        return np.concatenate([u, self._checks]), np.concatenate([self._fitted, self._checked])

    def _of_straps(self, u: Array) -> Array:
        found = np.zeros(self._checked.shape[1])
        found[self._lowered.size :] = self._lowered.of_straps(self._middle + self._half * u)
        return found

    def _at(self, u: Array, must: bool = True) -> Array | None:
        try:
            return self._lowered.at(self._middle + self._half * u)
        except InputError:
            if must:
                raise
            return None
