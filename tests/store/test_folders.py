"""Folders of every kind of work: nothing outside them is touched, and the umask is respected."""

from __future__ import annotations

import json
import os
import pickle
import stat
import sys
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest

import flexor
from flexor.cli.app import main
from flexor.errors import InputError
from flexor.objectives import custom
from flexor.store import Database, Lock, environment, replaced
from flexor.store.environment import decisive
from flexor.study import Study, optimize, resume

POSIX = pytest.mark.skipif(sys.platform == "win32", reason="links, pipes and modes of POSIX")
TARGETS = """
[search]
samples = 16
starts = 1
[[constant]]
name = "E"
fields = ["exosuit.young_modulus"]
range = ["500 kPa", "8 MPa"]
[[target]]
name = "bend"
observable = "bending"
force = "0:2:2"
value = "0.3 rad"
tolerance = "0.01 rad"
"""
# How each kind of work is begun and gone on with, and the files it writes at its end.
KINDS: dict[str, tuple[list[str], list[str], list[str]]] = {
    "study": (
        ["optimize", "finger", "-p", "L", "--budget", "5", "--out", "s"],
        ["optimize", "--resume", "s"],
        ["designs.png", "designs.svg"],
    ),
    "landscape": (
        ["landscape", "finger", "-p", "L", "--grid", "3", "--out", "s"],
        ["landscape", "--resume", "s"],
        ["landscape.npz", "landscape.csv", "landscape.png", "landscape.svg"],
    ),
    "comparison": (
        ["compare", "finger", "-p", "L", "-m", "ps", "--seeds", "1", "--budget", "5", "--out", "s"],
        ["compare", "--resume", "s"],
        ["comparison.csv", "searches.csv", "profiles.png", "profiles.svg"],
    ),
    "calibration": (
        ["calibrate", "finger", "targets.toml", "--out", "s"],
        ["calibrate", "finger", "targets.toml", "--out", "s", "--resume"],
        ["constants.toml", "targets.csv", "calibration.json", "calibration.png"],
    ),
}


def run(*arguments: str) -> int:
    with pytest.raises(SystemExit) as ended:
        main(list(arguments))
    return int(ended.value.code or 0)


@pytest.fixture(scope="module", params=list(KINDS))
def made(request: Any, tmp_path_factory: Any) -> tuple[str, Path]:
    """A folder of each kind, in a place of its own."""
    place = tmp_path_factory.mktemp(request.param)
    before = Path.cwd()
    os.chdir(place)
    try:
        (place / "targets.toml").write_text(TARGETS)
        assert run(*KINDS[request.param][0]) in (0, 1)
    finally:
        os.chdir(before)
    return request.param, place


@POSIX
def test_no_link_in_a_folder_is_followed(
    made: tuple[str, Path], monkeypatch: Any, capsys: Any
) -> None:
    kind, place = made
    _, command, files = KINDS[kind]
    monkeypatch.chdir(place)
    precious = place / "precious"
    precious.write_text("precious")
    for name in files:  # are replaced
        (place / "s" / name).unlink()
        (place / "s" / name).symlink_to(precious)
    assert run(*command) in (0, 1)
    assert precious.read_text() == "precious"
    for name in files:
        assert (place / "s" / name).is_file()
        assert not (place / "s" / name).is_symlink()
    assert not list((place / "s").glob(".*"))
    names = ["record.sqlite", "record.sqlite-wal", "settings.json"]  # are refused
    if kind != "landscape":  # which is only read, once it is finished
        names.append("lock")
    if kind != "calibration":  # whose targets are given again
        names.append("model.toml")
    for name in names:
        for special in ("link", "pipe", "folder"):
            path, aside = place / "s" / name, place / "aside"
            if path.exists():
                path.rename(aside)
            if special == "link":
                path.symlink_to(precious)
            elif special == "pipe":
                os.mkfifo(path)
            else:
                path.mkdir()
            capsys.readouterr()
            assert run(*command) == 2
            said = capsys.readouterr()
            assert said.err == (
                f'error: "s/{name}" is {"no file" if special == "pipe" else f"a {special}"}: '
                "only a regular file is used in its place.\n"
            )
            path.rmdir() if special == "folder" else path.unlink()
            if aside.exists():
                aside.rename(path)
            assert precious.read_text() == "precious"


@POSIX
def test_the_umask_decides_who_may_read(analytic: ModuleType, tmp_path: Path) -> None:
    before = os.umask(0o027)
    try:
        optimize(analytic.AnalyticModel(), "L", budget=5, folder=tmp_path / "s").close()
        resume(tmp_path / "s", model=analytic.AnalyticModel(), budget=6).close()
    finally:
        os.umask(before)
    assert stat.S_IMODE((tmp_path / "s").stat().st_mode) == 0o750
    for path in (tmp_path / "s").iterdir():
        assert stat.S_IMODE(path.stat().st_mode) == 0o640, path.name


