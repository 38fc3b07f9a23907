"""The commands and files of the how-tos, one after the other as a reader uses them."""

from __future__ import annotations

import re
import shlex
from pathlib import Path

import pytest
import typer

import flexor
from flexor import calibration
from flexor.cli.app import app
from flexor.model import Model, parse

PAGES = sorted((Path(__file__).resolve().parents[1] / "docs" / "how-to").glob("*.md"))
COMMAND = r"^ *flexor .*$"
# Searches stop early here: what is tested is that the commands work together.
BUDGET = "4"


def text(name: str) -> str:
    (page,) = (page for page in PAGES if page.stem == name)
    return page.read_text(encoding="utf-8")


def blocks(name: str, kind: str) -> list[str]:
    """Return the code of one kind in a page, without the indentation of lists."""
    found = re.findall(rf"^( *)```{kind}\n(.*?)^ *```", text(name), flags=re.DOTALL | re.MULTILINE)
    return [re.sub(rf"^{indent}", "", code, flags=re.MULTILINE) for indent, code in found]


def commands(name: str) -> list[list[str]]:
    lines = re.findall(COMMAND, text(name), flags=re.MULTILINE)
    return [shlex.split(line)[1:] for line in lines]


@pytest.fixture
def follow(flexor_in, tmp_path):
    """Run commands of a page in one folder, which is returned."""

    def run(name: str, chosen: slice = slice(None)) -> Path:
        for words in commands(name)[chosen]:
            short = ["--budget", BUDGET] if words[0] == "optimize" else []
            assert flexor_in(tmp_path, *words, *short) == 0, words
        return tmp_path

    return run


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_every_command_has_its_options(page: Path) -> None:
    group = typer.main.get_command(app)
    assert commands(page.stem)
    for words in commands(page.stem):
        group.commands[words[0]].make_context(words[0], words[1:])


def test_own_finger(follow, capsys) -> None:
    follow("own-finger", slice(2))
    (code,) = blocks("own-finger", "python")
    capsys.readouterr()
    exec(compile(code, "own-finger.md", "exec"), {})
    assert capsys.readouterr().out.startswith("0.0412")  # m: 4.5 cm * 17.7 / 19.33


def test_own_actuator(follow) -> None:
    folder = follow("own-actuator", slice(1))
    (section,) = blocks("own-actuator", "toml")
    file = (folder / "actuator.toml").read_text(encoding="utf-8")
    changed, times = re.subn(r"^section = .*\n", section, file, flags=re.MULTILINE)
    assert times == 1
    Model(parse(changed)).equilibrium("0:20:20 kPa")


def test_calibrate() -> None:
    # What precedes the fit is in tests/export, fits are in tests/calibration.
    (targets,) = blocks("calibrate", "toml")
    file = calibration.parse(targets, "targets.toml")
    assert [constant.name for constant in file.constant] == ["K_1"]
    (_, fit) = [words for words in commands("calibrate") if words[0] in ("bench", "calibrate")]
    flexor.load(fit[1], fit[fit.index("--variant") + 1])


def test_two_chambers(follow) -> None:
    follow("two-chambers", slice(1, 3))
    (tables,) = blocks("two-chambers", "toml")
    preset = Path(__file__).resolve().parents[1] / "examples" / "two-chambers.toml"
    assert tables in preset.read_text(encoding="utf-8")


def test_robust_design(follow, tmp_path) -> None:
    # Searches over tolerances, wearers and scenarios are in tests/scenarios.
    follow("robust-design", slice(2, 3))
    (variants,) = blocks("robust-design", "toml")
    with (tmp_path / "my-glove.toml").open("a", encoding="utf-8") as file:
        file.write("\n" + variants)
    model = flexor.load(tmp_path / "my-glove.toml")
    words = commands("robust-design")[3]
    assert set(words[words.index("--scenarios") + 1].split(",")) == set(model.variants)
    assert flexor.load(model.file, "weak-pump").file.evaluation.pressure == 48e3
