"""The record keeps exact numbers and says clearly what is wrong with a file."""

from __future__ import annotations

import sqlite3
from dataclasses import fields, replace
from pathlib import Path

import numpy as np
import pytest

from flexor.errors import InputError
from flexor.model import Paths
from flexor.study import Record

STEPS, JOINTS, K = 6, 3, 4


def outcomes(n: int, seed: int) -> Paths:
    random = np.random.default_rng(seed)
    value = random.normal(size=n)
    value[0] = np.inf
    shown = random.normal(size=n)
    shown[0] = np.nan
    reason = np.array(["did not converge at 2 N"] + [""] * (n - 1), dtype=object)
    angles = random.normal(size=(n, STEPS, JOINTS))
    angles[0, 2:] = np.nan
    return Paths(
        value=value,
        objective_values=random.normal(size=(n, 3)),
        shown=shown,
        reason=reason,
        joint_angles=angles,
        tip_force=random.normal(size=(n, STEPS)),
        touching=random.integers(0, 42, (n, STEPS)).astype(np.int32),
        converged=random.uniform(size=(n, STEPS)) < 0.9,
        stable=random.uniform(size=(n, STEPS)) < 0.9,
        event_count=random.integers(0, 3, n),
        total_iterations=random.integers(10, 60, n),
        constraint_values=random.normal(size=(n, 2)),
        violation=np.where(np.isfinite(value), 0.0, np.inf),
    )


def designs(n: int, seed: int) -> np.ndarray:
    # Odd numbers on purpose: every bit must come back.
    return np.random.default_rng(seed).normal(size=(n, K)) * 10.0 ** np.arange(-300, 100, 100)[:K]


def test_every_bit_comes_back(tmp_path: Path) -> None:
    given = [(designs(7, s), outcomes(7, 100 + s)) for s in range(3)]
    record = Record(tmp_path / "r.sqlite", (K, STEPS, JOINTS))
    for where, found in given:
        record.append(where, found)
    record.close()

    record = Record(tmp_path / "r.sqlite")
    assert len(record) == 21
    assert record.designs().tobytes() == np.concatenate([g[0] for g in given]).tobytes()
    back = record.outcomes()
    recorded = [field for field in fields(Paths) if field.metadata["recorded"]]
    assert len(recorded) == 17
    for field in recorded:
        if getattr(back, field.name) is None:
            slopes = ("derivatives", "value_gradient", "constraint_gradients", "regularity")
            assert field.name in slopes
            continue
        wanted = np.concatenate([getattr(g[1], field.name) for g in given])
        got = getattr(back, field.name)
        assert got.dtype == wanted.dtype
        if got.dtype == object:
            assert got.tolist() == wanted.tolist()
        else:
            np.testing.assert_array_equal(got, wanted)
    known = record.known()
    for where, found in given:
        for row, value in zip(where, found.value, strict=True):
            assert known[row.tobytes()] == value
            one = record.outcomes(row)
            assert len(one) == 1
            assert one.value[0] == value
    assert len(record.outcomes(np.zeros(K))) == 0
    values = np.concatenate([g[1].value for g in given])
    best = record.best()
    assert best is not None
    assert best.tobytes() == record.designs()[np.argmin(values)].tobytes()
    assert record.failures() == {"did not converge at 2 N": 3}


def test_a_failed_design_is_no_number_in_the_file(tmp_path: Path) -> None:
    Record(tmp_path / "r.sqlite", (K, STEPS, JOINTS)).append(designs(2, 0), outcomes(2, 0))
    rows = sqlite3.connect(tmp_path / "r.sqlite").execute(
        "SELECT value IS NULL, shown IS NULL, reason, parameters FROM evaluations ORDER BY id"
    )
    (failed, unshown, reason, text), (good, _, empty, _) = rows
    assert (failed, unshown, reason) == (1, 1, "did not converge at 2 N")
    assert (good, empty) == (0, "")
    assert text == str(designs(2, 0)[0].tolist())


