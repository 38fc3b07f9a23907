"""The record of a search: every evaluation, as it happens."""

from __future__ import annotations

import math
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from flexor.constraints import ranks
from flexor.model.results import Paths
from flexor.store import Database
from flexor.study.problem import FloatArray

# Arrays that are recorded of each design: name, type in the file and here, number of axes: of
# steps, and of joints.
_ARRAYS = (
    ("joint_angles", "<f8", "f8", 2),  # [rad]
    ("tip_force", "<f8", "f8", 1),  # [N]
    ("touching", "<i4", "i4", 1),
    ("converged", "u1", "?", 1),
    ("stable", "u1", "?", 1),
)
TABLES = f"""
CREATE TABLE evaluations (
    id INTEGER PRIMARY KEY,      -- order of evaluation
    search TEXT NOT NULL,        -- which search; empty in a study, which is one search
    time REAL NOT NULL,          -- when its batch was recorded, seconds since 1970
    design BLOB NOT NULL,        -- parameters, SI, little-endian float64: the exact design
    parameters TEXT NOT NULL,    -- the same for reading, as a JSON list
    value REAL,                  -- of the objective; NULL if the design failed
    objectives BLOB NOT NULL,    -- float64: value of each of several objectives; empty with one
    shown REAL,                  -- the objective's quantity for display; NULL if failed
    reason TEXT NOT NULL,        -- empty, or why the design failed
    events INTEGER NOT NULL,     -- snaps along the path
    iterations INTEGER NOT NULL, -- Newton iterations along the path
    {", ".join(f"{name} BLOB NOT NULL" for name, *_ in _ARRAYS)},
    derivatives BLOB,            -- float64 (joints + 1, parameters): angles, tip force; last step
    regularity TEXT,             -- what that of the value is worth; NULL without derivatives
    constraints BLOB NOT NULL,   -- float64: worst value along the path of what each bounds, SI
    violation REAL,              -- how far constraints are exceeded; NULL if the design failed
    slopes BLOB,                 -- float64 (1 + constraints, parameters): derivatives of the value
                                 -- and of what each constraint bounds; NULL without
    UNIQUE (search, design)
);
"""
_COLUMNS = (
    "value",
    "objectives",
    "shown",
    "reason",
    "events",
    "iterations",
    *(name for name, *_ in _ARRAYS),
)
_INSERT = f"INSERT INTO evaluations VALUES (NULL{', ?' * (len(_COLUMNS) + 9)})"
_DERIVATIVES = """
UPDATE evaluations SET derivatives = ?, regularity = ?, slopes = ? WHERE search = ? AND design = ?
"""


