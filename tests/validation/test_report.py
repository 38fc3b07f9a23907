"""The report says what passed, failed and was skipped; the committed one holds every case."""

from __future__ import annotations

import math
import re
from pathlib import Path

import pytest

from .comparison import Comparison, compare
from .report import FAMILIES, Case, load, write

DOCS = Path(__file__).resolve().parents[2] / "docs"


def _case(name: str, **fields) -> Case:
    return Case(name, f"The case {name}", "About it.", FAMILIES[0], **fields)


def test_a_comparison_that_is_off_fails_the_test() -> None:
    good, bad = compare("width", 1.0, 1.0, 1e-9), compare("length [m]", 1.0, 1.1, 1e-9)
    nan = Comparison("angle", 1.0, math.nan, math.nan, 1.0)
    _case("good").check([good])
    for comparisons in ([good, bad], [nan], []):
        with pytest.raises(AssertionError):
            _case("bad").check(comparisons)


def test_the_report_tells_everything(tmp_path: Path) -> None:
    good = _case("good", verdict="passed")
    good.check(
        [compare("length [m]", [1.0, 2.0], [1.0, 2.0], 1e-9)],
        lambda figure: figure.subplots().plot([0.0, 1.0]),
        "A line.",
    )
    bad = _case("bad", comparisons=[compare("length [m]", 1.0, 1.1, 1e-9)])
    missing = _case("missing", verdict="skipped", reason="a library is missing")
    broken = _case("broken", reason="ZeroDivisionError: nothing | to divide")
    text = write([good, bad, missing, broken], tmp_path / "docs").read_text(encoding="utf-8")
    assert "| [good](#good) | The case good | 1 | 0 % | passed |" in text
    assert "| [missing](#missing) | The case missing |  |  | skipped |" in text
    assert "| length [m] | 2 | 1 | 1 | 0.0e+00 | 1e-09 | passed |" in text
    assert "| length [m] | 1 | 1 | 1.1 | 1.0e-01 | 1e-09 | **failed** |" in text
    assert "Skipped: a library is missing." in text
    assert "Failed: ZeroDivisionError: nothing | to divide." in text
    assert "![The case good](images/validation/good.png)" in text
    assert (tmp_path / "docs" / "images" / "validation" / "good.png").stat().st_size > 1_000
    assert not (tmp_path / "docs" / "images" / "validation" / "bad.png").exists()


def test_a_library_that_is_missing_is_skipped_and_says_how_to_get_it() -> None:
    said = r'^nowhere is missing: .*pip install .*"flexor\[validate\]"$'
    with pytest.raises(pytest.skip.Exception, match=said):
        load("nowhere", "nowhere_at_all")


def test_the_committed_report_holds_every_case_and_its_figures() -> None:
    text = (DOCS / "validation.md").read_text(encoding="utf-8")
    headings = {line.removeprefix("### ") for line in text.splitlines() if line[:4] == "### "}
    here = Path(__file__).parent
    tests = "\n".join(path.read_text(encoding="utf-8") for path in here.glob("test_*.py"))
    found = re.findall(r"^def test_(\w+)\(case: Case\b", tests, re.MULTILINE)
    names = {name.replace("_", "-") for name in found}
    assert headings == names
    assert len(names) >= 22
    images = [part.split(")")[0] for part in text.split("](images/")[1:]]
    assert len(images) >= 10
    for image in images:
        assert (DOCS / "images" / image).stat().st_size > 5_000
    assert "**failed**" not in text
    assert "Skipped:" not in text
