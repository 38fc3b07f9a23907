from __future__ import annotations

import json

import numpy as np
import pytest

SMALL = ("landscape", "finger", "--grid", "5")


def test_files_figure_and_sentences(flexor, tmp_path) -> None:
    flexor("optimize", "finger", "-p", "R01", "--budget", "10", "--out", "search", "--json")
    ran = flexor(*SMALL, "--study", "search", "--plot", "also.pdf")
    assert ran.code == 0
    assert ran.err in ("", "drawing the landscape …\n")  # said only where it takes long
    assert "5 × 5 designs in" in ran.out
    assert "Minimum of the grid at R_0 = " in ran.out
    folder = tmp_path / "studies" / "finger-R01-bending-landscape"
    for name in ("landscape.npz", "landscape.csv", "landscape.png", "landscape.svg"):
        assert (folder / name).stat().st_size > 1000
        assert f"file: {(folder / name).relative_to(tmp_path)}" in ran.out
    assert (tmp_path / "also.pdf").stat().st_size > 1000


def test_json_and_resume_tell_the_same(flexor) -> None:
    first = json.loads(flexor(*SMALL, "--out", "l", "--json").out)
    again = json.loads(flexor("landscape", "--resume", "l", "--json").out)
    assert first["designs"] == 25
    for key in ("axes", "minimum", "local_minima", "snapping", "failed", "folder"):
        assert first[key] == again[key]
    np.testing.assert_allclose(first["axes"]["R_0"], np.linspace(0.004, 0.012, 5))


def test_other_parameters_are_fixed_at_the_start(flexor) -> None:
    told = json.loads(
        flexor("landscape", "finger", "-p", "L+R01", "--axes", "L", "--start", "R_0=0.7 cm",
               "--grid", "3", "--force", "0:2:1", "--json").out
    )  # fmt: skip
    assert list(told["axes"]) == ["L"]
    assert told["minimum"]["parameters"]["R_0"] == pytest.approx(0.007)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ([], "give a MODEL"),
        (["fingr"], 'did you mean "finger"'),
        (["finger", "-p", "L+R01"], "choose one or two of them as axes"),
        (["finger", "--axes", "R_0,R_3"], "unknown parameter of the set R01"),
        (["finger", "--grid", "1"], "at least 2"),
        (["finger", "--objective", "f_c"], "unknown objective"),
        (["finger", "--start", "random"], "a landscape needs values"),
        (["finger", "--start", "R_0=2 cm"], "outside its bounds"),
        (["finger", "--study", "nowhere"], "is not a study"),
        (["finger", "--plot", "x.bmp"], "must end in"),
        (["finger", "--resume", "l"], "takes only the folder"),
        (["--resume", "nowhere"], "is not a landscape"),
    ],
)
def test_bad_input_gets_one_sentence(flexor, tmp_path, arguments: list[str], words: str) -> None:
    ran = flexor("landscape", *arguments)
    assert words in ran.error
    assert list(tmp_path.iterdir()) == []


def test_other_studies_are_rejected(flexor, tmp_path) -> None:
    flexor("optimize", "finger", "-p", "L", "--budget", "3", "--out", "s", "--json")
    ran = flexor(*SMALL, "--study", "s")
    assert '--study "s" searched L (L), but the landscape is of R01 (R_0, R_1)' in ran.error
    ran = flexor("landscape", "--resume", "s")
    assert '"s" is not a landscape: it is a study.' in ran.error
    assert [each.name for each in tmp_path.iterdir()] == ["s"]


def test_methods_are_listed(flexor) -> None:
    ran = flexor("methods")
    assert ran.code == 0
    for word in ("pattern-search", "cma-es", "mads", "nomad", "starts=1"):
        assert word in ran.out
