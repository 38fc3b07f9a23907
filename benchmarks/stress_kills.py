"""An optimisation killed at twenty random times and resumed after each, with an identical result.

The study is run once without interruption. Then it is started in a process that is killed (SIGKILL)
at a random time, resumed, killed again and so on, and finally completed. The exit code is 1 if any
design, result or bit of the record differs from the uninterrupted study, or if a kill lost more
than the batch that was being evaluated.
"""

from __future__ import annotations

import argparse
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Generator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from _machine import machine
from rich.console import Console
from rich.progress import track
from rich.table import Table

import flexor
from flexor.model import Paths
from flexor.model.chunks import chunks
from flexor.study import DesignEvaluator, Problem, Record, Study, optimize, resume


@dataclass(frozen=True)
class LoggingExecutor(DesignEvaluator):
    """Evaluates designs and logs every batch before its evaluation."""

    log: Path

    def parts(
        self, problem: Problem, designs: np.ndarray, gradient: bool = False
    ) -> Generator[Paths, None, None]:
        """Evaluate designs (n, k)."""
        for chunk in chunks(len(designs)):
            part = designs[chunk]
            with open(self.log, "a", encoding="ascii") as file:
                file.write(f"{len(part)}\n")
            yield problem.evaluate(part, 1, gradient)


def run(folder: Path, starts: int) -> None:
    """Start or resume the study."""
    executor = LoggingExecutor(folder.with_name(f"{folder.name}.log"))
    if (folder / "settings.json").exists():
        resume(folder, executor=executor).close()
        return
    optimize(
        flexor.load("finger", "calibrated"),
        "L+R01",
        start="random",
        seed=4,
        method_options={"starts": starts, "tolerance": 1e-4},
        folder=folder,
        executor=executor,
    ).close()


def main() -> int:
    """Kill and resume the study, and print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--kills", type=int, default=20)
    parser.add_argument(
        "--starts",
        type=int,
        default=16,
        help="starts of the search, which set the size of the study",
    )
    parser.add_argument("--seed", type=int, default=1, help="random seed of the times")
    parser.add_argument("--child", type=Path, help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.child is not None:
        run(options.child, options.starts)
        return 0
    failures: list[str] = []
    table = Table("kill", "batches started", "designs recorded", "designs lost")
    for column in table.columns:
        column.justify = "right"
    with tempfile.TemporaryDirectory() as name:
        place = Path(name)
        run(place / "whole", options.starts)
        last = len(logged(place / "whole"))
        moments = random_moments(options.kills, last, np.random.default_rng(options.seed))
        kills = 0
        for moment in track(moments, "kills", console=Console(stderr=True)):
            before, begun = recorded(place / "pieces"), len(logged(place / "pieces"))
            if not killed(place / "pieces", options.starts, moment):
                failures.append("the study ended before the last kill")
                break
            kills += 1
            batches = logged(place / "pieces")[begun:]
            lost = sum(batches) - (recorded(place / "pieces") - before)
            if lost not in (0, batches[-1] if batches else 0):
                failures.append(f"kill {kills} lost {lost} designs of the batches {batches}")
            table.add_row(
                str(kills), str(begun + len(batches)), str(before + sum(batches) - lost), str(lost)
            )
        run(place / "pieces", options.starts)
        failures += differences(place / "whole", place / "pieces")
    console = Console()
    console.print(machine(), markup=False)
    console.print(table)
    lines = (
        f"{kills} kills, seed {options.seed}, a study of {last} batches",
        f"failures: {len(failures)}",
        *failures,
    )
    for line in lines:
        console.print(line, markup=False, highlight=False)
    return 1 if failures else 0


@dataclass(frozen=True)
class Moment:
    """Time of a kill: seconds after the start of a batch, or of the process (batch −1)."""

    batch: int
    seconds: float


def random_moments(kills: int, last: int, random: np.random.Generator) -> list[Moment]:
    """Draw times over the whole study; a quarter of them while a process starts or replays."""
    batches = np.sort(random.integers(0, max(1, int(0.9 * last)), kills)).tolist()
    return [
        Moment(-1, float(random.uniform(0.0, 2.0)))
        if random.uniform() < 0.25
        else Moment(batch, float(random.uniform(0.0, 0.02)))
        for batch in batches
    ]


def killed(folder: Path, starts: int, moment: Moment) -> bool:
    """Run the study in a process and kill it; return False if it ended before."""
    words = [sys.executable, __file__, "--starts", str(starts), "--child", str(folder)]
    process = subprocess.Popen(words)
    while process.poll() is None and len(logged(folder)) < moment.batch:
        time.sleep(0.002)
    time.sleep(moment.seconds)
    process.send_signal(signal.SIGKILL)
    return process.wait() == -signal.SIGKILL


def logged(folder: Path) -> list[int]:
    """Return the sizes of the batches started so far."""
    log = folder.with_name(f"{folder.name}.log")
    return [int(line) for line in log.read_text().split()] if log.exists() else []


def recorded(folder: Path) -> int:
    """Count the designs in the record."""
    if not (folder / "settings.json").exists():
        return 0
    record = Record(folder / "record.sqlite", write=False)
    try:
        return len(record)
    finally:
        record.close()


def differences(whole: Path, pieces: Path) -> list[str]:
    """Return descriptions of the differences between two studies."""
    found = []
    one, other = Study.open(whole), Study.open(pieces)
    if one.best.vector.tobytes() != other.best.vector.tobytes():
        found.append(f"the best design differs: {one.best} and {other.best}")
    if one.finished != other.finished:
        found.append(f"the final states differ: {one.finished} and {other.finished}")
    if one.record.designs().tobytes() != other.record.designs().tobytes():
        found.append("the designs differ")
    pair = one.record.outcomes(), other.record.outcomes()
    for name in ("value", "joint_angles", "tip_force", "total_iterations", "event_count"):
        if getattr(pair[0], name).tobytes() != getattr(pair[1], name).tobytes():
            found.append(f"the results differ: {name}")
    one.close()
    other.close()
    return found


if __name__ == "__main__":
    sys.exit(main())
