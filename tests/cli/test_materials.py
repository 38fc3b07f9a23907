from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from flexor.materials.library import find


@pytest.fixture
def specimen(tmp_path: Path) -> str:
    stretch = np.linspace(1.0, 2.5, 80)
    stress = find("dragon-skin-10").nominal_stress(stretch) / 1e3
    rows = [f"{100 * (x - 1)},{s}" for x, s in zip(stretch, stress, strict=True)]
    (tmp_path / "specimen.csv").write_text("\n".join(["strain (%),stress (kPa)", *rows]))
    return "specimen.csv"


def test_list(flexor) -> None:
    ran = flexor("materials")
    assert ran.code == 0
    assert "dragon-skin-10" in ran.out
    assert json.loads(flexor("materials", "--json").out)["paper"]["young_modulus"] == 6.5e9


def test_show_and_plot(flexor, tmp_path: Path) -> None:
    ran = flexor("materials", "dragon-skin-20", "--plot", "stress.svg")
    assert ran.code == 0
    assert ran.out.startswith("[materials.dragon-skin-20]\n")
    assert 'kind = "ogden"' in ran.out
    assert (tmp_path / "stress.svg").stat().st_size > 1000
    assert flexor("materials", "--plot", "all.png").code == 0


def test_unknown(flexor) -> None:
    assert "unknown material" in flexor("materials", "rubber").error
    assert "stress.txt" in flexor("materials", "--plot", "stress.txt").error


def test_calibrate_a_material(flexor, specimen, tmp_path: Path) -> None:
    ran = flexor("calibrate", specimen, specimen, "--name", "mine", "--out", "made")
    assert ran.code == 0
    assert "[materials.mine]" in ran.out
    assert "2 specimens" in ran.out
    assert (tmp_path / "made" / "material.toml").read_text() in ran.out
    assert (tmp_path / "made" / "material.png").exists()


def test_a_link_in_the_folder_is_replaced(flexor, specimen, tmp_path: Path) -> None:
    (tmp_path / "made").mkdir()
    (tmp_path / "precious.toml").write_text("precious")
    (tmp_path / "made" / "material.toml").symlink_to(tmp_path / "precious.toml")
    assert flexor("calibrate", specimen, "--law", "yeoh", "--out", "made").code == 0
    assert (tmp_path / "precious.toml").read_text() == "precious"
    assert not (tmp_path / "made" / "material.toml").is_symlink()


def test_calibrate_one_law_as_json(flexor, specimen) -> None:
    ran = flexor("calibrate", specimen, "--law", "yeoh", "--strains", "0:1", "--json")
    found = json.loads(ran.out)
    assert [each["law"] for each in found["fits"]] == ["yeoh"]
    assert found["material"]["c1"] == pytest.approx(23929.0, rel=0.05)
    assert found["material"]["stretch_range"][1] == pytest.approx(2.0)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("nothing.csv",), "no such file"),
        (("specimen.csv", "--law", "gent"), "unknown law"),
        (("specimen.csv", "--strains", "1:0"), "expected MIN:MAX"),
        (("specimen.csv", "--strains", "a:b"), "expected MIN:MAX"),
        (("specimen.csv", "--strains", "5:6"), "no common strains"),
        (("specimen.csv", "--name", "a b"), "--name"),
        (("finger",), "one file TARGETS"),
        (("finger", "x.toml", "--law", "yeoh"), "tensile tests"),
    ],
)
def test_invalid(flexor, specimen, arguments: tuple[str, ...], words: str) -> None:
    assert words in flexor("calibrate", *arguments).error
