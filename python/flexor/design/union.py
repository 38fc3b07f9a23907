"""Union of parameter sets that change different parts of the geometry."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from flexor.design.parameter_set import ParameterSet
from flexor.design.profile import Columns
from flexor.errors import InputError


def union(*sets: ParameterSet) -> ParameterSet:
    """Combine sets into one that has the parameters of all, in order.

    It is named ``"first+second+..."`` and is for the rod of the first set. At most one may change
    the length and at most one the surface; InputError otherwise, or if no set is given.
    """
    if not sets:
        raise InputError("a union of parameter sets needs at least one set.")
    name = "+".join(part.name for part in sets)
    length_column, profile, first = None, None, 0
    for part in sets:
        if part.length_column is not None:
            if length_column is not None:
                raise InputError(f"parameter set {name}: more than one set changes the length.")
            length_column = first + part.length_column
        if part.profile is not None:
            if profile is not None:
                raise InputError(f"parameter set {name}: more than one set changes the surface.")
            profile = Columns(part.profile, first, first + part.size)
        first += part.size
    return replace(
        sets[0],
        name=name,
        labels=tuple(label for part in sets for label in part.labels),
        units=tuple(unit for part in sets for unit in part.units),
        lower=np.concatenate([part.lower for part in sets]),
        upper=np.concatenate([part.upper for part in sets]),
        start=np.concatenate([part.start for part in sets]),
        length_column=length_column,
        profile=profile,
    )
