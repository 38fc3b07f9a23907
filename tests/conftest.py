from __future__ import annotations

import importlib.util
import os
import signal
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from types import ModuleType

import pytest
from hypothesis import HealthCheck, settings

# As the command line does, before NumPy is imported.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

# How long drawing an example takes depends on what else the machine does.
settings.register_profile("fresh", deadline=None, suppress_health_check=[HealthCheck.too_slow])
settings.register_profile("same", settings.get_profile("fresh"), derandomize=True)
settings.load_profile("same")


@pytest.fixture(scope="session")
def analytic() -> ModuleType:
    """The module of a stand-in model whose paths are a formula."""
    path = Path(__file__).parent / "study" / "analytic.py"
    spec = importlib.util.spec_from_file_location("analytic_model", path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules["analytic_model"] = module
    spec.loader.exec_module(module)
    return module


@pytest.fixture
def interruptible() -> Iterator[None]:
    """Let child processes be interrupted even if these tests are not (``nohup ./dev test &``)."""
    # A child inherits that a signal is ignored, but not a handler.
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


@pytest.fixture
def flexor_in(monkeypatch: pytest.MonkeyPatch) -> Callable[..., int]:
    """Run commands in a folder, and return their exit codes."""
    from flexor.cli.app import main

    def run(folder: Path, *words: str) -> int:
        monkeypatch.chdir(folder)
        with pytest.raises(SystemExit) as ended:
            main(list(words))
        return int(ended.value.code or 0)

    return run
