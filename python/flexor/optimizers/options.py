"""Options of the methods and their ranges."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, fields
from typing import Any, ClassVar, TypeVar

from flexor.errors import InputError
from flexor.optimizers.extras import require_installed

T = TypeVar("T")


@dataclass(frozen=True)
class Range:
    """Values that an option may have."""

    # Whether a value is allowed. Comparisons with NaN are false, so NaN is rejected.
    contains: Callable[[Any], bool]
    text: str  # the range in words, for example ``"at least 1"``


FRACTION = Range(lambda value: 0.0 < value < 1.0, "between 0 and 1")


def at_least(least: int) -> Range:
    """Return the range of numbers from ``least`` to a million."""
    return Range(lambda value: least <= value <= 1_000_000, f"from {least} to 1,000,000")


def at_most(most: float) -> Range:
    """Return the range of positive numbers up to ``most``."""
    return Range(lambda value: 0.0 < value <= most, f"above 0 and at most {most:g}")


def option(default: T, allowed: Range) -> T:
    """Declare an option with its default and its range."""
    declared: T = field(default=default, metadata={"range": allowed})
    return declared


@dataclass(frozen=True)
class Options:
    """Base class of the methods: a frozen dataclass whose fields are the options."""

    name: ClassVar[str]  # on the command line
    title: ClassVar[str]  # for figures and tables
    aliases: ClassVar[tuple[str, ...]] = ()
    description: ClassVar[str]  # in one line
    packages: ClassVar[tuple[str, ...]] = ()  # whose versions decide its results, besides NumPy

    def __post_init__(self) -> None:
        """Check the options and that the method's library is installed."""
        for each in fields(self):
            if "range" in each.metadata:
                self._require(each.name, each.metadata["range"])
        require_installed(self.name)

    def _require(self, option: str, allowed: Range) -> None:
        value = getattr(self, option)
        if not allowed.contains(value):
            raise InputError(
                f"option {option} of {self.name} is {value:g}: it must be {allowed.text}."
            )
