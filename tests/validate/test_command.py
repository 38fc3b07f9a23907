from __future__ import annotations

import math
from pathlib import Path

import pytest

from flexor import validate
from flexor.validate import CLOSED_FORM, Case, Outcome
from flexor.validate.case import Library, Unavailable
from flexor.validate.comparison import Comparison, compare


def _case(name: str, run) -> Case:
    return Case(name, f"The case {name}", CLOSED_FORM, "About it.", run)


def _good() -> Outcome:
    def draw(figure) -> None:
        figure.subplots().plot([0.0, 1.0])

    return Outcome((compare("length [m]", [1.0, 2.0], [1.0, 2.0], 1e-9),), draw, "A line.")


def _bad() -> Outcome:
    return Outcome((compare("length [m]", 1.0, 1.1, 1e-9), compare("width", 1.0, 1.0, 1e-9)))


def _undefined() -> Outcome:
    return Outcome((Comparison("length", 1.0, math.nan, math.nan, 1.0),))


def _missing() -> Outcome:
    raise Unavailable("a library is missing")


def _broken() -> Outcome:
    raise ZeroDivisionError("nothing | to divide")


@pytest.fixture
def flexor(monkeypatch, capsys):
    """Run the command line with the cases given."""
    from flexor.cli.app import main
    from flexor.validate import catalogue

    def run(cases: dict[str, object], *words: str):
        made = tuple(_case(name, function) for name, function in cases.items())
        monkeypatch.setattr(catalogue, "cases", lambda: made)
        with pytest.raises(SystemExit) as ended:
            main(["validate", *words])
        told = capsys.readouterr()
        return ended.value.code, told.out, told.err

    return run


def test_passing_cases_end_well(flexor) -> None:
    code, out, _ = flexor({"good": _good})
    assert code == 0
    assert "passed good: The case good" in out
    assert "length [m]" in out
    assert out.splitlines()[-1] == "1 passed"


@pytest.mark.parametrize("function", [_bad, _undefined, _broken])
def test_one_failure_ends_with_code_1_after_all_cases(flexor, function) -> None:
    code, out, _ = flexor({"first": function, "good": _good})
    assert code == 1
    assert "failed first" in out
    assert "passed good" in out
    assert out.splitlines()[-1] == "1 passed, 1 failed"


def test_a_missing_library_is_told_and_is_no_failure(flexor) -> None:
    code, out, _ = flexor({"missing": _missing, "good": _good})
    assert code == 0
    assert "skipped missing" in out
    assert "a library is missing" in out
    assert out.splitlines()[-1] == "1 passed, 1 skipped"


def test_cases_are_chosen_by_name(flexor) -> None:
    code, out, _ = flexor({"good": _good, "bad": _bad}, "--only", "good")
    assert code == 0
    assert "bad" not in out


def test_unknown_names_get_one_sentence(flexor) -> None:
    code, out, err = flexor({"good": _good}, "--only", "good,goood")
    assert (code, out) == (2, "")
    assert err == 'error: unknown case "goood" (did you mean "good"?): expected "good".\n'


def test_the_list_runs_nothing(flexor) -> None:
    code, out, _ = flexor({"bad": _bad}, "--list")
    assert code == 0
    assert "The case bad" in out


def test_the_report_tells_everything(flexor, tmp_path: Path) -> None:
    cases = {"good": _good, "bad": _bad, "missing": _missing, "broken": _broken}
    code, _, _ = flexor(cases, "--out", str(tmp_path / "docs"))
    assert code == 1
    text = (tmp_path / "docs" / "validation.md").read_text(encoding="utf-8")
    assert "| length [m] | 2 | 1 | 1 | 0.0e+00 | 1e-09 | passed |" in text
    assert "| length [m] | 1 | 1 | 1.1 | 1.0e-01 | 1e-09 | **failed** |" in text
    assert "Skipped: a library is missing." in text
    assert "Failed: ZeroDivisionError: nothing | to divide." in text
    assert "![The case good](images/validation/good.png)" in text
    assert (tmp_path / "docs" / "images" / "validation" / "good.png").stat().st_size > 1_000
    assert not (tmp_path / "docs" / "images" / "validation" / "bad.png").exists()


def test_a_folder_that_cannot_be_written_gets_one_sentence(flexor, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    code, _, err = flexor({"good": _good}, "--out", str(tmp_path / "file"))
    assert code == 2
    assert err.count("\n") == 1
    assert err.startswith("error: cannot write the report")


def test_a_library_that_is_missing_says_how_to_get_it() -> None:
    said = r'^nowhere is missing: .*pip install .*"flexor\[validate\]"$'
    with pytest.raises(Unavailable, match=said):
        Library("nowhere_at_all", "nowhere").load()


def test_public_names_exist() -> None:
    assert all(hasattr(validate, name) for name in validate.__all__)
