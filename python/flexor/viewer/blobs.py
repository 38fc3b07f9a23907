"""Arrays as text, each once."""

from __future__ import annotations

import base64
import hashlib
import zlib
from collections.abc import Collection
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

_TYPES = {"f": "<f4", "u1": "u1", "u2": "<u2", "u4": "<u4"}


class Blobs:
    """A table of arrays by their content, for JSON.

    Parameters
    ----------
    known
        Keys of arrays that the reader has already and that are left out of the table.
    compressed
        Whether arrays are compressed (zlib).
    """

    def __init__(self, known: Collection[str] = (), compressed: bool = False) -> None:
        self.table: dict[str, dict[str, Any]] = {}
        self._known = known
        self._compressed = compressed

    def floats(self, values: ArrayLike) -> str:
        """Add numbers in single precision; return their key."""
        return self._add("f", np.asarray(values))

    def bytes(self, values: ArrayLike) -> str:
        """Add integers below 256; return their key."""
        return self._add("u1", np.asarray(values))

    def indices(self, values: ArrayLike) -> str:
        """Add indices; return their key."""
        given = np.asarray(values)
        return self._add("u2" if given.max(initial=0) < 65536 else "u4", given)

    def _add(self, kind: str, values: NDArray[Any]) -> str:
        raw = np.ascontiguousarray(values, dtype=_TYPES[kind]).tobytes()
        key = hashlib.blake2b(raw, digest_size=9, person=kind.encode()).hexdigest()
        if key not in self.table and key not in self._known:
            coded = zlib.compress(raw, 9) if self._compressed else raw
            self.table[key] = {
                "type": kind,
                "size": int(values.size),
                "data": base64.b64encode(coded).decode(),
                **({"zlib": True} if self._compressed else {}),
            }
        return key
