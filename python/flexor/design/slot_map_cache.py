"""Maps from fields to the engine's parameters that were found before, in this process.

Rounds of a search, its resumption and its repetition ask what was asked before, of models that
were loaded anew.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable
from threading import Lock
from typing import TypeVar

_MOST = 32

Found = TypeVar("Found")
_known: dict[Hashable, object] = {}
_lock = Lock()


def cached(question: Hashable, find: Callable[[], Found]) -> Found:
    """Return the answer to a question, found now if it is not among those of late.

    Parameters
    ----------
    question
        Everything that the answer depends on.
    find
        Finds it; what it raises is not remembered.
    """
    with _lock:
        found = _known.pop(question, None)
    if found is None:
        found = find()
    with _lock:
        _known[question] = found
        while len(_known) > _MOST:
            del _known[next(iter(_known))]
    return found  # type: ignore[return-value]
