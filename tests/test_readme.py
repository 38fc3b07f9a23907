"""What the README shows must work."""

from __future__ import annotations

import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent
DOCS = ROOT / "docs"
README = (ROOT / "README.md").read_text(encoding="utf-8")
COMMANDS = sorted(set(re.findall(r"^flexor .*$", README, flags=re.MULTILINE)))


def test_its_python_example_runs(tmp_path, monkeypatch) -> None:
    (code,) = re.findall(r"```python\n(.*?)```", README, flags=re.DOTALL)
    monkeypatch.chdir(tmp_path)
    names: dict[str, object] = {}
    exec(compile(code, "README.md", "exec"), names)
    assert names["path"].joint_angles.shape == (6, 3)
    assert (tmp_path / "designs.svg").stat().st_size > 10_000


@pytest.mark.parametrize("command", COMMANDS)
def test_its_commands_run(flexor_in, tmp_path, command: str) -> None:
    words = shlex.split(command)[1:]
    extra = ["--budget", "20"] if words[0] == "optimize" and "--help" not in words else []
    assert flexor_in(tmp_path, *words, *extra) == 0


@pytest.mark.parametrize("command", sorted(set(re.findall(r"\./dev (\w+)", README))))
def test_its_dev_commands_exist(command: str) -> None:
    told = subprocess.run(
        [sys.executable, ROOT / "dev", "--help"], capture_output=True, text=True, check=True
    )
    assert f"  {command} " in told.stdout


def test_continuous_integration_runs_its_test_command() -> None:
    script = (ROOT / ".ci" / "run").read_text(encoding="utf-8").splitlines()
    assert script[-1] == "exec ./dev test"
    assert "\n./dev test" in README


@pytest.mark.parametrize("page", [*ROOT.glob("*.md"), *DOCS.rglob("*.md")], ids=str)
def test_links_lead_somewhere(page: Path) -> None:
    for link in re.findall(r"\]\(([^)#:]+)(?:#[^)]*)?\)", page.read_text(encoding="utf-8")):
        assert (page.parent / link).exists(), link


def test_every_page_is_in_the_index() -> None:
    index = (DOCS / "index.md").read_text(encoding="utf-8")
    pages = {page.relative_to(DOCS).as_posix() for page in DOCS.rglob("*.md")} - {"index.md"}
    assert pages == set(re.findall(r"\]\(([^)#]+\.md)\)", index))
    site = (ROOT / "mkdocs.yml").read_text(encoding="utf-8")
    assert pages | {"index.md"} == set(re.findall(r"(\S+\.md)$", site, flags=re.MULTILINE))
