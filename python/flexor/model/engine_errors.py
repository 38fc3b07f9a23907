"""Errors of the engine about what it is given, as errors of the input."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from flexor.errors import InputError


@contextmanager
def engine_errors() -> Iterator[None]:
    """Raise a `ValueError` of the engine, which is one sentence, as `InputError`.

    Only a call of the engine belongs in it: a `ValueError` of NumPy, or a `TypeError`, is a defect
    of the program and no error of the input.
    """
    try:
        yield
    except ValueError as error:
        raise InputError(f"{str(error).rstrip('.')}.") from None
