"""Finding a search method by its name."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import fields
from typing import Any

from flexor.errors import InputError, unknown
from flexor.search.interface import Search
from flexor.search.pattern import PatternSearch

# One line for each method; each is a frozen dataclass whose fields are its options.
_METHODS: dict[str, Callable[..., Search]] = {
    "pattern-search": PatternSearch,
}


def names() -> tuple[str, ...]:
    """Names that `method` knows."""
    return tuple(_METHODS)


def method(name: str, **options: Any) -> Search:
    """Make a search by its name.

    Parameters
    ----------
    name : str
        For example ``"pattern-search"``.
    **options
        The method's options, for example ``starts=8``.

    Returns
    -------
    Search
        The method with these options.

    Raises
    ------
    InputError
        If the method or an option is not known (the nearest is suggested), or an option is not a
        number in its range.
    """
    plain = name.strip().casefold().replace("_", "-").replace(" ", "-")
    recipe = _METHODS.get(plain)
    if recipe is None:
        raise unknown("method", name.strip(), _METHODS)
    kinds: dict[str, Callable[..., Any]] = {
        field.name: type(field.default)
        for field in fields(recipe)  # type: ignore[arg-type]
    }
    for option, value in options.items():
        if option not in kinds:
            raise unknown(f"option of {plain}", option, kinds)
        wanted = kinds[option]
        number = isinstance(value, (int, float)) and not isinstance(value, bool)
        if wanted in (int, float) and (not number or (wanted is int and value != int(value))):
            article = "a whole number" if wanted is int else "a number"
            raise InputError(f"option {option} of {plain} must be {article}, got {value!r}.")
        options[option] = wanted(value)
    return recipe(**options)
