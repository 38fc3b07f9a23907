"""Every validation case, as `flexor validate` runs it; those of other libraries where these are."""

from __future__ import annotations

from importlib.util import find_spec
from pathlib import Path

import pytest

from flexor.validate import Case, cases, run

ROOT = Path(__file__).resolve().parents[2]
REPORT = ROOT / "docs" / "validation.md"


@pytest.mark.parametrize("case", cases(), ids=lambda case: case.name)
def test_case(case: Case) -> None:
    if case.library is not None and find_spec(case.library.module) is None:
        pytest.skip(f"{case.library.package} is not installed")
    result = run(case)
    assert result.outcome is not None, result.reason
    off = [found for found in result.outcome.comparisons if not found.passed]
    assert not off, "\n".join(map(str, off))


def test_names_are_unique() -> None:
    names = [case.name for case in cases()]
    assert len(set(names)) == len(names) >= 20


def test_cases_say_what_their_reference_is() -> None:
    assert all(len(case.about) > 80 and case.title for case in cases())


def test_the_report_holds_every_case_and_its_figures() -> None:
    text = REPORT.read_text(encoding="utf-8")
    for case in cases():
        assert f"\n### {case.name}\n" in text
    images = [part.split(")")[0] for part in text.split("](images/")[1:]]
    assert len(images) >= 10
    for image in images:
        assert (REPORT.parent / "images" / image).stat().st_size > 5_000
    assert "**failed**" not in text
    assert "Skipped:" not in text
