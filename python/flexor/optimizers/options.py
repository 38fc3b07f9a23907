"""Refusing options of a method that are out of their range."""

from __future__ import annotations

from flexor.errors import InputError


def require(method: str, option: str, value: float, inside: bool, allowed: str) -> None:
    """Refuse an option that is out of its range.

    Parameters
    ----------
    method, option : str
        Whose and which.
    value : float
        What was found.
    inside : bool
        Whether it is allowed; a NaN makes every comparison false and so is refused.
    allowed : str
        What would have been, for example ``"at least 1"``.

    Raises
    ------
    InputError
        If it is not inside.
    """
    if not inside:
        raise InputError(f"option {option} of {method} must be {allowed}, got {value:g}.")
