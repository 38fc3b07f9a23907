"""Parsing of option values."""

from __future__ import annotations

from flexor.errors import InputError


def assignments(option: str, pairs: list[str], example: str) -> dict[str, str]:
    """Parse `key=value` pairs.

    Parameters
    ----------
    option : str
        Name of the option, for messages.
    pairs : list of str
        The pairs, such as `["exosuit.length=8 cm"]`.
    example : str
        A valid pair, for messages.

    Returns
    -------
    dict
        Values as text by key.

    Raises
    ------
    InputError
        If a pair has no key or no value, or a key is repeated.
    """
    result: dict[str, str] = {}
    for pair in pairs:
        key, equals, value = (part.strip() for part in pair.partition("="))
        if not (key and equals and value):
            raise InputError(f'{option} is "{pair}": give key=value, such as "{example}".')
        if key in result:
            raise InputError(f'{option} sets "{key}" twice.')
        result[key] = value
    return result


def loads(texts: list[str]) -> str | dict[str, str] | None:
    """Parse the values of `--force`.

    Parameters
    ----------
    texts : list of str
        Empty, one list of forces such as `["0:5:1"]`, or `["left=0:5:1", "right=2"]`.

    Returns
    -------
    str, dict or None
        Argument of `Model.equilibrium`.

    Raises
    ------
    InputError
        If there are several values and one does not name its input, or an input is repeated.
    """
    if not texts:
        return None
    if len(texts) == 1 and "=" not in texts[0]:
        return texts[0]
    return dict(assignments("--force", texts, "chamber=0:5:1"))


def start_state(texts: list[str]) -> str | dict[str, str] | None:
    """Read what was given to `--start` of a simulation.

    Parameters
    ----------
    texts : list of str
        Nothing, the name of one file, or coordinates such as `["ph_1=20 deg"]`.

    Returns
    -------
    str, dict or None
        As `Model.equilibrium` takes it.

    Raises
    ------
    InputError
        If there are several and one is no coordinate, or a coordinate comes twice.
    """
    if not texts:
        return None
    if len(texts) == 1 and "=" not in texts[0]:
        return texts[0]
    return dict(assignments("--start", texts, "ph_1=20 deg"))


def numbers(option: str, pairs: list[str]) -> dict[str, int | float]:
    """Parse `key=number` pairs.

    Parameters
    ----------
    option : str
        Name of the option, for messages.
    pairs : list of str
        The pairs, such as `["starts=8"]`.

    Returns
    -------
    dict
        Integers and floats by key.

    Raises
    ------
    InputError
        If a value is not a number, or a key is repeated.
    """
    result: dict[str, int | float] = {}
    for key, text in assignments(option, pairs, "starts=8").items():
        try:
            result[key] = int(text) if text.lstrip("+-").isdigit() else float(text)
        except ValueError:
            raise InputError(f'{option} has {key} = "{text}": expected a number.') from None
    return result