def test_a_batch_is_recorded_whole_or_not_at_all() -> None:
    record = Record(None, (K, STEPS, JOINTS))
    record.append(designs(3, 0), outcomes(3, 0))
    twice = np.concatenate((designs(2, 1), designs(3, 0)[:1]))
    with pytest.raises(InputError, match="cannot be used: UNIQUE constraint failed"):
        record.append(twice, outcomes(3, 1))
    assert len(record) == 3
    record.append(designs(2, 1), outcomes(2, 1))
    assert len(record) == 5


def test_others_can_read_while_it_is_written(tmp_path: Path) -> None:
    writer = Record(tmp_path / "r.sqlite", (K, STEPS, JOINTS))
    writer.append(designs(3, 0), outcomes(3, 0))
    reader = Record(tmp_path / "r.sqlite", write=False)
    assert len(reader) == 3
    writer.append(designs(4, 1), outcomes(4, 1))
    assert len(reader) == 7
    with pytest.raises(InputError, match="readonly"):
        reader.append(designs(4, 2), outcomes(4, 2))


def damaged(path: Path, kind: str) -> None:
    record = Record(path, (K, STEPS, JOINTS))
    for seed in range(30):
        record.append(designs(20, seed), outcomes(20, seed))
    record.close()
    content = bytearray(path.read_bytes())
    if kind == "noise":
        path.write_bytes(b"this is not a database at all " * 200)
    elif kind == "empty":
        path.write_bytes(b"")
    elif kind == "cut":
        path.write_bytes(content[: len(content) // 2])
    elif kind == "page":
        content[4096 * 5 : 4096 * 9] = bytes(4096 * 4)
        path.write_bytes(content)
    elif kind == "foreign":
        path.unlink()
        foreign = sqlite3.connect(path)
        foreign.execute("CREATE TABLE notes (text)")
        foreign.commit()
        foreign.close()
    elif kind == "missing":
        path.unlink()
    elif kind == "schema":
        place = content.find(b"-- order of evaluation")
        content[place] = ord("`")
        path.write_bytes(content)
    elif kind == "bit":
        # Of a design that the index still has as it was: rows are there that cannot be found.
        place = content.find(designs(20, 3)[5].astype("<f8").tobytes())
        content[place] ^= 1
        path.write_bytes(content)
    elif kind == "blob":
        inside = sqlite3.connect(path)
        inside.execute("UPDATE evaluations SET joint_angles = x'00' WHERE id = 7")
        inside.commit()
        inside.close()


@pytest.mark.parametrize(
    "kind", ["noise", "empty", "cut", "page", "foreign", "missing", "blob", "bit", "schema"]
)
def test_a_damaged_file_is_one_clear_sentence(tmp_path: Path, kind: str) -> None:
    path = tmp_path / "r.sqlite"
    damaged(path, kind)
    with pytest.raises(InputError) as refusal:
        Record(path).outcomes()
    said = str(refusal.value)
    assert said.startswith(f'the record "{path}" cannot be used: ')
    assert said.endswith(".")
    assert "\n" not in said
    assert len(said) < len(str(path)) + 300


def test_derivatives_come_back_to_the_last_bit(tmp_path: Path) -> None:
    where, found = designs(4, 1), outcomes(4, 2)
    slopes = np.random.default_rng(3).standard_normal((4, JOINTS + 1, K))
    words = np.array(["regular", "snapped", "regular", "no-equilibrium"], dtype=object)
    record = Record(tmp_path / "r.sqlite", (K, STEPS, JOINTS))
    record.append(where, found)
    assert record.derivatives(where[0]) is None
    value, bounds = slopes[:, 0] + 1.0, slopes[:, 1:3] - 1.0
    record.append_derivatives(
        where,
        replace(
            found,
            derivatives=slopes,
            value_gradient=value,
            constraint_gradients=bounds,
            regularity=words,
        ),
    )
    record.close()
    record = Record(tmp_path / "r.sqlite", write=False)
    for i, (row, slope, word) in enumerate(zip(where, slopes, words, strict=True)):
        whole, back = record.outcomes(row), record.derivatives(row)
        assert whole.value_gradient.tobytes() == value[i].tobytes()
        assert whole.constraint_gradients.tobytes() == bounds[i].tobytes()
        assert back is not None
        assert (back[0].tobytes(), back[1]) == (slope.tobytes(), word)
