"""A calibration that is killed and resumed ends as one that never was."""

from __future__ import annotations

import json
import os
import shutil
import signal
import sqlite3
import subprocess
import sys
import time
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from multiprocessing import get_context

import pytest

import flexor as package
from flexor.calibration import calibrate
from flexor.cli.app import main
from flexor.study import Threads

FILE = """
[search]
samples = 256
starts = 4
[[constant]]
name = "E"
fields = ["exosuit.young_modulus"]
range = ["500 kPa", "8 MPa"]
scale = "log"
[[constant]]
name = "k"
fields = ["skin.stiffness"]
range = ["10 N/m", "1000 N/m"]
scale = "log"
[[target]]
name = "bend"
observable = "angle"
of = "ph_1"
force = "1:6:1"
value = ["0.1 rad", "0.2 rad", "0.35 rad", "0.5 rad", "0.65 rad", "0.8 rad"]
tolerance = "0.02 rad"
[[target]]
name = "best"
observable = "optimum"
parameters = "L"
of = "L"
value = "10 cm"
weight = "held-out"
options = { starts = 2, tolerance = 0.05 }
"""
COMMAND = [sys.executable, "-c", "from flexor.cli.app import main; main()", "calibrate"]
COARSE = ["--constants", "calibrated", "--set", "exosuit.elements=4"]
COARSE += ["--set", "exosuit.gauss_points=2"]


@pytest.fixture
def file(targets):
    return targets(FILE)


@pytest.fixture(scope="module")
def whole(coarse, tmp_path_factory):
    path = tmp_path_factory.mktemp("whole") / "made-targets.toml"
    path.write_text(FILE)
    return calibrate(coarse, path, executor=Threads(1))


@pytest.fixture(scope="module")
def finished(tmp_path_factory):
    """The folder of a whole calibration, and what the command wrote into it."""
    place = tmp_path_factory.mktemp("finished")
    (place / "made-targets.toml").write_text(FILE)
    with pytest.MonkeyPatch.context() as patch, pytest.raises(SystemExit) as ended:
        patch.chdir(place)
        main(["calibrate", "finger", "made-targets.toml", "--out", "out", *COARSE])
    assert not ended.value.code
    return place / "out"


@pytest.fixture
def folder(finished, tmp_path):
    return shutil.copytree(finished, tmp_path / "out")


def same(first, second) -> bool:
    return first.best.constants == second.best.constants and all(
        a.tolist() == b.tolist() for a, b in zip(first.best.values, second.best.values, strict=True)
    )


def test_the_same_seed_gives_the_same_on_any_number_of_threads(file, coarse, whole) -> None:
    again = calibrate(coarse, file, executor=Threads(2))
    assert same(whole, again)
    assert whole.evaluations == again.evaluations
    assert not same(whole, calibrate(coarse, file, seed=1, starts=1)) or whole.best.misfit == 0.0


@pytest.mark.parametrize("pool", ["processes", "threads"])
def test_the_same_seed_gives_the_same_on_any_executor(file, coarse, whole, pool) -> None:
    chosen = (
        ThreadPoolExecutor(2)
        if pool == "threads"
        else ProcessPoolExecutor(2, mp_context=get_context("spawn"))
    )
    with chosen as executor:
        again = calibrate(coarse, file, executor=executor)
    assert same(whole, again)
    assert whole.evaluations == again.evaluations


def test_all_is_replayed_and_nothing_evaluated_again(file, coarse, tmp_path, whole) -> None:
    folder = tmp_path / "out"
    first = calibrate(coarse, file, folder=folder)
    told = []
    second = calibrate(coarse, file, folder=folder, resume=True, progress=told.append)
    assert same(first, second) and same(first, whole)
    assert told[-1].evaluated == 0
    assert told[-1].replayed > 200


