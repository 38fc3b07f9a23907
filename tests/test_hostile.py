"""A small sample of each command that treats Flexor badly; `./dev hostile` runs them whole."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

BENCHMARKS = Path(__file__).resolve().parent.parent / "benchmarks"


def run(place: Path, name: str, *arguments: str) -> str:
    done = subprocess.run(
        [sys.executable, BENCHMARKS / f"{name}.py", *arguments],
        cwd=place,
        capture_output=True,
        text=True,
        timeout=300,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def test_damaged_files_are_read_or_refused_in_one_sentence(tmp_path: Path) -> None:
    said = run(tmp_path, "hostile_files", "--files", "300", "--seed", "11")
    assert "300 files, seed" in said
    assert "complaints: 0" in said


def test_designs_out_of_all_bounds_end_with_a_status_and_the_count_resumes(tmp_path: Path) -> None:
    half = run(tmp_path, "hostile_designs", "--designs", "500", "--seed", "7")
    assert "500 designs, seed 7" in half
    whole = run(tmp_path, "hostile_designs", "--designs", "1000", "--seed", "7")
    assert "1,000 designs, seed 7" in whole
    for status in ("converged", "iteration-limit", "invalid-design"):
        assert status in whole
    assert "complaints: 0" in whole


@pytest.mark.skipif(sys.platform == "win32", reason="no SIGKILL")
def test_killed_and_resumed_a_study_is_the_same(tmp_path: Path) -> None:
    said = run(tmp_path, "hostile_kills", "--kills", "2", "--starts", "2")
    assert "2 kills" in said
    assert "complaints: 0" in said
