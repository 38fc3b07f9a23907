"""The record of a calibration: every evaluation, written at once."""

from __future__ import annotations

import threading
from collections.abc import Sequence
from typing import Any

import numpy as np

from flexor.arrays import Array
from flexor.store import Database, Header, Kind

Key = tuple[int, bool, bytes]  # run, screening, constants

TARGETS = "targets.toml"
_TABLES = """
CREATE TABLE evaluations (
    run INTEGER NOT NULL,       -- which path or optimum
    screening INTEGER NOT NULL, -- 1 in the global search, which gives up early
    constants BLOB NOT NULL,    -- float64, SI, in the order of the targets file
    observed BLOB NOT NULL,     -- float64, SI; NaN where the path failed
    UNIQUE (run, screening, constants)
);
"""
_COLUMNS = "run, screening, constants, observed"


class _Shape(Header):
    targets: str
    models: Any
    seed: int
    samples: int
    starts: int


CALIBRATION = Kind(
    name="calibration",
    schema=_Shape,
    tables=_TABLES,
    hashed={"targets": "other targets", "models": "other models"},
)


class Record:
    """Observed values by run and the exact bytes of the constants.

    An interrupted calibration is resumed by running it again, with recorded evaluations taken from
    here: `evaluated` counts new evaluations, `replayed` those recorded by an earlier process.
    """

    def __init__(self, database: Database | None = None) -> None:
        self._database = database or Database(None, _TABLES)
        self._lock = threading.Lock()
        self.evaluated = self.replayed = 0
        rows = self._database.rows(f"SELECT {_COLUMNS} FROM evaluations ORDER BY rowid")
        try:
            self._known: dict[Key, Array] = {
                (run, bool(screening), constants): np.frombuffer(observed, dtype="<f8")
                for run, screening, constants, observed in rows
            }
        except (TypeError, ValueError) as error:
            raise self._database.damaged(str(error)) from error
        self._earlier = set(self._known)

    def __len__(self) -> int:
        return len(self._known)

    def get(self, key: Key) -> Array | None:
        """Return what was observed, or None."""
        with self._lock:
            if key in self._earlier:
                self._earlier.discard(key)
                self.replayed += 1
            return self._known.get(key)

    def first(self) -> tuple[Key, Array] | None:
        """Return the first evaluation outside the global search, to check that it still holds."""
        return next((item for item in self._known.items() if not item[0][1]), None)

    def add(self, keys: Sequence[Key], observed: Array) -> None:
        """Record a batch, observed (n, m) for n keys, in one transaction."""
        rows = [
            (*key, np.ascontiguousarray(values, dtype="<f8").tobytes())
            for key, values in zip(keys, observed, strict=True)
        ]
        with self._lock:
            self._database.write(("INSERT OR IGNORE INTO evaluations VALUES (?,?,?,?)", rows))
            self._known.update(zip(keys, observed, strict=True))
            self.evaluated += len(rows)
