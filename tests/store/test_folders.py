"""Folders of every kind of work: nothing outside them is touched, and the umask is respected."""

from __future__ import annotations

import json
import os
import pickle
import stat
import sys
from collections.abc import Iterator
from contextlib import closing, contextmanager
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest

import flexor
from flexor import plot
from flexor.cli.app import main
from flexor.errors import InputError
from flexor.objectives import custom
from flexor.store import Database, Lock, environment, replaced
from flexor.study import Study, optimize, resume
from flexor.study.comparison import open_comparison
from flexor.study.landscape import Landscape

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
        ["calibrate", "finger", "targets.toml", "--resume", "s"],
        ["constants.toml", "targets.csv", "calibration.json", "calibration.png"],
    ),
}


def run(*arguments: str) -> int:
    with pytest.raises(SystemExit) as ended:
        main(list(arguments))
    return int(ended.value.code or 0)


@contextmanager
def figures_saved_under_a_lock() -> Iterator[None]:
    """See that a PNG and an SVG are saved, while the folder they go to is locked."""
    save, refused = plot.save, []

    def saving(figure: Any, path: Path) -> Path:
        with pytest.raises(InputError, match="is in use by another process") as refusal:
            Lock(path.parent, "study")
        refused.append(refusal)
        return save(figure, path)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(plot, "save", saving)
        yield
    assert len(refused) == 2


@pytest.fixture(scope="module", params=list(KINDS))
def modes(request: Any, tmp_path_factory: Any) -> tuple[str, Path, dict[Path, int]]:
    """A folder of each kind, in a place of its own, and its modes when it was made."""
    place = tmp_path_factory.mktemp(request.param)
    (place / "targets.toml").write_text(TARGETS)
    before = os.umask(0o027)
    try:
        with pytest.MonkeyPatch.context() as patch, figures_saved_under_a_lock():
            patch.chdir(place)
            assert run(*KINDS[request.param][0]) in (0, 1)
    finally:
        os.umask(before)
    written = [place / "s", *(place / "s").rglob("*")]
    return request.param, place, {path: path.stat().st_mode for path in written}


@pytest.fixture(scope="module")
def made(modes: tuple[str, Path, dict[Path, int]]) -> tuple[str, Path]:
    """A folder of each kind, in a place of its own."""
    return modes[:2]


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
    names = ["record.sqlite", "record.sqlite-wal", "settings.json", "lock"]  # are refused
    if kind != "calibration":  # whose targets are given again
        names += ["model.toml", "source.toml"]
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
                f'error: "s/{name}" is not a regular file: it is a '
                f"{'special file' if special == 'pipe' else special}.\n"
            )
            path.rmdir() if special == "folder" else path.unlink()
            if aside.exists():
                aside.rename(path)
            assert precious.read_text() == "precious"


@POSIX
def test_the_umask_decides_who_may_read_any_file(modes: tuple[str, Path, dict[Path, int]]) -> None:
    kind, place, found = modes
    assert {path.name for path in found} >= {"settings.json", *KINDS[kind][2]}
    for path, mode in found.items():
        wanted = stat.S_IFDIR | 0o750 if path == place / "s" else stat.S_IFREG | 0o640
        assert mode == wanted, path.name


def test_a_folder_in_place_of_an_output_is_refused_before_the_work(
    made: tuple[str, Path], monkeypatch: Any, capsys: Any
) -> None:
    kind, place = made
    monkeypatch.chdir(place)
    name = KINDS[kind][2][0]
    aside = place / "kept"
    (place / "s" / name).rename(aside)
    (place / "s" / name).mkdir()
    try:
        assert run(*KINDS[kind][1]) == 2
        said = capsys.readouterr().err
        assert said.count("\n") == 1
        assert f'"s/{name}" cannot be written' in said
    finally:
        (place / "s" / name).rmdir()
        aside.rename(place / "s" / name)


@pytest.mark.parametrize("command", ["simulate", "optimize", "landscape", "compare"])
@pytest.mark.parametrize("plot", ["there.png", "nowhere/x.png", "x.gif"])
def test_a_figure_that_cannot_be_written_is_refused_before_the_work(
    tmp_path: Path, monkeypatch: Any, capsys: Any, command: str, plot: str
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "there.png").mkdir()
    assert run(command, "finger", "--plot", plot) == 2
    said = capsys.readouterr().err
    assert said.startswith("error: ")
    assert plot in said
    assert sorted(path.name for path in tmp_path.iterdir()) == ["there.png"]


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


def test_a_folder_is_whole_when_its_command_ends(made: tuple[str, Path]) -> None:
    names = [path.name for path in (made[1] / "s").iterdir()]
    assert not [name for name in names if name.endswith(("-wal", "-shm", "-journal"))]


