"""An SQLite file that survives the death of its process at any moment."""

from __future__ import annotations

import json
import sqlite3
import threading
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from flexor.errors import InputError, shortened
from flexor.store.files import check_regular

# Notes (anything JSON) that belong to a record as a whole.
_ABOUT = "CREATE TABLE about (key TEXT PRIMARY KEY, value TEXT NOT NULL) WITHOUT ROWID;"
_BESIDE = ("-wal", "-shm", "-journal")

Row = tuple[Any, ...]


class Database:
    """Rows of evaluations and notes about them, in a file or in memory.

    Each write is one transaction in SQLite's write-ahead log with ``synchronous=NORMAL``: what was
    written survives the death of the process at any moment (a power cut may cost the last
    transactions, never the file), and others may read meanwhile. Several threads may use it.
    Pickling keeps the path of a file, which is opened again for reading, or the rows in memory.

    A new one is made with the SQL ``tables``; without, one that exists is opened. A ``path`` of
    None keeps the rows in memory. Whatever is wrong with a file is an InputError.
    """

    def __init__(self, path: Path | None, tables: str | None = None, write: bool = True) -> None:
        self.path, self._tables = path, tables
        self._lock = threading.RLock()
        with self._explained():
            if path is None:
                self._sql = _connected(":memory:")
            else:
                for name in (path.name, *(f"{path.name}{end}" for end in _BESIDE)):
                    check_regular(path.with_name(name))
                mode = "ro" if not write else "rw" if tables is None else "rwc"
                self._sql = _opened(path, mode)
            if write:
                self._sql.execute("PRAGMA journal_mode=WAL")
                self._sql.execute("PRAGMA synchronous=NORMAL")
            if tables is not None:
                self._sql.executescript(_ABOUT + tables)
            elif self.one("PRAGMA integrity_check(1)") != "ok":
                raise sqlite3.DatabaseError("it is damaged")

    def rows(self, query: str, arguments: Sequence[Any] = ()) -> list[Row]:
        """Return the rows of a query."""
        with self._explained():
            return self._sql.execute(query, arguments).fetchall()

    def one(self, query: str, arguments: Sequence[Any] = ()) -> Any:
        """Return the first value of a query's first row; None if there is no row."""
        with self._explained():
            row = self._sql.execute(query, arguments).fetchone()
            return None if row is None else row[0]

    def write(self, *statements: tuple[str, Iterable[Row]]) -> None:
        """Execute statements, each for many rows, in one transaction."""
        with self._explained():
            self._sql.execute("BEGIN IMMEDIATE")
            try:
                for statement, rows in statements:
                    self._sql.executemany(statement, rows)
                self._sql.execute("COMMIT")
            except BaseException:
                if self._sql.in_transaction:
                    self._sql.execute("ROLLBACK")
                raise

    def note(self, key: str, value: Any) -> None:
        """Keep a small value (anything JSON)."""
        self.write(("REPLACE INTO about VALUES (?, ?)", [(key, json.dumps(value))]))

    def noted(self, key: str) -> Any:
        """Return what was noted, or None."""
        with self._explained():
            found = self.one("SELECT value FROM about WHERE key = ?", (key,))
            return None if found is None else json.loads(found)

    def damaged(self, why: str) -> InputError:
        """Return the error for rows that cannot be what was written."""
        where = "in memory" if self.path is None else f'"{self.path}"'
        return InputError(f"the record {where} cannot be used: {shortened(why, 200)}.")

    def close(self) -> None:
        """Close the file; the write-ahead log is merged into it."""
        self._sql.close()

    def __getstate__(self) -> dict[str, Any]:
        state: dict[str, Any] = {"path": None if self.path is None else self.path.absolute()}
        if self.path is None:
            names = [row[0] for row in self.rows("SELECT name FROM sqlite_master WHERE sql > ''")]
            state["tables"] = self._tables
            state["rows"] = {name: self.rows(f"SELECT * FROM {name}") for name in names}
        return state

    def __setstate__(self, state: dict[str, Any]) -> None:
        Database.__init__(self, state["path"], state.get("tables"), write=state["path"] is None)
        for name, rows in state.get("rows", {}).items():
            if rows:
                places = ", ".join("?" * len(rows[0]))
                self.write((f"INSERT INTO {name} VALUES ({places})", rows))

    @contextmanager
    def _explained(self) -> Iterator[None]:
        """Hold the connection, and turn what goes wrong with it into a sentence."""
        try:
            with self._lock:
                yield
        except InputError:
            raise
        except (sqlite3.Error, TypeError, ValueError, OverflowError, RecursionError) as error:
            raise self.damaged(str(error)) from error


def _connected(address: str) -> sqlite3.Connection:
    return sqlite3.connect(address, uri=True, isolation_level=None, check_same_thread=False)


def _opened(path: Path, mode: str) -> sqlite3.Connection:
    address = f"{path.absolute().as_uri()}?mode={mode}"
    connection = _connected(address)
    if mode == "ro":
        try:
            connection.execute("SELECT count(*) FROM sqlite_master")
        except sqlite3.OperationalError:
            # SQLite creates files beside one with a write-ahead log even for reading. A read-only
            # medium has no other writers, and without a log nothing is missed.
            log = path.with_name(f"{path.name}-wal")
            if not path.is_file() or (log.exists() and log.stat().st_size > 0):
                raise
            connection.close()
            connection = _connected(f"{address}&immutable=1")
    return connection
