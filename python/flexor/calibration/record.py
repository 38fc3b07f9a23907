"""Everything that a calibration has evaluated, kept in SQLite as it happens."""

from __future__ import annotations

import sqlite3
import threading
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from flexor.errors import InputError

Array = NDArray[np.float64]
Key = tuple[int, int, bool, bytes]  # variant, run, haste, constants

_TABLE = """
CREATE TABLE IF NOT EXISTS evaluations (
    variant INTEGER NOT NULL,   -- which combination of options
    run INTEGER NOT NULL,       -- which path or optimum
    haste INTEGER NOT NULL,     -- 1 in the global search, which gives up early
    constants BLOB NOT NULL,    -- float64, SI, in the order of the targets file
    observed BLOB NOT NULL,     -- float64, SI; NaN where the path failed
    UNIQUE (variant, run, haste, constants)
);
"""


class Record:
    """Observed values by variant, run and the exact bytes of the constants.

    A calibration that is simply run again finds its way to where it was interrupted without
    evaluating anything twice. Each batch is one transaction in SQLite's write-ahead log, so what
    was recorded survives the death of the process.

    Parameters
    ----------
    path : Path or None
        The file, made if it is missing; None keeps the record in memory.

    Attributes
    ----------
    evaluated, replayed : int
        Evaluations made now, and answered from what an earlier process had recorded.

    Raises
    ------
    InputError
        If the file is not a record or cannot be written.
    """

    def __init__(self, path: Path | None) -> None:
        self._path, self._lock = path, threading.Lock()
        self.evaluated = self.replayed = 0
        with self._explained():
            name = ":memory:" if path is None else str(path)
            self._sql = sqlite3.connect(name, isolation_level=None, check_same_thread=False)
            self._sql.execute("PRAGMA journal_mode=WAL")
            self._sql.execute("PRAGMA synchronous=NORMAL")
            self._sql.executescript(_TABLE)
            rows = self._sql.execute("SELECT * FROM evaluations ORDER BY rowid")
            self._known: dict[Key, Array] = {
                (variant, run, bool(haste), constants): np.frombuffer(observed, dtype="<f8")
                for variant, run, haste, constants, observed in rows
            }
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
        """Return the first evaluation that is no optimum or haste, to see if it still holds."""
        return next((item for item in self._known.items() if not item[0][2]), None)

    def add(self, keys: Sequence[Key], observed: Array) -> None:
        """Record a batch: observed (n, m) for n keys.

        Raises
        ------
        InputError
            If the file can no longer be written.
        """
        rows = [
            (*key, np.ascontiguousarray(values, dtype="<f8").tobytes())
            for key, values in zip(keys, observed, strict=True)
        ]
        with self._lock, self._explained():
            self._sql.execute("BEGIN IMMEDIATE")
            try:
                self._sql.executemany("INSERT OR IGNORE INTO evaluations VALUES (?,?,?,?,?)", rows)
            except BaseException:
                if self._sql.in_transaction:
                    self._sql.execute("ROLLBACK")
                raise
            self._sql.execute("COMMIT")
            self._known.update(zip(keys, observed, strict=True))
            self.evaluated += len(rows)

    def close(self) -> None:
        """Close the file; the write-ahead log is merged into it."""
        self._sql.close()

    @contextmanager
    def _explained(self) -> Iterator[None]:
        try:
            yield
        except (sqlite3.Error, TypeError, ValueError) as error:
            where = "in memory" if self._path is None else f'"{self._path}"'
            raise InputError(f"the record {where} cannot be used: {error}.") from error
