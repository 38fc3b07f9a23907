"""The record of a study: every evaluation, in SQLite, as it happens."""

from __future__ import annotations

import json
import sqlite3
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from flexor.errors import InputError, shortened
from flexor.model.results import Paths
from flexor.study.problem import FloatArray

_TABLES = """
CREATE TABLE about (key TEXT PRIMARY KEY, value TEXT NOT NULL) WITHOUT ROWID;
CREATE TABLE evaluations (
    id INTEGER PRIMARY KEY,      -- order of evaluation
    time REAL NOT NULL,          -- when its batch was recorded, seconds since 1970
    design BLOB NOT NULL UNIQUE, -- parameters, SI, little-endian float64: the exact design
    parameters TEXT NOT NULL,    -- the same for reading, as a JSON list
    value REAL,                  -- of the objective; NULL if the design failed
    shown REAL,                  -- the objective's quantity for display; NULL if failed
    reason TEXT NOT NULL,        -- empty, or why the design failed
    events INTEGER NOT NULL,     -- snaps along the path
    iterations INTEGER NOT NULL, -- Newton iterations along the path
    joint_angles BLOB NOT NULL,  -- float64 (steps, joints) [rad]
    tip_force BLOB NOT NULL,     -- float64 (steps) [N]
    touching BLOB NOT NULL,      -- int32 (steps)
    converged BLOB NOT NULL,     -- uint8 (steps)
    stable BLOB NOT NULL         -- uint8 (steps)
);
"""
# What a search with gradients records besides; a table of its own, for searches without have none.
_DERIVATIVES = """
CREATE TABLE IF NOT EXISTS derivatives (
    design BLOB PRIMARY KEY,     -- as in evaluations
    outputs BLOB NOT NULL,       -- float64 (joints + 1, parameters): angles, tip force; last step
    regularity TEXT NOT NULL     -- what they are worth
) WITHOUT ROWID;
"""
_INSERT = f"INSERT INTO evaluations VALUES (NULL{', ?' * 13})"
_INSERT_DERIVATIVES = "REPLACE INTO derivatives VALUES (?, ?, ?)"
_COLUMNS = (
    "value, shown, reason, events, iterations, joint_angles, tip_force, touching, converged, stable"
)


