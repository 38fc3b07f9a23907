"""Values as people type them on the command line."""

from __future__ import annotations

from flexor.errors import InputError


def assignments(option: str, pairs: list[str], example: str) -> dict[str, str]:
    """Read `key=value` pairs.

    Parameters
    ----------
    option : str
        Which option they were given to, for messages.
    pairs : list of str
        What was given, such as `["exosuit.length=8 cm"]`.
    example : str
        A pair that would be right, for messages.

    Returns
    -------
    dict
        Value as text by key.

    Raises
    ------
    InputError
        If one has no key or no value, or a key comes twice.
    """
    found: dict[str, str] = {}
    for pair in pairs:
        key, equals, value = (part.strip() for part in pair.partition("="))
        if not (key and equals and value):
            raise InputError(f'{option} is "{pair}": give key=value, such as "{example}".')
        if key in found:
            raise InputError(f'{option} gives "{key}" twice: once is allowed.')
        found[key] = value
    return found


def loads(texts: list[str]) -> str | dict[str, str] | None:
    """Read what was given to `--force`.

    Parameters
    ----------
    texts : list of str
        Nothing, one list of forces such as `["0:5:1"]`, or `["left=0:5:1", "right=2"]`.

    Returns
    -------
    str, dict or None
        As `Model.equilibrium` takes it.

    Raises
    ------
    InputError
        If there are several and one does not say its input, or an input comes twice.
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
    """Read `key=number` pairs.

    Parameters
    ----------
    option : str
        Which option they were given to, for messages.
    pairs : list of str
        What was given, such as `["starts=8"]`.

    Returns
    -------
    dict
        Whole or other number by key.

    Raises
    ------
    InputError
        If one is not a key with a number, or a key comes twice.
    """
    found: dict[str, int | float] = {}
    for key, text in assignments(option, pairs, "starts=8").items():
        try:
            found[key] = int(text) if text.lstrip("+-").isdigit() else float(text)
        except ValueError:
            raise InputError(f'{option} has {key} = "{text}": a number is needed.') from None
    return found
