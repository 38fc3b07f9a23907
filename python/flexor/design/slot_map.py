"""The engine's parameters as polynomials of fields of the model file.

Lowering a model file makes each of the engine's parameters a function of its fields: the numbers of
a fibre are polynomials of the thicknesses of a section, a stiffness in series is one over a
polynomial, the torsion of a hollow section is a quotient of two, the square of the distance of a
strap's ends is a polynomial of whatever moves them. These polynomials are found by lowering the
file at points of the box and are checked at others, to rounding, vertices of the box among them.
With them a thousand designs, and their exact derivatives, cost less than one file.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import product
from math import comb
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from flexor import _engine
from flexor.arrays import Array
from flexor.design.fields import replaced
from flexor.errors import InputError
from flexor.model.lowering import lower
from flexor.model.schema import ModelFile
from flexor.model.schema.strap import Loop
from flexor.model.structure import Structure

# Of a parameter, as a share of its largest value in the box.
TOLERANCE = 1e-11
MAX_DEGREE = 12
# Of the largest number of the same parameter: what is smaller is what rounding leaves of a zero,
# such as the moment about an axis of symmetry.
ROUNDING = 1e-16
_CHECKS = 8  # points inside the box at which the polynomials are checked, besides vertices
# The least that the denominator of a quotient may be, as a share of its largest value, and at how
# many points all over the box, vertices besides, that is checked.
_LEAST, _DENSE = 1e-3, 512
_FIRST, _MOST = 24, 1200  # points of the first attempts at most, and of the last


@dataclass(frozen=True, eq=False)
class _Fit:
    """Parameters that are the same function of polynomials in some of the variables."""

    columns: NDArray[np.intp]  # (m,), which of the varied parameters
    powers: NDArray[np.intp]  # (c, k), degrees of the Legendre polynomials of each term
    coefficients: Array  # (c, m)
    form: str  # of `_FORMS`

    def depending(self, variable: int) -> _Fit:
        """Return it with those terms only that depend on a variable."""
        terms = self.powers[:, variable] > 0
        return replace(self, powers=self.powers[terms], coefficients=self.coefficients[terms])


# From a polynomial to the parameter: the inverse, the function and its derivative by its value.
_FORMS: dict[str, tuple[Callable[[Array], Array], Callable[[Array], Array], Callable]] = {  # type: ignore[type-arg]
    "polynomial": (lambda y: y, lambda z: z, lambda y: np.ones_like(y)),
    "root": (lambda y: y * y, lambda z: np.sqrt(z), lambda y: 0.5 / y),
    "reciprocal": (lambda y: 1.0 / y, lambda z: 1.0 / z, lambda y: -y * y),
}


@dataclass(frozen=True, eq=False)
class SlotMap:
    """Parameters of the engine as functions of k fields in a box; made by `slot_map`.

    Attributes
    ----------
    indices : (m,) array
        Which of the engine's parameters vary.
    """

    indices: NDArray[np.intp]
    _middle: Array  # (k,)
    _half: Array  # (k,)
    _fits: tuple[_Fit, ...]
    # Rest lengths: their column, and that of the offset which is to be added to the distance.
    _offsets: tuple[tuple[int, int], ...]
    _every: NDArray[np.intp]  # (w,), which parameters and offsets its columns are
    # Quotients: their column, and that of the denominator, which is beyond those.
    _quotients: tuple[tuple[int, int], ...] = ()

    def values(self, x: Array) -> Array:
        """Return the parameters (n, m) of designs (n, k), SI."""
        return self._whole(self._evaluate(self._legendre(x)[0]))

    def jacobian(self, x: Array) -> Array:
        """Return the derivatives (n, m, k) of the parameters of designs (n, k)."""
        values, slopes = self._legendre(x)
        here = self._evaluate(values)
        outer = np.ones_like(here)
        for form, columns in self._forms.items():
            outer[:, columns] = _FORMS[form][2](here[:, columns])
        found = np.zeros((*here.shape, x.shape[1]))
        for variable, terms in enumerate(self._terms[1:]):
            factors = values.copy()
            factors[:, variable] = slopes[:, variable]
            found[..., variable] = outer * terms.sums(factors) / self._half[variable]
        for column, below in self._quotients:
            rise = found[:, column] - here[:, column, None] * found[:, below]
            found[:, column] = rise / here[:, below, None]
        return self._whole(found)

    def _whole(self, found: Array) -> Array:
        """Add offsets (n, m + offsets, ...) to rest lengths; return the parameters (n, m, ...)."""
        for rest, offset in self._offsets:
            found[:, rest] += found[:, offset]
        return found[:, : len(self.indices)]

    def _evaluate(self, values: Array) -> Array:
        """Return parameters and offsets for Legendre polynomials (n, k, degrees)."""
        found = self._terms[0].sums(values)
        for form, columns in self._forms.items():
            found[:, columns] = _FORMS[form][1](found[:, columns])
        for column, below in self._quotients:
            found[:, column] /= found[:, below]
        return found

    def _legendre(self, x: Array) -> tuple[Array, Array]:
        """Return Legendre polynomials and their slopes at designs (n, k), each (n, k, degrees)."""
        top = max((int(fit.powers.max(initial=0)) for fit in self._fits), default=0)
        return _legendre((x - self._middle) / self._half, top)

    @cached_property
    def _forms(self) -> dict[str, NDArray[np.intp]]:
        """Columns of each form that is not the polynomial itself."""
        found = {
            form: [fit.columns for fit in self._fits if fit.form == form]
            for form in _FORMS
            if form != "polynomial"
        }
        return {form: np.concatenate(columns) for form, columns in found.items() if columns}

    @cached_property
    def _terms(self) -> list[_Terms]:
        """Terms of the polynomials, and those that depend on each of the variables."""
        width, k = len(self._every) + len(self._quotients), len(self._half)
        varied = [[fit.depending(variable) for fit in self._fits] for variable in range(k)]
        return [
            _Terms.of(self._fits, range(k), width),
            *(
                _Terms.of(fits, sorted(range(k), key=i.__ne__), width)
                for i, fits in enumerate(varied)
            ),
        ]


@dataclass(frozen=True, eq=False)
class _Terms:
    """The terms of several fits, evaluated together."""

    powers: NDArray[np.intp]  # (t, k)
    order: tuple[int, ...]  # in which the variables are multiplied
    width: int  # number of columns
    # The first terms of all columns, their second terms and so on: which columns have one, which
    # it is, and its coefficient.
    steps: tuple[tuple[NDArray[np.intp], NDArray[np.intp], Array], ...]

    @classmethod
    def of(cls, fits: Sequence[_Fit], order: Sequence[int], width: int) -> _Terms:
        """Arrange the terms of fits of so many columns in all."""
        powers = np.concatenate([np.zeros((0, len(order)), np.intp), *(f.powers for f in fits)])
        first = np.cumsum([0, *(len(fit.powers) for fit in fits)]).tolist()
        steps = []
        for step in range(max((len(fit.powers) for fit in fits), default=0)):
            there = [i for i, fit in enumerate(fits) if len(fit.powers) > step]
            which = [np.full(len(fits[i].columns), first[i] + step) for i in there]
            steps.append(
                (
                    np.concatenate([fits[i].columns for i in there]),
                    np.concatenate(which),
                    np.concatenate([fits[i].coefficients[step] for i in there]),
                )
            )
        return cls(powers, tuple(order), width, tuple(steps))

    def sums(self, factors: Array) -> Array:
        """Return the sum in each column, (n, width), for factors (n, k, degrees) of the terms."""
        terms = np.ones((len(factors), len(self.powers)))
        for variable in self.order:
            terms *= factors[:, variable, self.powers[:, variable]]
        found = np.zeros((len(factors), self.width))
        # Term by term: a design must not depend on its neighbours in the batch.
        for columns, which, coefficients in self.steps:
            found[:, columns] += terms[:, which] * coefficients
        return found


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
    k = len(fields)
    centre = lowered.at(middle)
    moved = np.zeros((k, centre.size), dtype=bool)
    noise = np.zeros(centre.size)
    for start, stop in lowered.ranges:
        noise[start:stop] = ROUNDING * np.abs(centre[start:stop]).max(initial=0.0)
    for i, name in enumerate(names):
        for end in (-1.0, 1.0):
            x = middle.copy()
            x[i] += end * half[i]
            there = lowered.at(x, name)
            moved[i] |= (there != centre) & (np.maximum(np.abs(there), np.abs(centre)) > noise)
        if not moved[i].any():
            raise InputError(f'"{name}" cannot be varied: it has no effect on the model.')
    varied = np.flatnonzero(moved.any(axis=0))
    if not k:
        return SlotMap(varied, middle, half, (), (), varied)
    # The entries of one parameter, such as the numbers of all fibres, have the same variables.
    patterns: dict[tuple[int, ...], list[int]] = {}
    for start, stop in lowered.ranges:
        inside = varied[(varied >= start) & (varied < stop)]
        if inside.size:
            pattern = tuple(np.flatnonzero(moved[:, start:stop].any(axis=1)).tolist())
            patterns.setdefault(pattern, []).extend(inside.tolist())
    size = model.parameters.size
    straps = [
        (rest, size + i) for i, rest in enumerate(lowered.rests) if moved[:, [rest, size + i]].any()
    ]
    constant = sorted({column for pair in straps for column in pair} - set(varied.tolist()))
    every = sorted({*varied.tolist(), *constant})
    position = {column: i for i, column in enumerate(every)}
    fits: list[_Fit] = []
    quotients: list[tuple[int, int]] = []
    if constant:
        fits.append(_constant(constant, position, centre, k))
    most = max(len(pattern) for pattern in patterns)
    left = {pattern: np.array(members) for pattern, members in patterns.items()}
    sampled = _Sampled(lowered, middle, half)
    # A few points suffice for most files; others take more besides them.
    few = _enough(most)
    for count in _rounds(most):
        u, samples = sampled.first(count, np.concatenate([*left.values()]))
        for pattern in left:
            for form, degree in _attempts(len(pattern), count):
                columns = left[pattern]
                if not columns.size:
                    break
                powers = _powers(pattern, degree, k)
                coefficients, good = _fitted(u, samples[:, columns], powers, form, count)
                if good.any():
                    placed = np.array([position[int(column)] for column in columns[good]])
                    fits.append(_Fit(placed, *_trimmed(powers, coefficients[:, good]), form))
                    left[pattern] = columns[~good]
            # Distances are none.
            others = np.setdiff1d(left[pattern], lowered.rests)
            for degree in _quotient_degrees(len(pattern), count, few, len(others)):
                powers = _powers(pattern, degree, k)
                for column in np.intersect1d(left[pattern], others).tolist():
                    both = _quotient(u, samples[:, column], powers, count)
                    if both is not None:
                        below = len(every) + len(quotients)
                        quotients.append((position[column], below))
                        for place, coefficients in zip(quotients[-1], both, strict=True):
                            fit = _trimmed(powers, coefficients[:, None])
                            fits.append(_Fit(np.array([place]), *fit, "polynomial"))
                        left[pattern] = left[pattern][left[pattern] != column]
        for pattern, columns in left.items():
            # No polynomial, but rounding of a zero that differs from file to file.
            zero = np.abs(samples[:, columns]).max(axis=0, initial=0.0) <= 1e4 * noise[columns]
            if count >= few and zero.any():
                fits.append(_constant(columns[zero].tolist(), position, centre, k))
                left[pattern] = columns[~zero]
        left = {pattern: columns for pattern, columns in left.items() if columns.size}
        if not left:
            break
    for pattern, columns in left.items():
        which = ", ".join(f'"{names[i]}"' for i in pattern)
        several = len(pattern) > 1
        raise InputError(
            f"{which} cannot be varied{' together' if several else ''} over "
            f"{'these ranges' if several else 'this range'}: {lowered.name(int(columns[0]))} is no "
            f"polynomial of degree {MAX_DEGREE} of {'them' if several else 'it'}, nor a quotient "
            f"of two; make the {'ranges' if several else 'range'} smaller."
        )
    # Offsets follow the parameters.
    indices = np.array([column for column in every if column < size], dtype=np.intp)
    offsets = tuple((position[rest], position[offset]) for rest, offset in straps)
    return SlotMap(indices, middle, half, tuple(fits), offsets, np.array(every), tuple(quotients))


def refitted(
    like: SlotMap, known: Structure, model: Structure, fields: Sequence[tuple[str, ...]]
) -> SlotMap | None:
    """Return the same map for another model that differs from the known one in values.

    Parameters that differ by a constant take one file; the rest lengths of straps, which the
    fields and the other values decide together, take a few distances; all others a few files.
    None if the parameters of the model are other polynomials.
    """
    mine, theirs = Lowered(model, tuple(fields)), Lowered(known, tuple(fields))
    most = max(len(fit.powers) for fit in like._fits)
    u = 0.999 * _points(most + _CHECKS, len(fields), seed=1)
    points = like._middle + like._half * u
    probes = points[-2:]
    found, before = np.array([mine.at(x) for x in probes]), _probed(like, theirs, probes)
    size = found.shape[1]
    if before.shape[1] != size or mine.ranges != theirs.ranges:
        return None
    scale = np.maximum(np.abs(found), np.abs(before)).max(axis=0)
    noise = np.zeros(size)
    for start, stop in mine.ranges:
        noise[start:stop] = 1e4 * ROUNDING * scale[start:stop].max(initial=0.0)
    shift = found - before
    apart = np.abs(shift[0] - shift[1]) > np.maximum(TOLERANCE * scale, noise)
    others = np.setdiff1d(np.arange(size), like._every)
    if apart[others].any():
        return None
    again = np.flatnonzero(apart)
    if np.isin(again, mine.rests).all():
        samples = np.zeros((len(points), size))
        samples[:, mine.rests] = [mine.distances(x) for x in points]
    else:
        samples = np.array([mine.at(x) for x in points])
    fits = []
    of_quotients = {column for pair in like._quotients for column in pair}
    for fit in like._fits:
        if of_quotients.intersection(fit.columns.tolist()):
            own = like._every[fit.columns[fit.columns < len(like._every)]]
            if apart[own].any() or shift[0, own].any():
                return None
            fits.append(fit)
            continue
        columns = like._every[fit.columns]
        new = apart[columns]
        if new.any():
            coefficients, good = _fitted(u, samples[:, columns[new]], fit.powers, fit.form, most)
            if not (good | (scale[columns[new]] <= noise[columns[new]])).all():
                return None
            fits.append(_Fit(fit.columns[new], fit.powers, coefficients, fit.form))
        if not new.all():
            same = columns[~new]
            if fit.form != "polynomial" and (shift[0, same] != 0.0).any():
                return None
            fits.append(_shifted(fit, ~new, shift[0, same]))
    return replace(like, _fits=tuple(fits))


# By map: the parameters of the model that it is of, and those at its probes.
_PROBED: WeakKeyDictionary[SlotMap, tuple[Array, Array]] = WeakKeyDictionary()


def _probed(like: SlotMap, known: Lowered, probes: Array) -> Array:
    """Return the parameters of a known model, which many others are compared with."""
    own, found = _PROBED.get(like, (None, np.zeros(0)))
    if own is not known.own:
        found = np.array([known.at(x) for x in probes])
        _PROBED[like] = known.own, found
    return found


def _shifted(fit: _Fit, chosen: NDArray[np.bool_], shift: Array) -> _Fit:
    """Return some columns of a fit with constants added to their values."""
    coefficients = fit.coefficients[:, chosen]
    if not shift.any():
        return replace(fit, columns=fit.columns[chosen], coefficients=coefficients)
    powers = fit.powers
    first = np.flatnonzero(~powers.any(axis=1))
    if not first.size:
        powers = np.concatenate([np.zeros((1, powers.shape[1]), dtype=np.intp), powers])
        coefficients = np.concatenate([np.zeros((1, coefficients.shape[1])), coefficients])
        first = np.array([0])
    coefficients = coefficients.copy()
    coefficients[first[0]] += shift
    return _Fit(fit.columns[chosen], powers, coefficients, fit.form)


class _Sampled:
    """The engine's parameters at points of the box: some to fit them, and others to check that.

    Among the latter are vertices of the box, in which every three variables take all combinations
    of their ends: what has a kink where up to three variables reach a limit differs in one of them.
    """

    def __init__(self, lowered: Lowered, middle: Array, half: Array) -> None:
        self._lowered, self._middle, self._half = lowered, middle, half
        k = len(middle)
        self._checks = np.concatenate([points_of_box(_CHECKS, k), _vertices(k)])
        # Not every vertex is a design.
        found = [self._at(row, must=i < _CHECKS) for i, row in enumerate(self._checks)]
        there = [each is not None for each in found]
        self._checks = self._checks[there]
        self._checked = np.array([each for each in found if each is not None])
        self._fitted = np.zeros((0, self._checked.shape[1]))

    def first(self, count: int, wanted: NDArray[np.intp]) -> tuple[Array, Array]:
        """Return ``count`` points to fit, and those to check, with the wanted parameters there."""
        u = _points(count, len(self._middle), seed=1)
        # Distances take much less than all that a file lowers to.
        at = self._distances if np.isin(wanted, self._lowered.rests).all() else self._at
        more = [at(row) for row in u[len(self._fitted) :]]
        self._fitted = np.concatenate([self._fitted, np.array(more)])
        return np.concatenate([u, self._checks]), np.concatenate([self._fitted, self._checked])

    def _distances(self, u: Array) -> Array:
        found = np.zeros(self._checked.shape[1])
        found[self._lowered.rests] = self._lowered.distances(self._middle + self._half * u)
        return found

    def _at(self, u: Array, must: bool = True) -> Array | None:
        try:
            return self._lowered.at(self._middle + self._half * u)
        except InputError:
            if must:
                raise
            return None


def _constant(columns: list[int], position: Mapping[int, int], centre: Array, k: int) -> _Fit:
    """Return parameters that keep the value that they have in the middle of the box."""
    places = np.array([position[column] for column in columns])
    powers = np.zeros((1, k), dtype=np.intp)
    return _Fit(places, powers, centre[None, columns], "polynomial")


def _enough(variables: int) -> int:
    """Return how many points polynomials of degree 3 take, or of one variable of any degree."""
    return max((3 * comb(variables + 3, 3) + 1) // 2, 2 * MAX_DEGREE + 2)


def _rounds(variables: int) -> list[int]:
    """Return numbers of points, each about twice the one before.

    Up to `_enough` for polynomials, and beyond for what is close to one, such as the shear of a
    section by its walls.
    """
    counts = [_enough(variables)]
    while counts[0] > _FIRST:
        counts.insert(0, (counts[0] + 1) // 2)
    most = min((3 * comb(variables + MAX_DEGREE, MAX_DEGREE) + 1) // 2, _MOST)
    while counts[-1] < most:
        counts.append(min(2 * counts[-1], most))
    return counts


def _vertices(k: int) -> Array:
    """Return vertices of [-1, 1]^k, (c, k): a two-level orthogonal array of strength 3.

    It is the foldover of a Hadamard matrix, see Hedayat, Sloane and Stufken (1999), section 7.5.
    """
    from scipy.linalg import hadamard  # deferred: slow to import

    signs = hadamard(1 << (k - 1).bit_length())[:, :k]
    return np.unique(np.concatenate([signs, -signs]), axis=0).astype(float)


def parameters_with(model: Structure, changes: Mapping[tuple[str, ...], float]) -> Array | None:
    """Return the engine's parameters (P,) of a model with other values of some fields, SI.

    None if it is then no model, or one that is made of other things.

    Parameters
    ----------
    model
        The model.
    changes
        By the keys of a field; see `flexor.design.fields`.
    """
    try:
        described = lower(replaced(model.file, changes))
        _keep(described, model.description)
        engine = _engine.Model(json.dumps(described))
    except ValueError:  # of the file, too: an `InputError` is one
        return None
    return engine.parameters.copy() if engine.has_structure_of(model.engine) else None


class Lowered:
    """The engine's parameters, and offsets of straps, by lowering the file."""

    def __init__(
        self,
        model: Structure,
        fields: tuple[tuple[str, ...], ...],
        names: Sequence[str] = (),
    ) -> None:
        self._model, self._fields = model, fields
        self._names = ", ".join(f'"{name}"' for name in names)
        self._slots = model.engine.slots
        self._straps = [n for n, s in model.file.straps.items() if not isinstance(s.to, Loop)]
        self.rests = [self._slots[f"{name}.rest_length"][0] for name in self._straps]
        size = model.parameters.size
        extra = [(size + i, size + i + 1) for i in range(len(self._straps))]
        self.ranges = [*self._slots.values(), *extra]

    @property
    def own(self) -> Array:
        """The engine's parameters of the model itself."""
        return self._model.parameters

    def parameters(self, x: Array, name: str = "") -> Array:
        """Return the engine's parameters for values (k,) of the fields, those of `name` varied."""
        return self._lowered(x, name)[1]

    def at(self, x: Array, name: str = "") -> Array:
        """Return them with offsets of straps, whose lengths are the distances of their ends."""
        file, found = self._lowered(x, name)
        offsets = []
        for strap, rest in zip(self._straps, self.rests, strict=True):
            table = file.straps[strap]
            distance = table.distance(file)
            offsets.append(float(table.slack) - float(table.pretension) / table.constant)
            found[rest] = distance
        return np.concatenate([found, offsets])

    def _lowered(self, x: Array, name: str) -> tuple[ModelFile, Array]:
        changes = dict(zip(self._fields, x.tolist(), strict=True))
        file: ModelFile = replaced(self._model.file, changes)
        described = lower(file)
        _keep(described, self._model.description)
        try:
            engine = _engine.Model(json.dumps(described))
        except ValueError as error:
            raise InputError(f"{self._said(name)} cannot be varied so far: {error}.") from None
        if not engine.has_structure_of(self._model.engine):
            raise InputError(
                f"{self._said(name)} cannot be varied: that changes what the model is made of; "
                "give values to choose from, such as by --choose."
            )
        return file, engine.parameters.copy()

    def _said(self, name: str) -> str:
        return f'"{name}"' if name else self._names

    def distances(self, x: Array) -> list[float]:
        """Return the distance of the ends of each strap, which is what `at` has for its length."""
        file = replaced(self._model.file, dict(zip(self._fields, x.tolist(), strict=True)))
        return [file.straps[strap].distance(file) for strap in self._straps]

    def name(self, column: int) -> str:
        """Return which parameter a column is."""
        for name, (start, stop) in self._slots.items():
            if start <= column < stop:
                return name
        return "the offset of a strap"


