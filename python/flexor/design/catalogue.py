"""Registry of parameter sets, with the published ones (Table II of the paper)."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from flexor.design.parameter_set import ParameterSet
from flexor.design.profile import Clamped
from flexor.design.published import CENTIMETRE, Legendre, Linear, SineCosine
from flexor.design.union import union
from flexor.errors import InputError, unknown_name
from flexor.model.geometry import PAPER, DesignSpace

Factory = Callable[[DesignSpace], ParameterSet]


def length_set(space: DesignSpace = PAPER) -> ParameterSet:
    """Return set L: the length [m], starting at the rod's own."""
    low, high = space.length_bounds
    return ParameterSet(
        name="L",
        labels=("L",),
        units=("cm",),
        lower=np.array([low]),
        upper=np.array([high]),
        start=np.array([space.length]),
        length_column=0,
        rod=space,
    )


def linear_set(space: DesignSpace = PAPER) -> ParameterSet:
    """Return set R01: base and tip radius [m] (10), starting at the rod's own."""
    low, high = space.radius_bounds
    return ParameterSet(
        name="R01",
        labels=("R_0", "R_1"),
        units=("cm", "cm"),
        lower=np.array([low, low]),
        upper=np.array([high, high]),
        start=np.array([space.radius_base, space.radius_tip]),
        profile=Linear(),
        rod=space,
    )


def sine_cosine_set(space: DesignSpace = PAPER) -> ParameterSet:
    """Return set Rsc: frequencies A, B and phases phi_A, phi_B [rad] (11).

    The paper states neither bounds nor a start. Here the frequencies range from -4 to 4 (two full
    waves; the published optimum is A = -2, B = -0.5) and the phases over a full turn. With its
    amplitude of R_0/20 the set cannot reproduce the taper of Table I. The start decreases
    monotonically from the base radius R_0 to 0.9 R_0 at the tip, the closest the set gets to it.
    """
    return ParameterSet(
        name="Rsc",
        labels=("A", "B", "phi_A", "phi_B"),
        units=("1", "1", "rad", "rad"),
        lower=np.array([-4.0, -4.0, -np.pi, -np.pi]),
        upper=np.array([4.0, 4.0, np.pi, np.pi]),
        start=np.array([-0.5, 0.5, 0.0, np.pi / 2.0]),
        profile=Clamped(SineCosine(space.radius_base), space.minimum_radius),
        rod=space,
    )


def legendre_set(space: DesignSpace = PAPER) -> ParameterSet:
    """Return set RLP: ten Legendre coefficients a_0 ... a_9 (12).

    The paper states no bounds; five coefficients of its optimum are exactly 1. Here a_0 ranges
    from 0 to 1 (a constant part of 0 to 2 cm; negative values clamp the whole surface to the
    minimum radius) and the others from -1 to 1, which includes the published optimum and Table I.
    The start is the rod's own linear taper, a_0 = R_0/2 and a_1 = 3 (R_1 - R_0)/2 in cm.
    """
    count = 10
    lower, start = np.full(count, -1.0), np.zeros(count)
    lower[0] = 0.0
    start[0] = space.radius_base / (2.0 * CENTIMETRE)
    start[1] = 3.0 * (space.radius_tip - space.radius_base) / (2.0 * CENTIMETRE)
    return ParameterSet(
        name="RLP",
        labels=tuple(f"a_{n}" for n in range(count)),
        units=("1",) * count,
        lower=lower,
        upper=np.ones(count),
        start=start,
        profile=Clamped(Legendre(count), space.minimum_radius),
        rod=space,
    )


_FACTORIES: dict[str, Factory] = {
    "L": length_set,
    "R01": linear_set,
    "Rsc": sine_cosine_set,
    "RLP": legendre_set,
}


def names() -> tuple[str, ...]:
    """Return the names of the sets; they can be combined with ``+``."""
    return tuple(_FACTORIES)


def register(name: str, factory: Factory) -> None:
    """Register a set under a name, so that expressions such as ``"L+mine"`` can refer to it.

    Parameters
    ----------
    name : str
        Letters, digits and underscores.
    factory : callable
        Maps the model's design space to the set.

    Raises
    ------
    InputError
        If the name is taken or contains other characters.
    """
    if not name.replace("_", "").isalnum():
        raise InputError(f"parameter set name {name!r}: letters, digits and underscores only.")
    if _normalized(name) in {_normalized(existing) for existing in _FACTORIES}:
        raise InputError(f"a parameter set named {name!r} already exists.")
    _FACTORIES[name] = factory


def parameter_set(
    text: str | ParameterSet | Sequence[str | ParameterSet], space: DesignSpace = PAPER
) -> ParameterSet:
    """Look up a parameter set by name; a `ParameterSet` is returned unchanged.

    Parameters
    ----------
    text : str, ParameterSet or sequence of these
        One name or several joined with ``+``, for example ``"L+R01"``; a list is joined. Case,
        underscores and commas are ignored (``"R_LP"``, ``"R0,1"``).
    space : DesignSpace
        The exosuit and the bounds of the search, usually ``model.design``.

    Returns
    -------
    ParameterSet
        The set, or the union of the sets.

    Raises
    ------
    InputError
        If a name is unknown (the closest match is suggested), two sets change the same geometry,
        or the argument is neither a name nor a set.
    """
    if isinstance(text, ParameterSet):
        return text
    if isinstance(text, (list, tuple)) and text:
        sets = [parameter_set(each, space) for each in text]
        return sets[0] if len(sets) == 1 else union(*sets)
    if not isinstance(text, str):
        raise InputError(f'parameter set is {text!r}: expected a name such as "L+R01" or a set.')
    factories = {_normalized(name): factory for name, factory in _FACTORIES.items()}
    parts = []
    for word in text.split("+"):
        factory = factories.get(_normalized(word))
        if factory is None:
            raise InputError(
                unknown_name("parameter set", word.strip(), names())
                + ', alone or combined as in "L+R01".'
            )
        parts.append(factory(space))
    return parts[0] if len(parts) == 1 else union(*parts)


def _normalized(name: str) -> str:
    return "".join(character for character in name if character not in "_, ").casefold()
