from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import pytest

from flexor.cli.app import main


@dataclass(frozen=True)
class Outcome:
    """What a run of the command line printed, and how it ended."""

    code: int
    out: str
    err: str

    @property
    def refusal(self) -> str:
        """The one sentence with which input was refused, and nothing else was said."""
        assert self.code == 2
        assert self.out == ""
        assert self.err.startswith("error: ")
        assert self.err.endswith((".\n", "?\n"))
        assert self.err.count("\n") == 1
        return self.err


Run = Callable[..., Outcome]


@pytest.fixture
def flexor(capsys, monkeypatch, tmp_path) -> Run:
    """Return a function that runs `flexor` in an empty folder."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "120")
    monkeypatch.setenv("NO_COLOR", "1")

    def run(*arguments: str) -> Outcome:
        with pytest.raises(SystemExit) as ended:
            main([str(argument) for argument in arguments])
        said = capsys.readouterr()
        return Outcome(int(ended.value.code or 0), said.out, said.err)

    return run
