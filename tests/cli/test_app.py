from __future__ import annotations

from importlib.metadata import version

import pytest


def test_version(flexor) -> None:
    ran = flexor("--version")
    assert (ran.code, ran.out.strip()) == (0, f"flexor {version('flexor')}")


def test_without_a_command_the_help_is_printed(flexor) -> None:
    ran = flexor()
    assert ran.code == 0
    for command in ("simulate", "optimize", "presets", "sets"):
        assert command in ran.out


@pytest.mark.parametrize("command", ["simulate", "optimize", "presets", "sets"])
def test_every_command_has_help(flexor, command: str) -> None:
    ran = flexor(command, "--help")
    assert ran.code == 0
    assert f"Usage: flexor {command}" in ran.out


@pytest.mark.parametrize("command", ["simulate", "optimize"])
def test_help_has_examples(flexor, command: str) -> None:
    assert f"flexor {command} finger" in flexor(command, "--help").out


def test_presets_lists_every_model_with_its_constants(flexor) -> None:
    ran = flexor("presets")
    assert ran.code == 0
    for word in ("finger", "finger-2-links", "exosuit-alone", "printed", "surface (default)"):
        assert word in ran.out


def test_sets_lists_parameters_in_their_units_and_objectives(flexor) -> None:
    ran = flexor("sets", "finger")
    assert ran.code == 0
    (line,) = (line.split() for line in ran.out.splitlines() if " R_0 " in line)
    assert line == ["R01", "R_0", "cm", "0.4", "1.16", "1.2"]
    assert "bending" in ran.out and "tip-force" in ran.out
    assert "pattern-search" in ran.out


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["simulat", "finger"], "simulat"),
        (["simulate"], "MODEL"),
        (["simulate", "finger", "--forces", "1"], "--forces"),
        (["optimize", "finger", "--seed", "-1"], "--seed"),
        (["sets", "fingr"], 'did you mean "finger"'),
    ],
)
def test_bad_usage_gets_one_sentence(flexor, arguments: list[str], words: str) -> None:
    ran = flexor(*arguments)
    assert words in ran.refusal


def test_reproduce_says_where_it_went_and_is_not_listed(flexor) -> None:
    ran = flexor("reproduce", "--only", "fig4", "--out", "here")
    assert "is now `./dev reproduce`" in ran.refusal
    assert "reproduce" not in flexor("--help").out