class Record:
    """Evaluations of one search, each batch in one transaction.

    Parameters
    ----------
    place : Database, Path or None
        Where they are: a database with the tables `TABLES`, which may be shared by many searches,
        a file, or in memory.
    sizes : tuple of int, optional
        Numbers of parameters, steps and joints. With a path or in memory a new record is made if
        they are given; of an existing one they are known.
    write : bool
        Whether a file may be written.
    search : str
        Which of the searches in the database; empty in a study.

    Raises
    ------
    InputError
        If the file is missing, is not the record of a study, or is damaged or can no longer be
        written; from every method.
    """

    def __init__(
        self,
        place: Database | Path | None,
        sizes: tuple[int, int, int] | None = None,
        write: bool = True,
        search: str = "",
    ) -> None:
        if isinstance(place, Database):
            self.database = place
        else:
            self.database = Database(place, None if sizes is None else TABLES, write)
            if sizes is not None:
                self.database.note("sizes", list(sizes))
        noted = self.database.noted("sizes") if sizes is None else sizes
        try:
            k, steps, joints = (int(each) for each in noted)
            if min(k, steps, joints) < 0:
                raise ValueError
        except (TypeError, ValueError, OverflowError):
            raise self.database.damaged("it is not the record of a study") from None
        self.sizes = k, steps, joints
        self.search = search

    def __len__(self) -> int:
        return int(self._rows("count(*)", order="")[0][0])

    def close(self) -> None:
        """Close the file."""
        self.database.close()

    def append(self, designs: FloatArray, outcomes: Paths) -> None:
        """Record a batch of designs (n, k) that are not in it yet, in one transaction.

        With their derivatives, if the outcomes have them.
        """
        good, now = np.isfinite(outcomes.value), time.time()
        # A NaN becomes NULL.
        value, shown = (np.where(good, each, np.nan) for each in (outcomes.value, outcomes.shown))
        others = outcomes.reason, outcomes.event_count, outcomes.total_iterations
        columns = (
            _blobs(designs, "<f8"),
            map(str, designs.tolist()),
            value.tolist(),
            _vectors(outcomes.objective_values, len(outcomes)),
            *(column.tolist() for column in (shown, *others)),
            *(_blobs(getattr(outcomes, name), kind) for name, kind, *_ in _ARRAYS),
            *_derivatives(outcomes),
            *_kept(outcomes, good),
            _gradients(outcomes),
        )
        rows = zip(*columns, strict=True)
        self.database.write((_INSERT, [(self.search, now, *row) for row in rows]))

    def append_derivatives(self, designs: FloatArray, outcomes: Paths) -> None:
        """Record the derivatives of designs (n, k) that are in it already."""
        columns = (
            *_derivatives(outcomes),
            _gradients(outcomes),
            [self.search] * len(designs),
            _blobs(designs, "<f8"),
        )
        self.database.write((_DERIVATIVES, zip(*columns, strict=True)))

    def derivatives(self, design: FloatArray) -> tuple[FloatArray, str] | None:
        """Find derivatives (j + 1, k) of a design (k,), and their regularity; None without."""
        found = self.outcomes(design)
        return None if found.derivatives is None else (found.derivatives[0], found.regularity[0])

    def known(self) -> dict[bytes, float]:
        """Rank of every design by its exact bytes; +inf for those that failed."""
        rows = self._rows("design, value, violation")
        values = self._numbers([value for _, value, _ in rows], np.inf)
        broken = self._numbers([found for *_, found in rows], np.inf)
        ordered = ranks(values, broken).tolist()
        return dict(zip((design for design, *_ in rows), ordered, strict=True))

    def designs(self) -> FloatArray:
        """Every design in the order of evaluation, (n, k)."""
        return self._decoded([row[0] for row in self._rows("design")], "<f8", self.sizes[:1])

    def outcomes(self, design: FloatArray | None = None) -> Paths:
        """Outcomes of one design (k,) with its derivatives, or of all in the order of evaluation.

        An unknown design gives outcomes of length zero.
        """
        names = (*_COLUMNS, "constraints", "violation")
        names = names if design is None else (*names, "derivatives", "regularity", "slopes")
        rows = self._rows(", ".join(names), design=design)
        columns = zip(*rows, strict=True) if rows else [()] * len(names)
        found = {name: list(column) for name, column in zip(names, columns, strict=True)}
        slopes: dict[str, Any] = {}
        if any(blob is not None for blob in found.get("derivatives", ())):
            k, _, joints = self.sizes
            slopes["derivatives"] = self._decoded(found["derivatives"], "<f8", (joints + 1, k))
            slopes["regularity"] = np.array(found["regularity"], dtype=object)
        if any(blob is not None for blob in found.get("slopes", ())):
            count = 1 + len(found["constraints"][0]) // 8
            every = self._decoded(found["slopes"], "<f8", (count, self.sizes[0]))
            slopes["value_gradient"] = every[:, 0]
            slopes["constraint_gradients"] = every[:, 1:]
        try:
            arrays: dict[str, Any] = {
                name: self._decoded(found[name], kind, self.sizes[1 : 1 + axes]).astype(here)
                for name, kind, here, axes in _ARRAYS
            }
            return Paths(
                value=self._numbers(found["value"], np.inf),
                shown=self._numbers(found["shown"], np.nan),
                reason=np.array(found["reason"], dtype=object),
                objective_values=self._vectors(found["objectives"]),
                constraint_values=self._vectors(found["constraints"]),
                violation=self._numbers(found["violation"], np.inf),
                event_count=np.array(found["events"], dtype=np.int64),
                total_iterations=np.array(found["iterations"], dtype=np.int64),
                **arrays,
                **slopes,
            )
        except (TypeError, ValueError, OverflowError) as error:
            raise self.database.damaged(str(error)) from error

    def best(self) -> FloatArray | None:
        """Best design (k,), the earliest of equals; None if none succeeded.

        If none keeps the constraints, the one that exceeds them least.
        """
        order = "ORDER BY violation, value, id LIMIT 1"
        rows = self._rows("design", "value IS NOT NULL", order=order)
        return self._decoded([rows[0][0]], "<f8", self.sizes[:1])[0] if rows else None

    def failures(self) -> dict[str, int]:
        """How many designs failed, by reason."""
        order = "GROUP BY reason ORDER BY count(*) DESC, reason"
        rows = self._rows("reason, count(*)", "value IS NULL", order=order)
        return {reason: int(count) for reason, count in rows}

    def _rows(
        self,
        columns: str,
        where: str = "1",
        design: FloatArray | None = None,
        order: str = "ORDER BY id",
    ) -> list[tuple[Any, ...]]:
        query = f"SELECT {columns} FROM evaluations WHERE search = ? AND {where}"
        if design is None:
            return self.database.rows(f"{query} {order}", (self.search,))
        key = (design + 0.0).astype("<f8").tobytes()
        return self.database.rows(f"{query} AND design = ? {order}", (self.search, key))

    def _numbers(self, column: list[Any], missing: float) -> FloatArray:
        """Values of a column, which are finite where there are any."""
        there = [value for value in column if value is not None]
        if not all(isinstance(value, (int, float)) and math.isfinite(value) for value in there):
            raise self.database.damaged("a value is not finite")
        return np.array([missing if value is None else value for value in column], dtype="f8")

    def _vectors(self, blobs: list[bytes]) -> FloatArray:
        """Values of constraints or objectives, whose number is that of the first row."""
        first = blobs[0] if blobs else b""
        size = len(first) // 8 if isinstance(first, bytes) else 0
        return self._decoded(blobs, "<f8", (size,))

    def _decoded(self, blobs: list[bytes], kind: str, shape: tuple[int, ...]) -> NDArray[Any]:
        size = np.dtype(kind).itemsize * math.prod(shape)
        if any(not isinstance(blob, bytes) or len(blob) != size for blob in blobs):
            raise self.database.damaged("a row has the wrong size")
        return np.frombuffer(b"".join(blobs), dtype=kind).reshape(len(blobs), *shape).copy()


