"""Validation of the methods' options."""

from __future__ import annotations

from flexor.errors import InputError


def require(method: str, option: str, value: float, valid: bool, allowed: str) -> None:
    """Raise an error if an option is out of range.

    Parameters
    ----------
    method, option : str
        Names of the method and the option.
    value : float
        Value of the option.
    valid : bool
        Whether the value is allowed. Comparisons with NaN are false, so NaN is rejected.
    allowed : str
        The allowed range, for example ``"at least 1"``.

    Raises
    ------
    InputError
        If the value is not valid.
    """
    if not valid:
        raise InputError(f"option {option} of {method} must be {allowed}, got {value:g}.")
