from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import pytest

from flexor.cli.app import main


@dataclass(frozen=True)
class Outcome:
    """Output and exit code of a command."""

    code: int
    out: str
    err: str

    @property
    def error(self) -> str:
        """The error message; checks that it is one sentence and the only output."""
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
        captured = capsys.readouterr()
        return Outcome(int(ended.value.code or 0), captured.out, captured.err)

    return run