def _keep(described: dict[str, object], own: dict[str, object]) -> None:
    """Keep what is made once for the model: shares of the tip, and which rods touch themselves."""
    for key in ("spheres", "contacts"):
        mine = own.get(key, [])
        if key in described or mine:
            described[key] = mine
    rubbing: dict[str, object] = {each["name"]: each for each in described.get("frictions", [])}  # type: ignore[attr-defined]
    if frictions := own.get("frictions"):
        described["frictions"] = [rubbing.get(each["name"], each) for each in frictions]  # type: ignore[attr-defined]
    for new, old in zip(described.get("foundations", ()), own.get("foundations", ()), strict=False):  # type: ignore[call-overload]
        new["tip"], new["alignment"] = old["tip"], old["alignment"]


def _attempts(variables: int, points: int) -> list[tuple[str, int]]:
    """Return forms and degrees in the order in which they are tried."""
    degrees = [d for d in range(1, MAX_DEGREE + 1) if 1.5 * comb(variables + d, d) <= points]
    low = [(form, degree) for degree in degrees[:4] for form in _FORMS]
    # The square of a distance on a rod that is curved in the reference state is no polynomial, but
    # close to one.
    return low + [(form, degree) for degree in degrees[4:] for form in ("polynomial", "root")]


def _fitted(
    u: Array, samples: Array, powers: NDArray[np.intp], form: str, count: int
) -> tuple[Array, NDArray[np.bool_]]:
    """Fit columns at the first points; return their coefficients, and which hold at all points."""
    inverse, forward, _ = _FORMS[form]
    basis = _basis(u, powers)
    with np.errstate(divide="ignore", invalid="ignore"):
        wanted = inverse(samples)
        usable = np.isfinite(wanted).all(axis=0)
        if form != "polynomial":
            usable &= (samples > 0.0).all(axis=0)
        wanted = np.where(usable, wanted, 0.0)
        scale = np.abs(wanted).max(axis=0)
        scale[scale == 0.0] = 1.0
        coefficients = np.linalg.lstsq(basis[:count], wanted[:count] / scale, rcond=None)[0]
        coefficients[np.abs(coefficients) < 1e-14] = 0.0
        found = forward(basis @ coefficients * scale)
    largest = np.abs(samples).max(axis=0)
    good = usable & (np.abs(found - samples).max(axis=0) <= TOLERANCE * largest)
    return coefficients * scale, np.asarray(good)


