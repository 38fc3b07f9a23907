from __future__ import annotations

import csv
import json
import os
import shlex
import signal
import subprocess
import sys
import time

import pytest

SMALL = ("compare", "finger", "-p", "L", "-m", "ps,lm", "--seeds", "2", "--budget", "8")


def test_table_files_and_figure(flexor, tmp_path) -> None:
    ran = flexor(*SMALL, "--plot", "also.png")
    assert ran.code == 0
    assert ran.err in ("", "drawing the profiles …\n")  # said only where it takes long
    for words in ("pattern-search", "levenberg-marquardt", "success", "4 searches of at most 8"):
        assert words in ran.out
    folder = tmp_path / "studies" / "finger-bending-comparison"
    for name in ("comparison.csv", "searches.csv", "profiles.png", "profiles.svg"):
        assert (folder / name).stat().st_size > 100
        assert f"file: {(folder / name).relative_to(tmp_path)}" in ran.out
    assert (tmp_path / "also.png").stat().st_size > 10_000
    with open(folder / "searches.csv", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert [row["seed"] for row in rows] == ["0", "1", "0", "1"]


def test_infeasible_designs_are_called_so(flexor) -> None:
    words = ("--budget", "3", "--subject-to", "overlap <= 0.01 mm")
    ran = flexor("compare", "finger", "-p", "L", "-m", "ps", "--seeds", "1", *words)
    assert "NOT FEASIBLE: no search of L found a design that keeps the constraints" in ran.out
    table = ran.out.partition("NOT FEASIBLE")[0]
    assert "infeasible by" in table and "0 %" in table and "100 %" not in table


def test_json_and_resume_tell_the_same(flexor) -> None:
    first = json.loads(flexor(*SMALL, "--out", "c", "--json").out)
    again = json.loads(flexor("compare", "--resume", "c", "--json").out)
    assert {key: first[key] for key in ("sets", "summaries", "seeds")} == {
        key: again[key] for key in ("sets", "summaries", "seeds")
    }
    assert first["sets"]["L"]["best"] < first["sets"]["L"]["reference"]
    assert len(first["summaries"]) == 2


@pytest.mark.skipif(sys.platform == "win32", reason="sends SIGINT")
@pytest.mark.usefixtures("interruptible")
def test_ctrl_c_leaves_a_comparison_and_says_how_to_go_on(tmp_path) -> None:
    command = [sys.executable, "-c", "from flexor.cli.app import main; main()"]
    job = ["compare", "finger", "-p", "RLP", "-m", "ps,cma-es", "--out", "my comparison"]
    process = subprocess.Popen(
        [*command, *job, "--seeds", "50", "--budget", "5000"],
        cwd=tmp_path,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env={**os.environ, "COLUMNS": "200"},
    )
    running = tmp_path / "my comparison" / "record.sqlite"
    until = time.monotonic() + 60.0
    while not running.exists() and process.poll() is None and time.monotonic() < until:
        time.sleep(0.05)
    time.sleep(0.5)
    process.send_signal(signal.SIGINT)
    out, said = process.communicate(timeout=300)
    assert process.returncode == 130
    assert out == ""
    assert "Traceback" not in said
    resuming = shlex.split(said.strip().splitlines()[-1])
    assert resuming == ["flexor", "compare", "--resume", "my comparison"]
    assert (tmp_path / "my comparison" / "settings.json").exists()


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ([], "give a MODEL"),
        (["fingr"], 'did you mean "finger"'),
        (["finger", "-p", "R02"], "unknown parameter set"),
        (["finger", "-m", "cma-se"], 'did you mean "cma-es"'),
        (["finger", "-m", "ps,ps"], "is given twice"),
        (["finger", "-o", "f_exo", "-m", "lm"], "is not the norm of a vector"),
        (["finger", "--seeds", "0"], "--seeds is 0: it must be at least 1."),
        (["finger", "--budget", "0"], "--budget is 0: it must be at least 1."),
        (["finger", "--plot", "x.bmp"], "must end in"),
        (["finger", "--resume", "c"], "takes only the folder"),
        (["--resume", "nowhere"], "is not a comparison"),
    ],
)
def test_bad_input_gets_one_sentence(flexor, tmp_path, arguments: list[str], words: str) -> None:
    ran = flexor("compare", *arguments)
    assert words in ran.error
    assert list(tmp_path.iterdir()) == []
