"""The same map for another model, which differs from a known one in values."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from flexor.arrays import Array
from flexor.design.box_points import sobol_points
from flexor.design.fitting import TOLERANCE, fitted
from flexor.design.lowered import Lowered
from flexor.design.slot_map import Fit, SlotMap
from flexor.design.slot_search import CHECKS, noise_of
from flexor.model.structure import Structure


def refitted(
    like: SlotMap, known: Structure, model: Structure, fields: Sequence[tuple[str, ...]]
) -> SlotMap | None:
    """Return the same map for another model that differs from the known one in values.

    Parameters that differ by a constant take one file; the ends of straps, which the fields and the
    other values decide together, take a few places; all others a few files. None if the parameters
    of the model are other polynomials.
    """
    mine, theirs = Lowered(model, tuple(fields)), Lowered(known, tuple(fields))
    most = max(len(fit.powers) for fit in like.fits)
    u = 0.999 * sobol_points(most + CHECKS, len(fields), seed=1)
    points = like.middle + like.half * u
    probes = points[-2:]
    found, before = np.array([mine.at(x) for x in probes]), _probed(like, theirs, probes)
    size = found.shape[1]
    if before.shape[1] != size or mine.ranges != theirs.ranges:
        return None
    scale = np.maximum(np.abs(found), np.abs(before)).max(axis=0)
    noise = 1e4 * noise_of(mine, scale)
    shift = found - before
    apart = np.abs(shift[0] - shift[1]) > np.maximum(TOLERANCE * scale, noise)
    others = np.setdiff1d(np.arange(size), like.every)
    if apart[others].any():
        return None
    if (np.flatnonzero(apart) >= mine.size).all():
        samples = np.zeros((len(points), size))
        samples[:, mine.size :] = [mine.of_straps(x) for x in points]
    else:
        samples = np.array([mine.at(x) for x in points])
    fits = []
    of_quotients = {column for pair in like.quotients for column in pair}
    for fit in like.fits:
        if of_quotients.intersection(fit.columns.tolist()):
            own = like.every[fit.columns[fit.columns < len(like.every)]]
            if apart[own].any() or shift[0, own].any():
                return None
            fits.append(fit)
            continue
        columns = like.every[fit.columns]
        new = apart[columns]
        if new.any():
            coefficients, good = fitted(u, samples[:, columns[new]], fit.powers, fit.form, most)
            if not (good | (scale[columns[new]] <= noise[columns[new]])).all():
                return None
            fits.append(Fit(fit.columns[new], fit.powers, coefficients, fit.form))
        if not new.all():
            same = columns[~new]
            if fit.form != "polynomial" and (shift[0, same] != 0.0).any():
                return None
            fits.append(_shifted(fit, ~new, shift[0, same]))
    return replace(like, fits=tuple(fits))


# By map: the parameters of the model that it is of, and those at its probes.
_PROBED: WeakKeyDictionary[SlotMap, tuple[Array, Array]] = WeakKeyDictionary()


def _probed(like: SlotMap, known: Lowered, probes: Array) -> Array:
    """Return the parameters of a known model, which many others are compared with."""
    own, found = _PROBED.get(like, (None, np.zeros(0)))
    if own is not known.own:
        found = np.array([known.at(x) for x in probes])
        _PROBED[like] = known.own, found
    return found


def _shifted(fit: Fit, chosen: NDArray[np.bool_], shift: Array) -> Fit:
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
    return Fit(fit.columns[chosen], powers, coefficients, fit.form)
