"""The table of solver options of a model file."""

from __future__ import annotations

import pickle

import pytest
from flexor.model.presets import locate

import flexor
from flexor.errors import InputError
from flexor.model import parse, presets

FINGER = locate("finger").read_text(encoding="utf-8")


def model(table: str) -> flexor.Model:
    return flexor.load(parse(f"{FINGER}\n[solver]\n{table}\n"))


def test_options_of_the_file_hold_unless_others_are_given() -> None:
    limited = model("max_iterations = 1")
    assert limited.equilibrium([0, 5]).status.tolist() == ["converged", "iteration-limit"]
    assert limited.equilibrium([0, 5], max_iterations=1000).converged.all()
    assert pickle.loads(pickle.dumps(limited)).equilibrium([0, 5]).status[1] == "iteration-limit"


def test_they_are_part_of_what_decides_results() -> None:
    hashes = {flexor.load(name).hash for name in ["finger"]}
    hashes |= {model(f"tolerance = {each}").hash for each in ("1e-9", "1e-8")}
    assert len(hashes) == 3
    assert "finger" in presets()


@pytest.mark.parametrize(
    ("table", "words"),
    [
        ("max_second = 1", 'unknown solver option "max_second" (did you mean "max_seconds"?)'),
        ("max_seconds = -1", "solver option max_seconds is -1.0: it must be above 0"),
        ("max_iterations = 1.5", "expected an integer from 1"),
        ('tolerance = "small"', "small"),
    ],
)
def test_wrong_options(table: str, words: str) -> None:
    with pytest.raises(InputError) as caught:
        model(table)
    assert words in str(caught.value)
