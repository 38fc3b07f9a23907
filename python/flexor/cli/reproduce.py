"""`flexor reproduce` says where the published study went."""

from __future__ import annotations

import typer

from flexor.errors import InputError

# Whatever it was given.
ANYTHING = {"allow_extra_args": True, "ignore_unknown_options": True}


def reproduce(_: typer.Context) -> int:
    """Say where the published study went."""
    raise InputError(
        "flexor reproduce is now `./dev reproduce`, in a clone of the repository of Flexor."
    )
