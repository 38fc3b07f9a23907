"""Tolerances: errors of fields of a model file, as distributions."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from flexor.arrays import Array
from flexor.errors import InputError, unknown_name

KINDS = ("uniform", "normal")
# A normal error is taken to be within so many standard deviations where it must not matter.
REACH = 2.0
_NUMBER = re.compile(r"[-+]?[0-9.]+(?:[eE][-+]?[0-9]+)?")


@dataclass(frozen=True)
class Tolerance:
    """The error of one field; made by `flexor.scenarios.tolerances`.

    Attributes
    ----------
    field : str
        The field, or the label of a parameter, as it was given.
    kind : str
        ``"uniform"`` within ± ``size``, or ``"normal"`` with the standard deviation ``size``.
    size : float
        SI.
    text : str
        As it was written, such as ``"0.1 mm"``.
    """

    field: str
    kind: str
    size: float
    text: str

    @property
    def reach(self) -> float:
        """The largest error for which constraints have to hold, SI."""
        return self.size if self.kind == "uniform" else REACH * self.size

    @property
    def largest(self) -> str:
        """That in words, in the unit that was given, such as ``"1 mm (2 deviations)"``."""
        stated, kind = split(self.text, self.field)
        if kind == "uniform":
            return str(stated)
        found = _NUMBER.match(str(stated))
        assert found is not None  # as it was read
        unit = str(stated)[found.end() :].strip()
        return f"{REACH * float(found[0]):.6g} {unit}".rstrip() + f" ({REACH:g} deviations)"


def split(text: object, place: str) -> tuple[object, str]:
    """Split a tolerance into its size and its distribution, uniform unless given.

    InputError, beginning with ``place``, if there is no such distribution.
    """
    if not isinstance(text, str):
        return text, "uniform"
    size, _, last = text.strip().rpartition(" ")
    last = last.strip()
    if last in KINDS and size:
        return size.strip(), last
    # Units begin with a letter too; a distribution comes after one.
    if size and " " in size.strip() and last.isalpha():
        raise InputError(f"{place}: {unknown_name('distribution', last, KINDS)}.")
    return text.strip(), "uniform"


def samples(tolerances: Sequence[Tolerance], count: int, seed: int) -> Array:
    """Return errors of a scrambled Sobol sequence, (count, m), SI, the same for the same seed."""
    from scipy.special import ndtri
    from scipy.stats import qmc  # deferred: slow to import

    if not tolerances or not count:
        return np.zeros((count, len(tolerances)))
    size = 1 << max(count - 1, 0).bit_length()
    unit = qmc.Sobol(len(tolerances), scramble=True, seed=seed).random(size)[:count]
    # Off the ends, where a normal error would be infinite.
    inside = np.clip(unit, 2.0**-33, 1.0 - 2.0**-33)
    columns = [
        each.size * (2.0 * unit[:, i] - 1.0 if each.kind == "uniform" else ndtri(inside[:, i]))
        for i, each in enumerate(tolerances)
    ]
    return np.stack(columns, axis=1)


def within(tolerances: Sequence[Tolerance], count: int, seed: int) -> Array:
    """Return errors spread evenly over the box for which constraints have to hold, (count, m)."""
    uniform = [Tolerance(each.field, "uniform", each.reach, "") for each in tolerances]
    return samples(uniform, count, seed)
