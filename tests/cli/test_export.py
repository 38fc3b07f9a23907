"""`flexor export`: files, refusals and extras that are missing."""

from __future__ import annotations

import json
import sys
from pathlib import Path

import pytest
import trimesh


def test_a_kit_has_all_parts_and_one_page(flexor, tmp_path: Path) -> None:
    done = flexor("export", "pneumatic-finger", "--mould", "kit", "--json")
    assert done.code == 0, done.err
    found = json.loads(done.out)
    names = {Path(file).name for file in found["files"]}
    assert names == {path.name for path in (tmp_path / "kit").iterdir()}
    assert {"lower.stl", "upper.stl", "core-chamber.stl", "sheets.dxf"} < names
    page = (tmp_path / "kit" / "instructions.html").read_text()
    assert "Do not load it beyond 60 kPa" in page
    assert page.count("<li>") >= 10
    assert "http" not in page.replace("http://www.w3.org", "").replace(
        "http://purl.org", ""
    ).replace("http://creativecommons.org", "").replace("https://matplotlib.org", "")


def test_a_recorded_design_is_exported_by_its_number(flexor, tmp_path: Path) -> None:
    options = ("--budget", "4", "--method", "pattern-search", "--out", "study")
    vary = ("--vary", "exosuit.length=8 cm:11 cm", "--maximise", "range-of-motion")
    assert flexor("optimize", "pneumatic-finger", *vary, *options).code in (0, 1)
    assert flexor("export", "study", "--body", "best.stl").code == 0
    assert flexor("export", "study", "--design", "2", "--body", "second.stl").code == 0
    from flexor.study import Study

    study = Study.open(tmp_path / "study")
    lengths = 1e3 * study.record.designs()[:, 0]
    study.close()
    mesh = trimesh.load_mesh(tmp_path / "second.stl")
    assert mesh.extents[0] == pytest.approx(lengths[1] + 10.0, abs=1e-3)
    assert (
        "has no design 99" in flexor("export", "study", "--design", "99", "--body", "x.stl").error
    )


def test_a_design_of_a_parameter_set_has_its_surface(flexor, tmp_path: Path) -> None:
    options = ("--budget", "3", "--out", "study", "--method", "pattern-search")
    flexor("optimize", "finger", "-p", "L+R01", "-o", "bending", *options)
    assert flexor("export", "study", "--design", "1", "--body", "first.stl").code == 0
    mesh = trimesh.load_mesh(tmp_path / "first.stl")
    assert mesh.extents == pytest.approx((100.0, 23.2, 23.2), rel=1e-3)


def test_files_are_overwritten_by_force_only(flexor, tmp_path: Path) -> None:
    assert flexor("export", "finger", "--body", "a.stl").code == 0
    before = (tmp_path / "a.stl").read_bytes()
    assert (
        '"a.stl" exists: --force overwrites it.'
        in flexor("export", "finger", "--body", "a.stl").error
    )
    assert flexor("export", "finger", "--body", "a.stl", "--force").code == 0
    assert (tmp_path / "a.stl").read_bytes() == before
    (tmp_path / "kit").mkdir()
    (tmp_path / "kit" / "mine.txt").write_text("mine")
    assert '"kit" is not empty' in flexor("export", "finger", "--mould", "kit").error


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        ((), "nothing to export"),
        (("--body", "a.obj"), "its name must end in .stl or .3mf or .step or .stp"),
        (("--body", "no/a.stl"), 'no folder "no"'),
        (("--body", "a.stl", "--design", "2"), "--design is for a study folder"),
        (("--body", "a.stl", "--rod", "exo"), 'unknown rod "exo"'),
        (("--body", "a.stl", "--cap", "5"), "--cap is"),
        (("--mould", "kit", "--wall", "0 mm"), '--wall is "0 mm": it must be above 0.'),
        (("--mould", "kit", "--shrinkage", "1.5"), "--shrinkage is 1.5"),
        (("--mould", "kit", "--draft", "40 deg"), "must be at most 20 deg"),
    ],
)
def test_bad_input_is_refused_in_one_sentence(flexor, arguments, sentence: str) -> None:
    assert sentence in flexor("export", "finger", *arguments).error


def test_a_body_without_anything_to_cut_has_no_sheets(flexor, tmp_path: Path) -> None:
    ran = flexor("export", "finger", "--sheets", "a.dxf")
    assert ran.code == 2
    work, sentence = ran.err.splitlines()
    assert work == "making the body …"
    assert sentence == 'error: the model "finger" has no layers and no straps to be cut.'
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("package", ["manifold3d", "trimesh"])
def test_a_missing_extra_names_the_command(flexor, monkeypatch, package: str) -> None:
    monkeypatch.setitem(sys.modules, package, None)
    error = flexor("export", "finger", "--body", "a.stl").error
    assert f"need the package {package}, which is not installed" in error
    assert "install" in error and '"flexor[make]"' in error


def test_the_limit_names_every_input() -> None:
    import flexor
    from flexor.export import body, device_of
    from flexor.export.instructions import _limits

    model = flexor.load("two-chambers")
    path = model.equilibrium({"proximal": [0.0, 10e3], "distal": [0.0, 5e3]})
    ((_, text), *_) = _limits(body(device_of(model)), path)
    assert text.startswith("Do not load it beyond 10 kPa (proximal), 5 kPa (distal), up to")
