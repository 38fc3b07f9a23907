"""The published parameter sets (Table II of the paper), and finding a set by its name."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from flexor.design.legendre import CENTIMETRE, Legendre
from flexor.design.linear import Linear
from flexor.design.parameter_set import ParameterSet
from flexor.design.profile import Clamped
from flexor.design.sine_cosine import SineCosine
from flexor.design.space import PAPER, Space
from flexor.design.union import union
from flexor.errors import InputError, unknown_name

Recipe = Callable[[Space], ParameterSet]


def length_set(space: Space = PAPER) -> ParameterSet:
    """Set L: the length [m], within the space's bounds, from the rod's own."""
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


def linear_set(space: Space = PAPER) -> ParameterSet:
    """Set R01: base and tip radius [m] (10), within the space's bounds, from the rod's own."""
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


def sine_cosine_set(space: Space = PAPER) -> ParameterSet:
    """Set Rsc: frequencies A, B and phases phi_A, phi_B [rad] (11).

    The paper gives neither bounds nor start. Frequencies run over -4 to 4 (two full waves; the
    published optimum is A = -2, B = -0.5), phases over a full turn. The set cannot reproduce the
    taper of Table I: its amplitude is R_0/20. The start keeps the base radius R_0 and falls
    steadily to 0.9 R_0 at the tip, the longest way towards Table I that the set can go.
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


def legendre_set(space: Space = PAPER) -> ParameterSet:
    """Set RLP: ten Legendre coefficients a_0 ... a_9 (12).

    The paper gives no bounds; its optimum has five coefficients at exactly 1. Here a_0 runs over
    0 to 1 (the constant part 0 to 2 cm; below it the whole surface would be at the minimum radius)
    and the others over -1 to 1, which holds the published optimum and Table I. The start is the
    rod's own straight surface, a_0 = R_0/2 and a_1 = 3 (R_1 - R_0)/2 in cm.
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


_RECIPES: dict[str, Recipe] = {
    "L": length_set,
    "R01": linear_set,
    "Rsc": sine_cosine_set,
    "RLP": legendre_set,
}


def names() -> tuple[str, ...]:
    """Names that `parameter_set` knows; any of them may be joined with ``+``."""
    return tuple(_RECIPES)


def register(name: str, recipe: Recipe) -> None:
    """Make a set known by name, so that texts such as ``"L+mine"`` find it.

    Parameters
    ----------
    name : str
        Letters, digits and underscores.
    recipe : callable
        From the model's design space to the set.

    Raises
    ------
    InputError
        If the name is taken or contains other signs.
    """
    if not name.replace("_", "").isalnum():
        raise InputError(f"parameter set name {name!r}: letters, digits and underscores only.")
    if _plain(name) in {_plain(known) for known in _RECIPES}:
        raise InputError(f"a parameter set named {name!r} exists already.")
    _RECIPES[name] = recipe


def parameter_set(text: str | ParameterSet, space: Space = PAPER) -> ParameterSet:
    """Find a parameter set by its name; one that is ready is returned.

    Parameters
    ----------
    text : str or ParameterSet
        One name or several joined with ``+``, for example ``"L+R01"``; capitals, underscores and
        commas within a name do not matter (``"R_LP"``, ``"R0,1"``).
    space : Space
        The exosuit and the bounds of the search, usually ``model.design``.

    Returns
    -------
    ParameterSet
        The set, or the union of the sets.

    Raises
    ------
    InputError
        If a name is not known (the nearest is suggested), two sets change the same thing, or
        neither a name nor a set is given.
    """
    if isinstance(text, ParameterSet):
        return text
    if not isinstance(text, str):
        raise InputError(f'parameter set is {text!r}: a name such as "L+R01" or a set is needed.')
    found = {_plain(name): recipe for name, recipe in _RECIPES.items()}
    parts = []
    for word in text.split("+"):
        recipe = found.get(_plain(word))
        if recipe is None:
            raise InputError(
                unknown_name("parameter set", word.strip(), names())
                + ', alone or joined as in "L+R01".'
            )
        parts.append(recipe(space))
    return parts[0] if len(parts) == 1 else union(*parts)


def _plain(name: str) -> str:
    return "".join(sign for sign in name if sign not in "_, ").casefold()
