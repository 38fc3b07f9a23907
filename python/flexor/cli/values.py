"""Parsing of option values."""

from __future__ import annotations

from typing import TYPE_CHECKING

from flexor.arguments import assignments
from flexor.errors import InputError

if TYPE_CHECKING:
    from flexor.model import Model


def one_or_assignments(
    option: str, texts: list[str] | None, example: str
) -> str | dict[str, str] | None:
    """Parse an option that is one text, such as `0:5:1`, or several `key=value` pairs."""
    if not texts:
        return None
    if len(texts) == 1 and "=" not in texts[0]:
        return texts[0]
    return dict(assignments(option, texts, example))


def ranges(option: str, pairs: list[str]) -> dict[str, tuple[str, ...]]:
    """Parse `field=low:high` pairs; `field=low:high:spline 4` of a size that varies along a rod."""
    result: dict[str, tuple[str, ...]] = {}
    example = "exosuit.length=8 cm:12 cm"
    for key, text in assignments(option, pairs, example).items():
        parts = tuple(part.strip() for part in text.split(":"))
        if len(parts) not in (2, 3) or not all(parts):
            raise InputError(f'{option} has {key} = "{text}": give bounds, such as "{example}".')
        result[key] = parts
    return result


def lists(option: str, pairs: list[str]) -> dict[str, list[str]]:
    """Parse `field=value,value` pairs."""
    result: dict[str, list[str]] = {}
    example = "exosuit.material=dragon-skin-30,ecoflex-00-30"
    for key, text in assignments(option, pairs, example).items():
        values = [value.strip() for value in text.split(",")]
        if len(values) < 2 or not all(values):
            raise InputError(f'{option} has {key} = "{text}": give values, such as "{example}".')
        result[key] = values
    return result


def numbers(option: str, pairs: list[str]) -> dict[str, int | float]:
    """Parse `key=number` pairs into integers and floats."""
    result: dict[str, int | float] = {}
    for key, text in assignments(option, pairs, "starts=8").items():
        try:
            result[key] = int(text) if text.lstrip("+-").isdigit() else float(text)
        except ValueError:
            raise InputError(f'{option} has {key} = "{text}": expected a number.') from None
    return result


def load_changed(model: str, variant: str | None, changes: list[str] | None) -> Model:
    """Load a model with a variant and overrides such as `exosuit.length=8 cm`."""
    from flexor.model import load

    return load(model, variant, assignments("--set", changes or [], "exosuit.length=8 cm"))
