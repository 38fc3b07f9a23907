"""The commands of the tutorial, one after the other as a reader runs them."""

from __future__ import annotations

import re
import shlex
from pathlib import Path

import pytest

PAGE = Path(__file__).resolve().parents[1] / "docs" / "tutorial.md"
COMMANDS = re.findall(r"^flexor .*$", PAGE.read_text(encoding="utf-8"), flags=re.MULTILINE)
# Searches stop early here: what comes after them needs a study, not the optimum.
BUDGET = "30"


def test_its_commands_run(flexor_in, tmp_path) -> None:
    pytest.importorskip("manifold3d")
    assert len(COMMANDS) == 9
    for command in COMMANDS:
        words = shlex.split(command)[1:]
        if words[0] == "optimize":
            words = [word for word in words if word not in ("--budget", "500")]
            words += ["--budget", BUDGET]
        assert flexor_in(tmp_path, *words) == 0, command
    for made in ("bent.png", "first.html", "mould/instructions.html", "mould/body.stl"):
        assert (tmp_path / made).stat().st_size > 1000, made
