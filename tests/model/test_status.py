"""Every status of a load step is explained, in the documentation as in the messages."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import flexor
from flexor import _engine
from flexor.cli.path_report import report
from flexor.errors import InputError
from flexor.model import MEANINGS, Model, explained, parse, why_stalled

DOCS = Path(__file__).parents[2] / "docs"


def test_every_status_has_a_meaning_and_a_way_out() -> None:
    assert tuple(MEANINGS) == tuple(_engine.STATUS)
    for status in MEANINGS:
        assert re.fullmatch(rf"{status}: \w.*\w\. Remedy: \w.*\w\.", explained(status))


def test_the_documentation_lists_every_status_with_its_remedy() -> None:
    method = (DOCS / "method.md").read_text(encoding="utf-8")
    (section,) = re.findall(r"## Status of a load step\n(.*?)\n## ", method, flags=re.DOTALL)
    rows = re.findall(r"^\| `([\w-]+)` \| (.*) \| (.*) \|$", section, flags=re.MULTILINE)
    listed = {status: tuple(text.replace("`", "") for text in rest) for status, *rest in rows}
    assert listed == MEANINGS


def test_a_path_that_fails_says_what_to_do(capsys: pytest.CaptureFixture[str]) -> None:
    path = flexor.load("finger", "printed").equilibrium("0:50:25", max_iterations=20)
    assert "iteration-limit" in path.status
    assert path.status[-1] in ("iteration-limit", "not-reached")
    report(path)
    assert explained("iteration-limit") in capsys.readouterr().out.replace("\n", " ")


def test_statuses_that_random_designs_seldom_show() -> None:
    model = flexor.load("finger", "calibrated")
    slot = model.engine.slots["exosuit.length"][0]
    indices = np.array([slot])
    values = np.array([[0.1], [np.nan], [-1.0], [1e300]])
    found = model.engine.path(indices, values, np.array([[0.0], [1.0]]), 1)
    ends = [[_engine.STATUS[code] for code in row] for row in found["status"].tolist()]
    assert ends[0] == ["converged", "converged"]
    assert ends[1] == ends[2] == ["invalid-design", "invalid-design"]
    assert ends[3][0] in ("diverged", "invalid-design", "iteration-limit", "stalled")


@pytest.mark.parametrize("angle", [1e300, -2e6])
def test_a_placement_turned_beyond_all_accuracy_is_refused(angle: float, tmp_path: Path) -> None:
    model = flexor.load("finger", "calibrated")
    slots = np.arange(*model.engine.slots["ph_2.rotation"])
    values = np.array([[0.0, 0.1, 0.0], [0.0, angle, 0.0]])
    found = model.engine.path(slots, values, np.array([[0.0], [1.0]]), 1)
    ends = [[_engine.STATUS[code] for code in row] for row in found["status"].tolist()]
    assert ends == [["converged"] * 2, ["invalid-design"] * 2]
    (tmp_path / "turned.toml").write_text(
        'name = "turned"\n[bodies.a]\nkind = "link"\nlength = "1 cm"\nradius = "2 mm"\n'
        f'placement = {{ rotation = {{ y = "{angle} rad" }} }}\n'
    )
    with pytest.raises(InputError, match=r"a\.placement\.rotation: .*at most 1e6 rad"):
        flexor.load(tmp_path / "turned.toml")


def test_a_load_that_turns_with_its_body_is_named_where_no_equilibrium_is_found() -> None:
    text = """
name = "arm"
[bodies.arm]
kind = "link"
length = "10 cm"
radius = "5 mm"
joint = { kind = "spherical", stiffness = "0.1 N*m/rad" }
[wrenches.twist]
body = "arm"
at = "tip"
moment = { y = "0.01 N*m" }
frame = "body"
"""
    path = Model(parse(text)).equilibrium([0.0])
    stalled = replace(path, status=np.array(["stalled"]), residual=np.array([0.2]))
    assert "wrenches.twist turns with its body" in why_stalled(stalled)