def test_every_kind_says_what_it_was_made_with(made: tuple[str, Path]) -> None:
    kind, place = made
    values = json.loads((place / "s" / "settings.json").read_text())
    assert values["kind"] == kind
    assert values["environment"] == environment()
    assert values["flexor"] == flexor.__version__


def contents(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in sorted(folder.iterdir())}


# In the settings: Flexor, its engine, minor versions, and the package of a method.
VERSIONS = {
    "flexor": ("0.1.9", "Flexor"),
    "engine": ("0123", "another build of the engine"),
    "engine_path": ("0123", "another build of the engine path"),
    "python": ("3.1.0", "Python"),
    "numpy": ("1.0.2", "numpy"),
}


@pytest.mark.parametrize("key", list(VERSIONS))
def test_finished_work_of_another_version_is_not_written_into(
    made: tuple[str, Path], monkeypatch: Any, capsys: Any, key: str
) -> None:
    kind, place = made
    monkeypatch.chdir(place)
    path = place / "s" / "settings.json"
    kept = path.read_text()
    values = json.loads(kept)
    here = flexor.__version__ if key == "flexor" else values["environment"][key]
    then, name = VERSIONS[key]
    (values if key == "flexor" else values["environment"])[key] = then
    path.write_text(json.dumps(values))
    before = contents(place / "s")
    capsys.readouterr()
    try:
        assert run(*KINDS[kind][1]) == 2
        assert capsys.readouterr().err == (
            f'error: the {kind} "s" was made with {name} {then}, this is {here}: resume it with '
            "that one, or start a new one.\n"
        )
        (place / "s" / "lock").write_bytes(before["lock"])
        assert contents(place / "s") == before
        if kind == "landscape":  # but it is read
            with closing(Landscape.open("s")) as found:
                assert found.value.shape == (3,)
        if kind == "comparison":
            assert open_comparison("s").seeds == (0,)
        if kind == "study":
            with closing(Study.open("s")) as found:
                assert found.evaluations == 5
    finally:
        path.write_text(kept)


def test_only_packages_that_decide_the_results_are_compared(
    made: tuple[str, Path], monkeypatch: Any, capsys: Any
) -> None:
    kind, place = made
    monkeypatch.chdir(place)
    path = place / "s" / "settings.json"
    kept = path.read_text()
    values = json.loads(kept)
    environment = values["environment"]
    environment.update(cma="0.1", pymoo="0.1", scipy="0.1", python=environment["python"] + "9")
    path.write_text(json.dumps(values))
    try:
        # Pattern searches and grids need none of them.
        assert run(*KINDS[kind][1]) == (2 if kind == "calibration" else 0)
        assert ("with scipy 0.1, this is" in capsys.readouterr().err) == (kind == "calibration")
    finally:
        path.write_text(kept)


@pytest.mark.parametrize(
    ("method", "package"), [("cma-es", "cma"), ("de", "pymoo"), ("direct", "scipy")]
)
def test_the_package_of_a_method_is_compared(
    analytic: ModuleType, tmp_path: Path, method: str, package: str
) -> None:
    optimize(
        analytic.AnalyticModel(), "R01", method=method, budget=9, folder=tmp_path / "s"
    ).close()
    path = tmp_path / "s" / "settings.json"
    values = json.loads(path.read_text())
    values["environment"][package] = "0.1"
    path.write_text(json.dumps(values))
    with pytest.raises(InputError, match=f"was made with {package} 0.1, this is [0-9]"):
        resume(tmp_path / "s", model=analytic.AnalyticModel(), budget=12)


def test_no_kind_resumes_another(made: tuple[str, Path], monkeypatch: Any, capsys: Any) -> None:
    kind, place = made
    monkeypatch.chdir(place)
    for other, (_, command, _) in KINDS.items():
        if other != kind:
            assert run(*command) == 2
            assert capsys.readouterr().err == f'error: "s" is not a {other}: it is a {kind}.\n'


def test_outputs_are_written_while_the_folder_is_locked_and_drafts_are_removed(
    made: tuple[str, Path], monkeypatch: Any
) -> None:
    kind, place = made
    monkeypatch.chdir(place)
    # As a killed process leaves them.
    drafts = [place / "s" / name for name in (".designs-e0562839.png", ".settings-0123abcd.json")]
    mine = place / "s" / ".hidden.png"
    for path in (*drafts, mine):
        path.write_bytes(b"half")
    with figures_saved_under_a_lock():
        assert run(*KINDS[kind][1]) in (0, 1)
    assert {path.name for path in (place / "s").iterdir()} >= set(KINDS[kind][2])
    Lock(place / "s", kind).release()
    assert [path for path in drafts if path.exists()] == []
    assert mine.exists()
    mine.unlink()


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