def test_every_kind_says_what_it_was_made_with(made: tuple[str, Path]) -> None:
    kind, place = made
    values = json.loads((place / "s" / "settings.json").read_text())
    assert values["kind"] == ("study" if kind == "landscape" else kind)
    assert values["environment"] == environment()
    assert values["flexor"] == flexor.__version__


@pytest.mark.parametrize("key", list(decisive()))
def test_another_version_or_engine_is_not_gone_on_with(
    analytic: ModuleType, tmp_path: Path, key: str
) -> None:
    optimize(analytic.AnalyticModel(), "L", budget=5, folder=tmp_path / "s").close()
    path = tmp_path / "s" / "settings.json"
    values = json.loads(path.read_text())
    (values if key == "flexor" else values["environment"])[key] = "0123"
    path.write_text(json.dumps(values))
    with pytest.raises(InputError) as refusal:
        resume(tmp_path / "s", model=analytic.AnalyticModel(), budget=9)
    assert f"0123, this is {decisive()[key]}: resume it with the one that made it" in str(
        refusal.value
    )
    assert Study.open(tmp_path / "s", model=analytic.AnalyticModel()).evaluations == 5


def test_a_finished_landscape_of_another_version_is_drawn(tmp_path: Path, monkeypatch: Any) -> None:
    monkeypatch.chdir(tmp_path)
    assert run(*KINDS["landscape"][0]) == 0
    path = tmp_path / "s" / "settings.json"
    values = json.loads(path.read_text())
    path.write_text(json.dumps({**values, "flexor": "9.9.9"}))
    (tmp_path / "s" / "landscape.csv").unlink()
    assert run("landscape", "--resume", "s") == 0
    assert (tmp_path / "s" / "landscape.csv").is_file()


def first_joint(path: Any) -> float:
    return -float(path.joint_angles[-1, 0])


@pytest.mark.parametrize("where", ["folder", "memory"])
def test_a_study_is_pickled_with_its_record(tmp_path: Path, monkeypatch: Any, where: str) -> None:
    monkeypatch.chdir(tmp_path)
    folder = "s" if where == "folder" else None
    model = flexor.load("finger")
    study = optimize(
        model, "R01", custom("first", first_joint), method="bfgs", budget=9, folder=folder
    )
    content = pickle.dumps(study)
    monkeypatch.chdir("/")  # the folder is found from anywhere
    copy = pickle.loads(content)
    assert copy.best.vector.tobytes() == study.best.vector.tobytes()
    assert copy.record.designs().tobytes() == study.record.designs().tobytes()
    assert copy.record.outcomes().joint_angles.tobytes() == (
        study.record.outcomes().joint_angles.tobytes()
    )
    assert (copy.finished, copy.evaluations) == (study.finished, 9)
    assert copy.result.design.tobytes() == study.result.design.tobytes()
    assert copy.start.value == study.start.value
    if where == "folder":
        with pytest.raises(InputError, match="readonly"):
            copy.record.database.note("finished", None)
        study.close()
        (tmp_path / "s" / "record.sqlite").unlink()
        with pytest.raises(InputError, match="cannot be used: unable to open"):
            pickle.loads(content)


def test_a_file_is_replaced_whole_or_not_at_all(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    path.write_text("old")

    def fail() -> None:
        with replaced(path) as draft:
            draft.write_text("half")
            raise RuntimeError

    with pytest.raises(RuntimeError):
        fail()
    assert path.read_text() == "old"
    assert list(tmp_path.iterdir()) == [path]


def test_threads_share_a_database(tmp_path: Path) -> None:
    from concurrent.futures import ThreadPoolExecutor

    tables = "CREATE TABLE numbers (n INTEGER UNIQUE);"
    database = Database(tmp_path / "d.sqlite", tables)

    def insert(first: int) -> None:
        for n in range(first, first + 50):
            database.write(("INSERT INTO numbers VALUES (?)", [(n,)]))
            assert database.one("SELECT count(*) FROM numbers WHERE n = ?", (n,)) == 1

    with ThreadPoolExecutor(8) as pool:
        list(pool.map(insert, range(0, 400, 50)))
    found = np.array(database.rows("SELECT n FROM numbers ORDER BY n")).ravel()
    np.testing.assert_array_equal(found, np.arange(400))
    with pytest.raises(InputError, match="cannot be used: UNIQUE constraint failed"):
        database.write(("INSERT INTO numbers VALUES (?)", [(400,), (3,)]))
    assert database.one("SELECT max(n) FROM numbers") == 399


def test_a_lock_names_the_kind_of_work(tmp_path: Path) -> None:
    lock = Lock(tmp_path, "comparison")
    with pytest.raises(InputError, match=r'^the comparison ".*" is in use by another process'):
        Lock(tmp_path, "comparison")
    lock.release()
