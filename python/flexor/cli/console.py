"""Output streams of the commands: results to stdout, progress and errors to stderr."""

from __future__ import annotations

from rich.console import Console

out = Console(highlight=False)
err = Console(stderr=True, highlight=False)


def print_error(sentence: str) -> None:
    """Print an error message to stderr, without markup or wrapping.

    Parameters
    ----------
    sentence : str
        The message; line breaks become spaces.
    """
    err.print(f"error: {' '.join(sentence.split())}", markup=False, soft_wrap=True)
