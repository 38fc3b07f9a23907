from __future__ import annotations

import pytest


def test_one_item(flexor, tmp_path) -> None:
    ran = flexor("reproduce", "--only", "fig3", "--out", "here", "--docs", "found.md")
    assert ran.code == 0, ran.err
    assert ran.err == ""
    assert "Fig. 3: the exosuit alone, on two links and on three" in ran.out
    assert "report: here/report.html" in ran.out
    assert "findings: found.md" in ran.out
    for name in ("here/report.html", "here/figures/fig3.svg", "here/tables/fig3.csv", "found.md"):
        assert (tmp_path / name).stat().st_size > 500
    again = flexor("reproduce", "--out", "here", "--resume", "--seed", "0")
    assert again.code == 0, again.err
    assert "1 item in" in again.out


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--only", "fig33"], 'unknown item of the study "fig33" (did you mean "fig3"?)'),
        (["--only", ","], "no item of the study is named"),
        (["--only", "optimizers"], 'did you mean "optimisers"'),
        (["--constants", "calibratd"], 'unknown set of constants "calibratd" (did you mean'),
        (["--resume"], 'there is nothing to resume in "reproduction"'),
        (["--resume", "--seed", "1"], 'there is nothing to resume in "reproduction"'),
        (["--out", "file"], "is not an empty folder"),
        (["--seed", "-1"], "greater than or equal to 0"),
    ],
)
def test_bad_input_gets_one_sentence(flexor, tmp_path, arguments: list[str], words: str) -> None:
    (tmp_path / "file").write_text("")
    ran = flexor("reproduce", *arguments)
    assert words in ran.error
