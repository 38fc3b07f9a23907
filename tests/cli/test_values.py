from __future__ import annotations

import pytest

from flexor.cli.values import assignments, numbers
from flexor.errors import InputError


def test_assignments_are_read() -> None:
    pairs = ["exosuit.length = 8 cm", "a.b=1"]
    assert assignments("--set", pairs, "a=1") == {"exosuit.length": "8 cm", "a.b": "1"}


@pytest.mark.parametrize("pairs", [["length"], ["=8 cm"], ["length="], ["a=1", "a=2"]])
def test_bad_assignments_get_one_sentence(pairs: list[str]) -> None:
    with pytest.raises(InputError, match=r"^--set .*\.$"):
        assignments("--set", pairs, "a=1")


def test_numbers_are_whole_where_they_are_written_so() -> None:
    read = numbers("--option", ["starts=8", "tolerance=1e-4", "shift=-3"])
    assert read == {"starts": 8, "tolerance": 1e-4, "shift": -3}
    assert isinstance(read["starts"], int)


def test_a_word_is_not_a_number() -> None:
    with pytest.raises(InputError, match='starts = "many": expected a number'):
        numbers("--option", ["starts=many"])
