"""Full disks, folders that cannot be written, cut logs, clocks: nothing recorded is lost."""

from __future__ import annotations

import errno
import os
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest

from flexor.errors import InputError
from flexor.store import Lock
from flexor.study import Record, Study, optimize, rerun, resume

OPTIONS: dict[str, Any] = {"seed": 3, "method_options": {"starts": 4, "tolerance": 1e-3}}
POSIX = pytest.mark.skipif(sys.platform == "win32", reason="limits and users of POSIX")


def bits(study: Study) -> tuple[bytes, bytes, bytes]:
    outcomes = study.record.outcomes()
    return (
        study.record.designs().tobytes(),
        outcomes.value.tobytes(),
        outcomes.joint_angles.tobytes(),
    )


# No file may grow beyond so many bytes: what a full disk does, without filling one.
LIMITED = """
import resource, sys
resource.setrlimit(resource.RLIMIT_FSIZE, (int(sys.argv[1]), int(sys.argv[1])))
from flexor.cli.app import main
main(sys.argv[2:])
"""


def limited(place: Path, size: int, *arguments: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-c", LIMITED, str(size), *arguments],
        cwd=place,
        capture_output=True,
        text=True,
        env={**os.environ, "COLUMNS": "300"},
    )


@POSIX
def test_a_full_disk_ends_with_a_sentence_and_the_study_goes_on_when_there_is_room(
    tmp_path: Path,
) -> None:
    study = ("optimize", "finger", "-p", "R01", "--budget", "120", "--json", "--out")
    full = limited(tmp_path, 60_000, *study, "s")
    assert full.returncode == 2
    assert full.stderr.startswith('error: the record "s/record.sqlite" cannot be used: ')
    assert full.stderr.count("\n") == 1
    before = Study.open(tmp_path / "s")
    recorded, first = before.evaluations, before.record.designs()
    before.close()
    assert 0 < recorded < 120
    assert limited(tmp_path, 60_000, "optimize", "--resume", "s").returncode == 2
    whole = resume(tmp_path / "s", budget=120)
    assert whole.evaluations == 120
    assert whole.record.designs()[:recorded].tobytes() == first.tobytes()
    assert rerun(tmp_path / "s").same


@POSIX
@pytest.mark.parametrize(
    "command",
    [
        ("optimize", "finger", "-p", "L", "--out", "s"),
        ("compare", "finger", "-p", "L", "-m", "ps", "--seeds", "1", "--out", "s"),
    ],
)
def test_a_disk_that_is_full_from_the_start_leaves_nothing_half_made(
    tmp_path: Path, command: tuple[str, ...]
) -> None:
    full = limited(tmp_path, 1000, *command)
    assert full.returncode == 2
    assert full.stderr.startswith("error: the ")
    assert " cannot be made: " in full.stderr
    assert full.stderr.count("\n") == 1
    assert list(tmp_path.iterdir()) == []


@pytest.fixture
def open_place() -> Iterator[Path]:
    """A folder that other users reach, unlike pytest's own."""
    place = Path(tempfile.mkdtemp())
    place.chmod(0o755)
    yield place
    for path in [place, *place.rglob("*")]:
        path.chmod(0o755)
    shutil.rmtree(place)


@POSIX
def test_a_folder_that_cannot_be_written_is_read_and_nothing_else(
    analytic: ModuleType, open_place: Path
) -> None:
    folder = open_place / "s"
    model = analytic.AnalyticModel()
    optimize(model, folder=folder, budget=40, **OPTIONS).close()
    for path in folder.iterdir():
        path.chmod(0o444)
    folder.chmod(0o555)
    open_place.chmod(0o555)
    root = os.geteuid() == 0
    if root:  # who may write anywhere
        os.seteuid(65534)
    try:
        study = Study.open(folder, model=model)
        assert study.evaluations == 40
        assert np.isfinite(study.best.value)
        study.close()
        assert rerun(folder, model=model).same
        with pytest.raises(InputError, match="cannot be locked: permission denied"):
            resume(folder, model=model)
        with pytest.raises(InputError, match="cannot be made: permission denied"):
            optimize(model, folder=open_place / "t")
    finally:
        if root:
            os.seteuid(0)


@pytest.mark.parametrize("kept", [0.0, 0.3, 0.7, 0.99])
def test_a_cut_log_costs_its_end_only(analytic: ModuleType, tmp_path: Path, kept: float) -> None:
    whole = optimize(analytic.AnalyticModel(), folder=tmp_path / "whole", **OPTIONS)
    # As a power cut leaves it: file and log of a process that never closed them, the log cut.
    shutil.copytree(tmp_path / "whole", tmp_path / "s")
    log = tmp_path / "s" / "record.sqlite-wal"
    assert log.stat().st_size > 50_000
    os.truncate(log, int(kept * log.stat().st_size))
    (tmp_path / "s" / "record.sqlite-shm").unlink()
    left = Study.open(tmp_path / "s", model=analytic.AnalyticModel())
    count = left.evaluations
    assert (count > 0) == (kept > 0.0)
    assert count < whole.evaluations
    assert left.record.designs().tobytes() == whole.record.designs()[:count].tobytes()
    left.close()
    again = resume(tmp_path / "s", model=analytic.AnalyticModel())
    assert bits(again) == bits(whole)


def test_a_clock_that_goes_back_changes_nothing(
    analytic: ModuleType, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    whole = optimize(analytic.AnalyticModel(), **OPTIONS)
    clock = iter(np.random.default_rng(0).uniform(0.0, 2e9, 10_000).tolist())
    monkeypatch.setattr(time, "time", lambda: next(clock))
    optimize(analytic.AnalyticModel(), folder=tmp_path / "s", budget=50, **OPTIONS).close()
    again = optimize(analytic.AnalyticModel(), folder=tmp_path / "s", resume=True, **OPTIONS)
    assert bits(again) == bits(whole)
    assert again.best.vector.tobytes() == whole.best.vector.tobytes()


def test_a_lock_needs_no_room(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(*_: Any) -> int:
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(os, "write", full)
    lock = Lock(tmp_path, "study")
    with pytest.raises(InputError, match="is in use by another process: wait for it or stop it"):
        Lock(tmp_path, "study")
    lock.release()
    Lock(tmp_path, "study").release()


RUN = """
import sys
from flexor.cli.app import main
main(["optimize", "finger", "-p", "R01", "--budget", "100", "--json", *sys.argv[1:]])
"""


def test_of_two_processes_one_runs_the_study_and_the_other_is_told(tmp_path: Path) -> None:
    def start(*arguments: str) -> subprocess.Popen[str]:
        return subprocess.Popen(
            [sys.executable, "-c", RUN, *arguments],
            cwd=tmp_path,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            env={**os.environ, "COLUMNS": "300"},
        )

    # Both make the same folder at once.
    both = [start("--out", "s"), start("--out", "s")]
    said = [process.communicate(timeout=120) for process in both]
    assert sorted(process.returncode for process in both) == [0, 2]
    (refused,) = [err for process, (_, err) in zip(both, said, strict=True) if process.returncode]
    assert refused.startswith("error: ")
    assert "holds recorded work already" in refused or "cannot be made" in refused
    assert refused.count("\n") == 1
    assert sorted(path.name for path in tmp_path.iterdir()) == ["s"]
    record = Record(tmp_path / "s" / "record.sqlite")
    assert len(record) > 30
    record.close()
    assert rerun(tmp_path / "s").same
