"""A user's own observable: one function of the path."""

from __future__ import annotations

import re
from collections.abc import Callable, Collection
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from flexor.arguments import check_callable
from flexor.arrays import Array
from flexor.errors import InputError
from flexor.model.quantity import infer_quantity
from flexor.model.results import Paths
from flexor.model.units import Dimension
from flexor.observables.observable import Observable

# By name, of this process.
OWN: dict[str, Observable] = {}
_NAME = re.compile(r"[a-z][a-z0-9]*(-[a-z0-9]+)*")


def made(
    name: str, function: Callable[[Any], ArrayLike], unit: str, text: str, taken: Collection[str]
) -> Observable:
    """Make an observable of a function and keep it by its name; see `custom`."""
    if not isinstance(name, str) or not _NAME.fullmatch(name):
        raise InputError(
            f"observable {name!r}: its name must be of small letters, digits and single hyphens, "
            'such as "pinch-span".'
        )
    if name in taken:
        raise InputError(f'observable "{name}": Flexor has one of this name; choose another.')
    check_callable(f'the function of observable "{name}"', function)
    dimension, shown = None, (1.0, "")
    if unit:
        _, found = infer_quantity(f"1 {unit}", f'observable "{name}": unit')
        dimension = Dimension(f"a value of {name}", found.si, f"10 {unit}")
        shown = (found.factor, unit)

    def values(paths: Paths) -> Array:
        return _values(name, function, paths)

    OWN[name] = Observable(name, dimension, shown, text, values, costly=True)
    return OWN[name]


def _values(name: str, function: Callable[[Any], ArrayLike], paths: Paths) -> Array:
    steps = paths.q.shape[1]
    found = np.full((len(paths), steps), np.nan)
    for i in np.flatnonzero(np.all(paths.converged & paths.stable, axis=1)).tolist():
        try:
            found[i] = np.broadcast_to(np.asarray(function(paths[i]), dtype=float), (steps,))
        except (TypeError, ValueError) as error:
            if isinstance(error, InputError):
                raise
            raise InputError(
                f'observable "{name}" must give one number for a path, or one for each of its '
                f"{steps} loads, but failed: {error}."
            ) from error
    return found