class Record:
    """Evaluations of one study.

    Each batch is one transaction in SQLite's write-ahead log with ``synchronous=NORMAL``: what was
    appended survives the death of the process at any moment (a power cut may cost the last
    transactions, never the file), and others may read while it is written.

    Parameters
    ----------
    path : Path or None
        The file; None keeps the record in memory.
    parameters, steps, joints : int
        Sizes of a new record, which is created if they are given.

    Raises
    ------
    InputError
        If the file is missing, is not a record, or is damaged.
    """

    def __init__(
        self, path: Path | None, sizes: tuple[int, int, int] | None = None, write: bool = True
    ) -> None:
        self._path = path
        with self._explained():
            if path is None:
                self._sql = sqlite3.connect(":memory:", isolation_level=None)
            else:
                self._sql = _connect(path, "rwc" if sizes is not None else "rw" if write else "ro")
            if write:
                self._sql.execute("PRAGMA journal_mode=WAL")
                self._sql.execute("PRAGMA synchronous=NORMAL")
            if sizes is not None:
                self._sql.executescript(_TABLES)
                self.note("sizes", list(sizes))
            elif self._one("PRAGMA integrity_check(1)") != "ok":
                raise sqlite3.DatabaseError("it is damaged")
            if (noted := self.noted("sizes")) is None:
                raise sqlite3.DatabaseError("it is not the record of a study")
            if write:
                self._sql.executescript(_DERIVATIVES)
            k, steps, joints = noted
            self._k, self._steps, self._joints = int(k), int(steps), int(joints)

    def __len__(self) -> int:
        with self._explained():
            return int(self._one("SELECT count(*) FROM evaluations"))

    def close(self) -> None:
        """Close the file; the write-ahead log is merged into it."""
        self._sql.close()

    def note(self, key: str, value: Any) -> None:
        """Keep a small value (anything JSON) with the record."""
        with self._explained():
            self._sql.execute("REPLACE INTO about VALUES (?, ?)", (key, json.dumps(value)))

    def noted(self, key: str) -> Any:
        """Return what was noted, or None."""
        with self._explained():
            found = self._one("SELECT value FROM about WHERE key = ?", (key,))
            return None if found is None else json.loads(found)

    def append(self, designs: FloatArray, outcomes: Paths) -> None:
        """Record a batch of designs (n, k) that are not in it yet, in one transaction.

        With their derivatives, if the outcomes have them.

        Raises
        ------
        InputError
            If the file can no longer be written, or a design is in it already.
        """
        failed = ~np.isfinite(outcomes.value)
        columns = (
            [time.time()] * len(designs),
            _blobs(designs, "<f8"),
            [str(design) for design in designs.tolist()],
            _numbers(outcomes.value, failed),
            _numbers(outcomes.shown, failed),
            outcomes.reason.tolist(),
            outcomes.event_count.tolist(),
            outcomes.total_iterations.tolist(),
            _blobs(outcomes.joint_angles, "<f8"),
            _blobs(outcomes.tip_force, "<f8"),
            _blobs(outcomes.touching, "<i4"),
            _blobs(outcomes.converged, "u1"),
            _blobs(outcomes.stable, "u1"),
        )
        rows = list(zip(*columns, strict=True))
        slopes = _derivatives(designs, outcomes)
        with self._explained(), self._transaction():
            self._sql.executemany(_INSERT, rows)
            self._sql.executemany(_INSERT_DERIVATIVES, slopes)

    def append_derivatives(self, designs: FloatArray, outcomes: Paths) -> None:
        """Record the derivatives of designs (n, k) that are in it already.

        Raises
        ------
        InputError
            If the file can no longer be written.
        """
        slopes = _derivatives(designs, outcomes)
        with self._explained(), self._transaction():
            self._sql.executemany(_INSERT_DERIVATIVES, slopes)

    def derivatives(self, design: FloatArray) -> tuple[FloatArray, str] | None:
        """Find derivatives (j + 1, k) of a design (k,), and their regularity; None without."""
        key = (design + 0.0).astype("<f8").tobytes()
        with self._explained():
            row = self._sql.execute(
                "SELECT outputs, regularity FROM derivatives WHERE design = ?", (key,)
            ).fetchone()
            if row is None:
                return None
            return self._decoded([row[0]], "<f8", (self._joints + 1, self._k))[0], str(row[1])

    def known(self) -> dict[bytes, float]:
        """Value of every design by its exact bytes; +inf for those that failed."""
        with self._explained():
            rows = self._sql.execute("SELECT design, value FROM evaluations ORDER BY id")
            return {design: np.inf if value is None else value for design, value in rows}

    def designs(self) -> FloatArray:
        """Every design in the order of evaluation, (n, k)."""
        with self._explained():
            rows = self._sql.execute("SELECT design FROM evaluations ORDER BY id").fetchall()
            return self._decoded([row[0] for row in rows], "<f8", (self._k,))

    def outcomes(self, design: FloatArray | None = None) -> Paths:
        """Outcomes of one design (k,), or of all in the order of evaluation.

        An unknown design gives outcomes of length zero.
        """
        where, arguments = "", tuple[bytes, ...]()
        if design is not None:
            where, arguments = "WHERE design = ?", ((design + 0.0).astype("<f8").tobytes(),)
        with self._explained():
            rows = self._sql.execute(
                f"SELECT {_COLUMNS} FROM evaluations {where} ORDER BY id", arguments
            ).fetchall()
            columns: list[list[Any]] = [list(column) for column in zip(*rows, strict=True)]
            columns = columns or [[] for _ in range(10)]
            value, shown, reason, events, iterations, angles, force, touch, conv, stable = columns
            steps = self._steps
            return Paths(
                value=np.array([np.inf if v is None else v for v in value], dtype=np.float64),
                shown=np.array([np.nan if v is None else v for v in shown], dtype=np.float64),
                reason=np.array(reason, dtype=object),
                joint_angles=self._decoded(angles, "<f8", (steps, self._joints)),
                tip_force=self._decoded(force, "<f8", (steps,)),
                touching=self._decoded(touch, "<i4", (steps,)),
                converged=self._decoded(conv, "u1", (steps,)).astype(np.bool_),
                stable=self._decoded(stable, "u1", (steps,)).astype(np.bool_),
                event_count=np.array(events, dtype=np.int64),
                total_iterations=np.array(iterations, dtype=np.int64),
            )

    def best(self) -> FloatArray | None:
        """Best design (k,), the earliest of equals; None if none succeeded."""
        with self._explained():
            found = self._one(
                "SELECT design FROM evaluations WHERE value IS NOT NULL ORDER BY value, id LIMIT 1"
            )
            return None if found is None else self._decoded([found], "<f8", (self._k,))[0]

    def failures(self) -> dict[str, int]:
        """How many designs failed, by reason."""
        with self._explained():
            rows = self._sql.execute(
                "SELECT reason, count(*) FROM evaluations WHERE value IS NULL "
                "GROUP BY reason ORDER BY count(*) DESC, reason"
            )
            return {reason: int(count) for reason, count in rows}

    def _one(self, query: str, arguments: tuple[Any, ...] = ()) -> Any:
        row = self._sql.execute(query, arguments).fetchone()
        return None if row is None else row[0]

    @contextmanager
    def _transaction(self) -> Iterator[None]:
        self._sql.execute("BEGIN IMMEDIATE")
        try:
            yield
            self._sql.execute("COMMIT")
        except BaseException:
            if self._sql.in_transaction:
                self._sql.execute("ROLLBACK")
            raise

    def _decoded(self, blobs: list[bytes], kind: str, shape: tuple[int, ...]) -> NDArray[Any]:
        array = np.frombuffer(b"".join(blobs), dtype=kind)
        if array.size != len(blobs) * int(np.prod(shape)):
            raise sqlite3.DatabaseError("a row has the wrong size")
        return array.reshape(len(blobs), *shape).copy()

    @contextmanager
    def _explained(self) -> Iterator[None]:
        try:
            yield
        except (sqlite3.Error, TypeError, ValueError) as error:
            if isinstance(error, InputError):
                raise
            where = "in memory" if self._path is None else f'"{self._path}"'
            raise InputError(
                f"the record {where} cannot be used: {shortened(str(error), 200)}."
            ) from error