@pytest.mark.skipif(sys.platform == "win32", reason="sends SIGKILL")
def test_killed_and_resumed_it_ends_in_the_same_report(flexor, finished, file, tmp_path) -> None:
    words = ["finger", file.name]
    record = tmp_path / "parts" / "record.sqlite"
    rows = 0
    for turn, option in enumerate(("--out", "--resume")):
        process = subprocess.Popen(
            [*COMMAND, *words, option, "parts", *COARSE],
            cwd=tmp_path,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
        until = time.monotonic() + 300.0
        # Killed as soon as there is something new, the second time a little later.
        while process.poll() is None and time.monotonic() < until:
            time.sleep(0.01)
            if record.exists() and counted(record) > rows + 100 * turn:
                process.send_signal(signal.SIGKILL)
                break
        assert process.wait() == -signal.SIGKILL
        rows = counted(record)
    assert flexor("calibrate", *words, "--resume", "parts", *COARSE).code == 0
    assert counted(record) > rows
    for name in ("constants.toml", "targets.csv", "calibration.json"):
        ended, wanted = ((place / name).read_text() for place in (tmp_path / "parts", finished))
        assert ended == wanted


def counted(record) -> int:
    try:
        with sqlite3.connect(f"{record.as_uri()}?mode=ro", uri=True, timeout=10) as sql:
            return int(sql.execute("SELECT count(*) FROM evaluations").fetchone()[0])
    except sqlite3.Error:
        return 0


@pytest.mark.skipif(sys.platform == "win32", reason="sends SIGINT")
@pytest.mark.usefixtures("interruptible")
def test_ctrl_c_says_how_to_go_on(file, tmp_path) -> None:
    words = ["finger", file.name, "--out", "my folder", "--samples", "4096"]
    process = subprocess.Popen(
        [*COMMAND, *words],
        cwd=tmp_path,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env={**os.environ, "COLUMNS": "200"},
    )
    record = tmp_path / "my folder" / "record.sqlite"
    until = time.monotonic() + 100.0
    while process.poll() is None and time.monotonic() < until:
        time.sleep(0.05)
        if record.exists() and counted(record) > 0:
            break
    process.send_signal(signal.SIGINT)
    out, err = process.communicate(timeout=300)
    assert process.returncode == 130
    assert out == "" and "Traceback" not in err
    assert err.splitlines()[-1].strip() == (
        "flexor calibrate finger made-targets.toml --samples 4096 --resume 'my folder'"
    )


def test_other_settings_are_refused(flexor, folder, file) -> None:
    words = ("calibrate", "finger", file, "--resume", folder, *COARSE)
    for more, changed in (
        (["--seed", "3"], "seed = 0, not 3"),
        (["--samples", "9"], "samples = 256, not 9"),
        (["--set", "exosuit.length=9 cm"], "other models"),
    ):
        ran = flexor(*words, *more)
        assert ran.code == 2
        assert ran.err.count("\n") == 1
        assert f"was made with {changed}" in ran.err
    file.write_text(FILE.replace("0.8 rad", "0.7 rad"))
    assert "was made with other targets" in flexor(*words).err


def test_a_folder_is_not_written_over(flexor, folder, file) -> None:
    ran = flexor("calibrate", "finger", file, "--out", folder, *COARSE)
    assert ran.code == 2
    assert "holds recorded work already" in ran.err


def test_a_damaged_folder_is_refused(flexor, folder, file) -> None:
    words = ("calibrate", "finger", file, "--resume", folder, *COARSE)
    settings = (folder / "settings.json").read_text()
    (folder / "settings.json").write_text("{")
    assert "is damaged" in flexor(*words).err
    (folder / "settings.json").write_text(json.dumps({**json.loads(settings), "format": 9}))
    assert "reads format 3" in flexor(*words).err
    old = json.loads(settings)
    old["flexor"] = "0.1.9"
    (folder / "settings.json").write_text(json.dumps(old))
    assert "was made with Flexor 0.1.9, this is " in flexor(*words).err
    (folder / "settings.json").write_text(settings)
    (folder / "record.sqlite").write_bytes(b"this is no database" * 100)
    ran = flexor(*words)
    assert ran.code == 2 and "cannot be used" in ran.err
    assert ran.err.count("\n") == 1


def test_a_record_that_no_longer_holds_is_refused(flexor, folder, file) -> None:
    with sqlite3.connect(folder / "record.sqlite") as sql:
        sql.execute(
            "UPDATE evaluations SET observed = zeroblob(length(observed)) WHERE screening = 0"
        )
    ran = flexor("calibrate", "finger", file, "--resume", folder, *COARSE)
    assert ran.code == 2
    assert "no longer reproduces" in ran.err


def test_only_one_process_at_a_time(flexor, folder, file) -> None:
    from flexor.store import Lock

    lock = Lock(folder, "calibration")
    try:
        ran = flexor("calibrate", "finger", file, "--resume", folder, *COARSE)
    finally:
        lock.release()
    assert ran.code == 2
    assert "in use by another process" in ran.err


def test_in_memory_it_cannot_be_resumed(file, coarse) -> None:
    with pytest.raises(package.InputError, match="needs its folder"):
        calibrate(coarse, file, resume=True)
