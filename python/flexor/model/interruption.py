"""Termination of the work of other threads when this one is interrupted."""

from __future__ import annotations

from collections.abc import Collection
from concurrent.futures import Future, wait
from typing import Any

from flexor._engine import cancel

# A thread may be about to begin a solve when solves are cancelled: repeat after this time [s].
_AGAIN = 0.05


def cancel_solves(futures: Collection[Future[Any]]) -> None:
    """Cancel pending futures, end all running solves (they raise KeyboardInterrupt), and wait.

    The futures are work of threads of this process, which stops by itself between solves.
    """
    for future in futures:
        future.cancel()
    while wait(futures, _AGAIN).not_done:
        cancel()
