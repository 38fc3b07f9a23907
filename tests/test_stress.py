"""Small runs of the stress tests of `./dev stress`."""

from __future__ import annotations

import runpy
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

BENCHMARKS = Path(__file__).resolve().parent.parent / "benchmarks"
Run = Callable[..., str]


@pytest.fixture
def run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Run:
    """Run a script in an empty folder, without failures; return its output."""

    def runs(name: str, *arguments: str) -> str:
        monkeypatch.chdir(tmp_path)
        monkeypatch.setattr(sys, "argv", [name, *arguments])
        monkeypatch.syspath_prepend(BENCHMARKS)
        with pytest.raises(SystemExit) as ended:
            runpy.run_path(str(BENCHMARKS / f"{name}.py"), run_name="__main__")
        output = capsys.readouterr().out
        assert ended.value.code == 0, output
        assert "failures: 0" in output
        return output

    return runs


def test_damaged_files_are_read_or_rejected_with_one_sentence(run: Run) -> None:
    assert "150 files, seed" in run("stress_files", "--files", "150", "--seed", "11")


def test_extreme_designs_end_with_a_status_and_the_count_resumes(run: Run) -> None:
    output = run("stress_designs", "--designs", "500", "--seed", "7")
    assert "500 designs, seed 7" in output
    for status in ("converged", "iteration-limit", "invalid-design"):
        assert status in output
    assert run("stress_designs", "--designs", "500", "--seed", "7") == output


@pytest.mark.skipif(sys.platform == "win32", reason="no SIGKILL")
def test_a_killed_and_resumed_study_is_identical(run: Run) -> None:
    assert "1 kills" in run("stress_kills", "--kills", "1", "--starts", "2")


def test_random_models_called_stable_are_minima(run: Run) -> None:
    output = run("stress_models", "--models", "60", "--seed", "5")
    assert "60 models from number 0, seed 5" in output
    for kind in ("follower", "contact", "spherical", "stable", "neutral"):
        assert kind in output


def test_random_gloves_converge(run: Run) -> None:
    output = run("stress_glove", "--designs", "5", "--seed", "3")
    assert "converged at every load: 5" in output


def test_random_models_with_friction_keep_its_laws(run: Run) -> None:
    assert "converged" in run("stress_friction", "--models", "60", "--seed", "5")


@pytest.mark.parametrize("number", [812, 2168, 4052, 9897])
def test_models_that_failed_once(run: Run, number: int) -> None:
    run("stress_models", "--first", str(number), "--models", "1")


def test_random_devices_called_stable_are_minima(run: Run) -> None:
    output = run("stress_devices", "--models", "60", "--seed", "5")
    assert "60 models from number 0, seed 5" in output
    for kind in ("half-round", "box", "tube", "composite", "ogden", "pressure", "two sections"):
        assert kind in output


def test_random_solids_are_watertight_and_have_their_volume(run: Run, tmp_path: Path) -> None:
    # What it takes is for the stress test itself: a busy machine is no failure.
    limit = ("--seconds", "60")
    output = run("stress_solids", "--fingers", "2", "--rods", "1", "--seed", "3", *limit)
    assert "2 fingers, 1 rods of each section, seed 3" in output
    assert "pneumatic-finger       2        0" in output
    # A process that was killed while it wrote leaves half a line; the rest is not made again.
    state = tmp_path / "stress-solids.jsonl"
    lines = state.read_bytes().splitlines(keepends=True)
    assert len(lines) == 1 + 2 + 10
    state.write_bytes(b"".join([*lines[:-1], lines[-1][:20]]))
    again = run("stress_solids", "--fingers", "2", "--rods", "1", "--seed", "3", *limit)
    assert [row.split()[:2] for row in again.splitlines()] == [
        row.split()[:2] for row in output.splitlines()
    ]
    assert state.read_bytes().splitlines(keepends=True)[:-1] == lines[:-1]
