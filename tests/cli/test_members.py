"""Folders of several studies, of choices and of sizes, are taken where one study is."""

from __future__ import annotations

import json
import shutil
from pathlib import Path
from typing import Any

import pytest

import flexor
from flexor.cli.app import main
from flexor.errors import InputError
from flexor.study import Study
from flexor.study.wearers_served import served

VARY = ["--vary", "exosuit.section.wall=1.5 mm:3 mm", "--maximise", "range-of-motion"]
COARSE = [
    *("--set", "exosuit.elements=8", "--set", "proximal.at=0.25", "--set", "middle.at=0.625"),
    *("--set", "distal.at=0.875"),
]


def run(*words: object) -> Any:
    with pytest.raises(SystemExit) as ended:
        main([str(each) for each in words])
    return ended.value.code


@pytest.fixture(scope="module")
def folders(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    place = tmp_path_factory.mktemp("studies")
    words = ["optimize", "pneumatic-finger", *VARY, *COARSE, "--json"]
    chosen = ["--choose", "middle=without,with", "--budget", 24, "--out", place / "choices"]
    assert not run(*words, *chosen)
    sizes = ["--wearers", 4, "--sizes", 2, "--budget", 6, "--out", place / "sizes"]
    assert not run(*words, *sizes, "--plot", place / "sizes.svg")
    return {each: place / each for each in ("choices", "sizes")}


def best(folder: Path) -> Path:
    """Return the study that has to be meant, from what each of them says itself."""
    if folder.name == "choices":
        found = {each: Study.open(folder / each).best for each in ("1", "2")}
        return folder / min(found, key=lambda each: (found[each].violation, found[each].value))
    rows = json.loads((folder / "sizes.json").read_text())["sizes"]
    return folder / str(max(rows, key=lambda row: len(row["wearers"]))["study"])


def test_sizes_are_drawn_with_whom_they_serve(folders: dict[str, Path]) -> None:
    drawn = folders["sizes"].with_suffix(".svg").read_text()
    rows = json.loads((folders["sizes"] / "sizes.json").read_text())["sizes"]
    for i, row in enumerate(rows, start=1):
        assert f"serves {len(row['wearers'])} of 4" in drawn
        assert f"size {i}: bends" in drawn


@pytest.mark.parametrize("kind", ["choices", "sizes"])
def test_every_command_means_the_best(
    kind: str, folders: dict[str, Path], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = folders[kind]
    expected = Study.open(best(folder))
    capsys.readouterr()
    assert not run("front", folder, "--json")
    assert Path(json.loads(capsys.readouterr().out)["folder"]) == expected.folder
    assert not run("front", folder, "--point", 1, "--save", tmp_path / "best.toml")
    saved = flexor.load(tmp_path / "best.toml")
    wall = saved.file.rod("exosuit").section.wall
    assert float(getattr(wall, "value", wall)) == pytest.approx(expected.best.vector[0], rel=1e-12)
    assert not run("share", folder, "--out", tmp_path / "page.html")
    capsys.readouterr()
    assert not run("rerun", folder, "--json")
    repeated = json.loads(capsys.readouterr().out)
    assert repeated["same"] and repeated["evaluations"] == expected.evaluations


def test_a_shared_size_says_whom_it_serves(folders: dict[str, Path], tmp_path: Path) -> None:
    """As `sizes.json` has it, which the page repeats in a sentence and a list."""
    found = json.loads((folders["sizes"] / "sizes.json").read_text())
    total = sum(row["weight"] for row in found["sizes"])
    for row in found["sizes"]:
        file = tmp_path / f"{row['study']}.html"
        number = row["study"].removeprefix("size-")
        assert not run("share", folders["sizes"], "--design", number, "--out", file)
        data = file.read_text().split('id="data">')[1].split("</script>")[0]
        sentence, wearers = json.loads(data)["serves"]
        assert wearers == row["wearers"]
        share = row["weight"] / total * found["served"] if total else 0.0
        many = f"{len(wearers)} wearer{'' if len(wearers) == 1 else 's'}"
        assert sentence.startswith(f"Size {number} serves {many}, {100 * share:.0f} % of all")
    assert served(Study.open(folders["choices"] / "1")) is None


def test_a_damaged_list_of_wearers_is_refused(folders: dict[str, Path], tmp_path: Path) -> None:
    copied = tmp_path / "sizes"
    shutil.copytree(folders["sizes"], copied)
    for text in ("{", "[]", '{"sizes": [{"study": "size-1"}], "served": 1}'):
        (copied / "sizes.json").write_text(text)
        with pytest.raises(InputError, match=r"sizes.json.* it is damaged"):
            served(Study.open(copied / "size-1"))


@pytest.mark.parametrize(
    ("kind", "name", "study"),
    [("choices", "1", "1"), ("choices", "without middle", "1"), ("choices", "with middle", "2"),
     ("sizes", "1", "size-1"), ("sizes", "size-1", "size-1")],
)  # fmt: skip
def test_another_is_named(
    kind: str, name: str, study: str, folders: dict[str, Path], capsys: pytest.CaptureFixture[str]
) -> None:
    capsys.readouterr()
    assert not run("front", folders[kind], "--design", name, "--json")
    assert Path(json.loads(capsys.readouterr().out)["folder"]) == folders[kind] / study


def test_export_takes_it(folders: dict[str, Path], tmp_path: Path) -> None:
    pytest.importorskip("manifold3d")
    for words in ([], ["--design", "with middle"]):
        assert not run(
            "export", folders["choices"], *words, "--body", tmp_path / f"{len(words)}.stl"
        )
    assert (tmp_path / "0.stl").stat().st_size > 1000


@pytest.mark.parametrize(
    ("kind", "name", "message"),
    [
        ("choices", "with midle", 'no combination "with midle": it has'),
        ("choices", "../sizes/size-1", 'no combination "../sizes/size-1"'),
        ("sizes", "9", 'no size "9": it has "size-'),
    ],
)
def test_what_there_is_not(
    kind: str,
    name: str,
    message: str,
    folders: dict[str, Path],
    capsys: pytest.CaptureFixture[str],
) -> None:
    assert run("front", folders[kind], "--design", name) == 2
    assert message in " ".join(capsys.readouterr().err.split())


def test_a_study_is_no_folder_of_several(
    folders: dict[str, Path], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run("rerun", folders["choices"] / "1", "--design", "1") == 2
    assert "--design is for a folder of --choose or --sizes" in " ".join(
        capsys.readouterr().err.split()
    )
    for text in ('{"tried": [{"study": "../elsewhere", "name": "a"}]}', "[]", "{"):
        (tmp_path / "choices.json").write_text(text)
        assert run("front", tmp_path) == 2
        assert "it is damaged" in " ".join(capsys.readouterr().err.split())


def test_searches_that_have_not_ended_have_no_best(
    folders: dict[str, Path], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "1").mkdir()
    (tmp_path / "choices.json").write_text(json.dumps({"format": 1, "statement": {"given": {}}}))
    assert run("share", tmp_path, "--out", tmp_path / "page.html") == 2
    said = " ".join(capsys.readouterr().err.split())
    assert "have not ended: resume them by flexor optimize --resume" in said
    assert "or give --design, one of 1." in said
