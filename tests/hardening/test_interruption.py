"""Ctrl-C ends every command and every call at once, and leaves what can be resumed."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import flexor
from flexor.cli.interruption import interruptions_not_ignored
from flexor.design import parameter_set
from flexor.errors import InputError
from flexor.study import Study

pytestmark = [
    pytest.mark.usefixtures("interruptible"),
    pytest.mark.skipif(sys.platform == "win32", reason="signals of POSIX"),
]
LONG = "0:5:0.002"  # 2,501 steps, of which a chunk of designs takes many seconds


def soon() -> float:
    """A second, twice as long for tests, and longer on a machine that others use [s]."""
    return 2.0 * max(1.0, os.getloadavg()[0] / (os.cpu_count() or 1))


@pytest.fixture(scope="module")
def model() -> Any:
    return flexor.load("finger")


@contextmanager
def interrupted(after: float = 0.3) -> Iterator[None]:
    """Send an interrupt, and see that it is raised soon."""
    timer = threading.Timer(after, os.kill, (os.getpid(), signal.SIGINT))
    timer.start()
    began = time.monotonic()
    try:
        with pytest.raises(KeyboardInterrupt):
            yield
    finally:
        timer.cancel()
    assert time.monotonic() - began < after + soon()


def many(model: Any, threads: int) -> Any:
    chosen = parameter_set("L", model.design)
    geometry = chosen.geometry(np.linspace(0.07, 0.12, 200)[:, None], model.X)
    return model.evaluate(geometry, LONG, threads)


CALLS: dict[str, Callable[[Any], Any]] = {
    "path": lambda model: model.equilibrium("0:5:0.00001"),
    "branch": lambda model: model.equilibrium("0:5:0.00001", follow="arc-length"),
    "evaluate, one thread": lambda model: many(model, 1),
    "evaluate, two threads": lambda model: many(model, 2),
    "optimize": lambda model: flexor.optimize(model, "R01", force=LONG),
    "compare": lambda model: flexor.compare(model, "R01", methods="ps,bfgs", seeds=2, force=LONG),
}


@pytest.mark.parametrize("name", CALLS)
def test_a_call_is_interrupted(model: Any, name: str) -> None:
    with interrupted():
        CALLS[name](model)
    # The next one is not.
    assert bool(model.equilibrium([0.0, 1.0]).converged.all())


def test_a_signal_without_an_exception_ends_nothing(model: Any) -> None:
    heard: list[int] = []
    before = signal.signal(signal.SIGUSR1, lambda number, _: heard.append(number))
    timer = threading.Timer(0.1, os.kill, (os.getpid(), signal.SIGUSR1))
    timer.start()
    try:
        path = model.equilibrium("0:5:0.0002")
    finally:
        timer.join()
        signal.signal(signal.SIGUSR1, before)
    assert heard == [signal.SIGUSR1]
    assert bool(path.converged.all())
    assert path.q.tobytes() == model.equilibrium("0:5:0.0002").q.tobytes()


TARGETS = """
[search]
samples = 400
starts = 4
[[constant]]
name = "E"
fields = ["exosuit.young_modulus"]
range = ["500 kPa", "8 MPa"]
[[target]]
name = "bend"
observable = "bending"
force = "0:5:0.0005"
value = "0.3 rad"
tolerance = "0.01 rad"
"""
STEPS = ("--force", "0:5:0.0002")
LOCAL = ("--cluster", "local:2")
COMMANDS: dict[str, tuple[str, ...]] = {
    "optimize": ("optimize", "finger", "-p", "R01", *STEPS),
    "landscape": ("landscape", "finger", "-p", "R01", *STEPS),
    "compare": ("compare", "finger", "-p", "R01", "--methods", "ps,cma-es", *STEPS),
    "calibrate": ("calibrate", "finger", "targets.toml"),
    "optimize on a cluster": ("optimize", "finger", "-p", "R01", *STEPS, *LOCAL),
    "compare on a cluster": ("compare", "finger", "-p", "R01", "--methods", "ps", *STEPS, *LOCAL),
}
MAIN = "from flexor.cli.app import main; main()"
# Says when it has imported what it needs to begin.
MAIN_SAYING_SO = (
    "import flexor.model; from flexor.cli.app import main; print('begun', flush=True); main()"
)


def begun(place: Path, *arguments: str, program: str = MAIN) -> subprocess.Popen[str]:
    """Start a command in a process, with a temporary folder of its own."""
    scratch = place / "tmp"
    scratch.mkdir()
    return subprocess.Popen(
        [sys.executable, "-c", program, *arguments],
        cwd=place,
        env={**os.environ, "TMPDIR": str(scratch), "COLUMNS": "300"},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )


@pytest.mark.parametrize("name", COMMANDS)
def test_a_command_is_interrupted_and_leaves_a_folder(tmp_path: Path, name: str) -> None:
    if LOCAL[0] in COMMANDS[name]:
        pytest.importorskip("distributed")
    (tmp_path / "targets.toml").write_text(TARGETS)
    process = begun(tmp_path, *COMMANDS[name], "--out", "s")
    until = time.monotonic() + 120.0
    while not (tmp_path / "s" / "settings.json").exists():
        assert process.poll() is None and time.monotonic() < until
        time.sleep(0.05)
    time.sleep(0.5)
    began = time.monotonic()
    process.send_signal(signal.SIGINT)
    _, said = process.communicate(timeout=60)
    assert time.monotonic() - began < soon()
    assert process.returncode == 130
    assert "Traceback" not in said
    assert "--resume s" in said
    assert not list((tmp_path / "tmp").iterdir())
    if name.startswith("optimize"):
        study = Study.open(tmp_path / "s")
        assert study.finished is None
        study.close()


class SignalsWhenCollected:
    def __del__(self) -> None:
        signal.raise_signal(signal.SIGINT)


def test_an_interruption_in_a_finaliser_is_not_lost() -> None:
    before = sys.unraisablehook
    began = time.monotonic()
    with pytest.raises(KeyboardInterrupt), interruptions_not_ignored():
        SignalsWhenCollected()
        time.sleep(60.0)
    assert time.monotonic() - began < soon()
    assert sys.unraisablehook is before


def test_a_simulation_says_that_it_was_interrupted(tmp_path: Path) -> None:
    words = ("simulate", "finger", "--force", "0:5:0.00001")
    process = begun(tmp_path, *words, program=MAIN_SAYING_SO)
    assert process.stdout is not None
    assert process.stdout.readline() == "begun\n"
    time.sleep(0.5 * soon())  # half a second to read the model, and as long to follow its path
    process.send_signal(signal.SIGINT)
    out, said = process.communicate(timeout=60)
    assert (process.returncode, out, said) == (130, "", "error: interrupted.\n")


def test_a_load_step_has_its_time(model: Any) -> None:
    path = model.equilibrium([0.0, 5.0], max_seconds=1e-9)
    assert path.status.tolist() == ["time-limit", "not-reached"]
    assert bool(model.equilibrium([0.0, 5.0], max_seconds=60.0).converged.all())
    with pytest.raises(InputError, match="max_seconds is 0: it must be above 0"):
        model.equilibrium([0.0], max_seconds=0)
