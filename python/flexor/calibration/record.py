"""The record of a calibration: everything that was evaluated, as it happens."""

from __future__ import annotations

import threading
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from flexor.store import Database, Header, Kind

Array = NDArray[np.float64]
Key = tuple[int, int, bool, bytes]  # variant, run, haste, constants

TARGETS = "targets.toml"
_TABLES = """
CREATE TABLE evaluations (
    variant INTEGER NOT NULL,   -- which combination of options
    run INTEGER NOT NULL,       -- which path or optimum
    haste INTEGER NOT NULL,     -- 1 in the global search, which gives up early
    constants BLOB NOT NULL,    -- float64, SI, in the order of the targets file
    observed BLOB NOT NULL,     -- float64, SI; NaN where the path failed
    UNIQUE (variant, run, haste, constants)
);
"""
_COLUMNS = "variant, run, haste, constants, observed"


class _Shape(Header):
    targets: str
    models: Any
    options: Any
    seed: int
    samples: list[int]
    starts: int


CALIBRATION = Kind(
    name="calibration",
    schema=_Shape,
    tables=_TABLES,
    hashed={"targets": "other targets", "models": "other models"},
)


class Record:
    """Observed values by variant, run and the exact bytes of the constants.

    A calibration that is simply run again finds its way to where it was interrupted without
    evaluating anything twice.

    Parameters
    ----------
    database : Database, optional
        Where they are; in memory by default.

    Attributes
    ----------
    evaluated, replayed : int
        Evaluations made now, and answered from what an earlier process had recorded.

    Raises
    ------
    InputError
        If it is damaged.
    """

    def __init__(self, database: Database | None = None) -> None:
        self._database = database or Database(None, _TABLES)
        self._lock = threading.Lock()
        self.evaluated = self.replayed = 0
        rows = self._database.rows(f"SELECT {_COLUMNS} FROM evaluations ORDER BY rowid")
        try:
            self._known: dict[Key, Array] = {
                (variant, run, bool(haste), constants): np.frombuffer(observed, dtype="<f8")
                for variant, run, haste, constants, observed in rows
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
        """Return the first evaluation that is no optimum or haste, to see if it still holds."""
        return next((item for item in self._known.items() if not item[0][2]), None)

    def add(self, keys: Sequence[Key], observed: Array) -> None:
        """Record a batch, observed (n, m) for n keys, in one transaction.

        Raises
        ------
        InputError
            If the file can no longer be written.
        """
        rows = [
            (*key, np.ascontiguousarray(values, dtype="<f8").tobytes())
            for key, values in zip(keys, observed, strict=True)
        ]
        with self._lock:
            self._database.write(("INSERT OR IGNORE INTO evaluations VALUES (?,?,?,?,?)", rows))
            self._known.update(zip(keys, observed, strict=True))
            self.evaluated += len(rows)