def _quotient_degrees(variables: int, points: int, few: int, columns: int) -> list[int]:
    """Return the degrees of quotients that are tried for what no few points make a polynomial."""
    degrees = range(1, MAX_DEGREE + 1) if points >= few and columns else ()
    return [d for d in degrees if 1.5 * (2 * comb(variables + d, d) - 1) <= points]


def _quotient(
    u: Array, samples: Array, powers: NDArray[np.intp], count: int
) -> tuple[Array, Array] | None:
    """Fit a quotient to samples (s,) at the first points; return both polynomials' coefficients.

    That is the least denominator besides its constant; None if it does not hold at all points.
    """
    scale = np.abs(samples).max()
    if scale == 0.0:
        return None
    basis = _basis(u, powers)
    constant = ~powers.any(axis=1)
    wanted = samples / scale
    matrix = np.concatenate([basis, -wanted[:, None] * basis[:, ~constant]], axis=1)
    found = np.linalg.lstsq(matrix[:count], wanted[:count], rcond=None)[0]
    above, below = found[: len(powers)], np.ones(len(powers))
    below[~constant] = found[len(powers) :]
    bottom, dense = basis @ below, _basis(_points(_DENSE, u.shape[1], seed=3), powers) @ below
    if min(bottom.min(), dense.min()) < _LEAST * max(bottom.max(), dense.max()):
        return None
    if not (np.abs(basis @ above / bottom - wanted) <= TOLERANCE).all():
        return None
    return above * scale, below


