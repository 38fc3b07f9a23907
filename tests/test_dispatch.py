"""Which build of the engine is imported."""

from __future__ import annotations

import os
import subprocess
import sys
from types import SimpleNamespace

import pytest

from flexor import _dispatch
from flexor._dispatch import ENGINES, engine_path, load_engine
from flexor.errors import InputError


@pytest.fixture
def installed(monkeypatch: pytest.MonkeyPatch):
    """Pretend that these builds are installed, on a processor that runs some of the fast ones."""

    def pretend(*names: str, runs: str = "", fused: bool = False) -> None:
        def find(module: str) -> object | None:
            return module.removeprefix("flexor._engine_") in names or None

        def build(name: str) -> SimpleNamespace:
            assert name in ("baseline", "native") or name in runs, "this processor would stop here"
            return SimpleNamespace(
                __name__=f"flexor._engine_{name}",
                FUSED_MULTIPLY_ADD=fused,
                cpu_runs=runs.split,
            )

        monkeypatch.setattr(_dispatch, "find_spec", find)
        monkeypatch.setattr(_dispatch, "_build", build)
        monkeypatch.setattr(_dispatch, "load_engine", load_engine.__wrapped__)

    monkeypatch.delenv("FLEXOR_ENGINE", raising=False)
    return pretend


@pytest.mark.parametrize(
    ("names", "runs", "chosen"),
    [
        (["baseline", "avx2", "avx512"], "avx512 avx2", "avx512"),
        (["baseline", "avx2", "avx512"], "avx2", "avx2"),
        (["baseline", "avx2", "avx512"], "", "baseline"),
        (["baseline", "avx2"], "avx512 avx2", "avx2"),
        (["baseline"], "avx2", "baseline"),
        (["native"], "", "native"),
        (["native", "avx2", "baseline"], "avx2", "native"),
    ],
)
def test_the_fastest_build_that_runs_is_chosen(installed, names, runs: str, chosen: str) -> None:
    installed(*names, runs=runs)
    assert engine_path() == chosen


def test_a_baseline_compiled_for_more_is_not_called_so(installed) -> None:
    installed("baseline", fused=True)
    assert engine_path() == "native"


@pytest.mark.parametrize("name", ["baseline", "avx2", "avx512"])
def test_a_build_can_be_forced(installed, monkeypatch: pytest.MonkeyPatch, name: str) -> None:
    installed("native", "avx512", "avx2", "baseline", runs="avx512 avx2")
    monkeypatch.setenv("FLEXOR_ENGINE", name)
    assert engine_path() == name


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("fast", 'expected one of "native", "avx512", "avx2", "baseline"'),
        ("native", "not installed here (there is: avx2, baseline)"),
        ("avx2", "this processor cannot run (it runs: baseline)"),
    ],
)
def test_a_forced_build_that_cannot_be_had_is_explained(
    installed, monkeypatch: pytest.MonkeyPatch, name: str, words: str
) -> None:
    installed("avx2", "baseline")
    monkeypatch.setenv("FLEXOR_ENGINE", name)
    with pytest.raises(InputError) as told:
        engine_path()
    assert "FLEXOR_ENGINE" in str(told.value) and words in str(told.value)


def test_without_any_build_the_import_says_so(installed) -> None:
    installed()
    with pytest.raises(ImportError, match="without its compiled engine"):
        engine_path()


def test_the_command_line_explains_in_one_sentence() -> None:
    code = "from flexor.cli.app import main; main(['simulate', 'finger'])"
    done = subprocess.run(
        [sys.executable, "-c", code],
        env={**os.environ, "FLEXOR_ENGINE": "fast"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 2
    assert done.stderr.startswith("error: the environment variable FLEXOR_ENGINE is")
    assert "Traceback" not in done.stderr


def test_the_engine_in_use_is_one_of_them() -> None:
    from flexor import _engine

    assert engine_path() in ENGINES
    assert _engine is load_engine()
