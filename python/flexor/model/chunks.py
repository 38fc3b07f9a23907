"""How many designs are evaluated at a time, by the engine, by a study and by its executors."""

from __future__ import annotations

from collections.abc import Iterator

# Enough to keep every core busy and to outweigh what sending a chunk to a worker costs; few enough
# for a progress bar that moves, for memory, and for what an interruption loses.
SIZE = 256


def chunks(count: int) -> Iterator[slice]:
    """Split ``count`` designs into slices of at most `SIZE`; none give one empty slice."""
    for first in range(0, max(count, 1), SIZE):
        yield slice(first, min(first + SIZE, count))