def _connect(path: Path, mode: str) -> sqlite3.Connection:
    address = f"{path.absolute().as_uri()}?mode={mode}"
    connection = sqlite3.connect(address, uri=True, isolation_level=None)
    if mode == "ro":
        try:
            connection.execute("SELECT count(*) FROM sqlite_master")
        except sqlite3.OperationalError:
            # Beside a file with a write-ahead log SQLite wants to make files even for reading. On
            # a medium that cannot be written nobody writes, and without a log nothing is missed.
            log = path.with_name(f"{path.name}-wal")
            if not path.is_file() or (log.exists() and log.stat().st_size > 0):
                raise
            connection.close()
            address = f"{address}&immutable=1"
            connection = sqlite3.connect(address, uri=True, isolation_level=None)
    return connection


def _blobs(array: NDArray[Any], kind: str) -> list[bytes]:
    """Bytes of each row."""
    whole = np.ascontiguousarray(array, dtype=kind).tobytes()
    size = len(whole) // max(len(array), 1)
    return [whole[i * size : (i + 1) * size] for i in range(len(array))]


def _derivatives(designs: FloatArray, outcomes: Paths) -> list[tuple[bytes, bytes, str]]:
    """Rows of the derivatives; none if there are none."""
    if outcomes.derivatives is None:
        return []
    blobs = _blobs(designs, "<f8"), _blobs(outcomes.derivatives, "<f8")
    return list(zip(*blobs, outcomes.regularity.tolist(), strict=True))


def _numbers(values: FloatArray, failed: NDArray[np.bool_]) -> list[float | None]:
    """Values of the designs that did not fail."""
    return [None if bad else x for x, bad in zip(values.tolist(), failed.tolist(), strict=True)]