def _blobs(array: NDArray[Any], kind: str) -> list[bytes]:
    """Bytes of each row."""
    whole = np.ascontiguousarray(array, dtype=kind).tobytes()
    size = len(whole) // max(len(array), 1)
    return [whole[i * size : (i + 1) * size] for i in range(len(array))]


def _kept(outcomes: Paths, good: NDArray[np.bool_]) -> tuple[Sequence[bytes], Sequence[float]]:
    """Return values of constraints and violation of each design; of paths without, none and 0."""
    broken = 0.0 if outcomes.violation is None else outcomes.violation
    vectors = _vectors(outcomes.constraint_values, len(outcomes))
    return vectors, np.where(good, broken, np.nan).tolist()


def _vectors(values: FloatArray | None, count: int) -> list[bytes]:
    """Return the bytes of each row, or nothing of what was not evaluated."""
    return [b""] * count if values is None else _blobs(values, "<f8")


def _gradients(outcomes: Paths) -> Sequence[bytes | None]:
    """Return the gradients of value and constraints of each design, None without."""
    if outcomes.value_gradient is None:
        return [None] * len(outcomes)
    rows = (outcomes.value_gradient[:, None], outcomes.constraint_gradients)
    return _blobs(np.concatenate(rows, axis=1), "<f8")


def _derivatives(outcomes: Paths) -> tuple[Sequence[bytes | None], Sequence[str | None]]:
    """Return derivatives and regularity of each design, None without."""
    if outcomes.derivatives is None:
        nothing = [None] * len(outcomes)
        return nothing, nothing
    return _blobs(outcomes.derivatives, "<f8"), outcomes.regularity.tolist()
