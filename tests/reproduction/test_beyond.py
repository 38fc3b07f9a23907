"""The paper's finger with what its discussion leaves out: models, and the page of a quick run."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from reproduction.beyond.__main__ import main
from reproduction.beyond.cases import CASES, followed
from reproduction.study import model, published_design

ROOT = Path(__file__).parents[2]


def test_without_additions_it_is_the_finger_of_the_study() -> None:
    ours, theirs = followed(CASES["paper"]), model().equilibrium()
    np.testing.assert_array_equal(ours.joint_angles, theirs.joint_angles)


def test_two_halves_with_one_force_are_the_paper_s_exosuit() -> None:
    halves = followed(CASES["curl"])
    np.testing.assert_allclose(
        halves.joint_angles, model().equilibrium().joint_angles, rtol=0.0, atol=1e-6
    )


@pytest.mark.parametrize("name", ["pin", "slider", "weld"])
def test_ties_strain_nothing_at_rest_whatever_the_radii(name: str) -> None:
    for design in (None, published_design("R01")):
        path = followed(CASES[name], design)
        assert path.converged.all()
        np.testing.assert_allclose(path.joint_angles[0], 0.0, atol=1e-9)
        assert path.tie_forces()["tips"][0] == pytest.approx(0.0, abs=1e-6)


def test_sizes_are_those_of_the_survey() -> None:
    lengths = {
        name: float(CASES[name].model().file.bodies["ph_1"].length)
        for name in ("small", "mean", "large")
    }
    # Those of the survey itself are 177 and 210 mm of 193.3 mm, to the millimetre.
    assert lengths["small"] / lengths["mean"] == pytest.approx(177.0 / 193.3, abs=0.003)
    assert lengths["large"] / lengths["mean"] == pytest.approx(210.0 / 193.3, abs=0.003)


def test_the_command_resumes_and_refuses(tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    given = ["--quick", "--what", "paper,weld", "--out", str(tmp_path / "out")]
    assert main(given) == 0
    assert main(given) == 0
    assert {path.stem for path in (tmp_path / "out" / "results").iterdir()} == {"paper", "weld"}
    assert main(["--what", "welds"]) == 2
    assert 'unknown case "welds"' in capsys.readouterr().err
    assert main(["--write", "--quick"]) == 2


def test_every_case_is_on_the_page() -> None:
    page = (ROOT / "docs" / "beyond.md").read_text(encoding="utf-8")
    assert all(f"| {case.title} |" in page for case in CASES.values())