def _trimmed(powers: NDArray[np.intp], coefficients: Array) -> tuple[NDArray[np.intp], Array]:
    used = coefficients.any(axis=1)
    return powers[used], coefficients[used]


def _powers(pattern: tuple[int, ...], degree: int, k: int) -> NDArray[np.intp]:
    """Return the degrees of all terms in some of k variables up to a total degree, (c, k)."""
    terms = [p for p in product(range(degree + 1), repeat=len(pattern)) if sum(p) <= degree]
    powers = np.zeros((len(terms), k), dtype=np.intp)
    powers[:, list(pattern)] = terms
    return powers


def _basis(u: Array, powers: NDArray[np.intp]) -> Array:
    """Return products of Legendre polynomials of these degrees (c, k) at points (n, k), (n, c)."""
    values, _ = _legendre(u, int(powers.max()))
    found = [values[:, i, powers[:, i]] for i in range(u.shape[1])]
    return np.asarray(np.prod(found, axis=0))


def _legendre(u: Array, top: int) -> tuple[Array, Array]:
    values, slopes = np.ones((*u.shape, top + 1)), np.zeros((*u.shape, top + 1))
    if top:
        values[..., 1], slopes[..., 1] = u, 1.0
    for n in range(1, top):
        values[..., n + 1] = ((2 * n + 1) * u * values[..., n] - n * values[..., n - 1]) / (n + 1)
        slopes[..., n + 1] = slopes[..., n - 1] + (2 * n + 1) * values[..., n]
    return values, slopes


def points_of_box(count: int, k: int) -> Array:
    """Return points inside the box at which a map is checked, (c, k) in [-1, 1]."""
    return 0.999 * _points(count, k, seed=2)


def _points(count: int, k: int, seed: int) -> Array:
    """Return the first points of a Sobol sequence in [-1, 1]^k."""
    from scipy.stats import qmc  # deferred: slow to import

    size = 1 << (count - 1).bit_length()
    return np.asarray(2.0 * qmc.Sobol(k, scramble=True, seed=seed).random(size)[:count] - 1.0)
