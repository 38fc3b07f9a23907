"""Where the commands write: results to stdout, progress and complaints to stderr."""

from __future__ import annotations

from rich.console import Console

out = Console(highlight=False)
err = Console(stderr=True, highlight=False)


def complain(sentence: str) -> None:
    """Print one sentence after `error:` to stderr, without markup or wrapping.

    Parameters
    ----------
    sentence : str
        What is wrong; line breaks become spaces.
    """
    err.print(f"error: {' '.join(sentence.split())}", markup=False, soft_wrap=True)
