"""An optimisation killed at twenty random moments and resumed after each: the same in the end.

The study is run once undisturbed. Then it is begun again in a process that is killed (SIGKILL) at a
random moment, resumed, killed again and so on, until it is left to end. The exit code is 1 if any
design, outcome or bit of the record differs from the undisturbed study, or a kill cost more than
the one batch that was being evaluated.
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
from flexor.study import Executor, Problem, Record, Study, optimize, resume


@dataclass(frozen=True)
class Logged(Executor):
    """Evaluates, and writes down every batch before it does."""

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
    """Begin the study, or go on with it."""
    executor = Logged(folder.with_name(f"{folder.name}.log"))
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
    """Kill and resume, and print the table."""
    reading = argparse.ArgumentParser(description=__doc__)
    reading.add_argument("--kills", type=int, default=20)
    reading.add_argument("--starts", type=int, default=16, help="how large the study is")
    reading.add_argument("--seed", type=int, default=1, help="of the moments")
    reading.add_argument("--child", type=Path, help=argparse.SUPPRESS)
    asked = reading.parse_args()
    if asked.child is not None:
        run(asked.child, asked.starts)
        return 0
    complaints: list[str] = []
    table = Table("kill", "batches begun", "designs recorded", "designs lost")
    for column in table.columns:
        column.justify = "right"
    with tempfile.TemporaryDirectory() as name:
        place = Path(name)
        run(place / "whole", asked.starts)
        last = len(logged(place / "whole"))
        moments = drawn(asked.kills, last, np.random.default_rng(asked.seed))
        kills = 0
        for moment in track(moments, "kills", console=Console(stderr=True)):
            before, begun = recorded(place / "pieces"), len(logged(place / "pieces"))
            if not killed(place / "pieces", asked.starts, moment):
                complaints.append("it ended before all kills")
                break
            kills += 1
            batches = logged(place / "pieces")[begun:]
            lost = sum(batches) - (recorded(place / "pieces") - before)
            if lost not in (0, batches[-1] if batches else 0):
                complaints.append(f"kill {kills} cost {lost} designs of the batches {batches}")
            table.add_row(
                str(kills), str(begun + len(batches)), str(before + sum(batches) - lost), str(lost)
            )
        run(place / "pieces", asked.starts)
        complaints += unlike(place / "whole", place / "pieces")
    console = Console()
    console.print(machine(), markup=False)
    console.print(table)
    said = (
        f"{kills} kills, seed {asked.seed}, a study of {last} batches",
        f"complaints: {len(complaints)}",
        *complaints,
    )
    for line in said:
        console.print(line, markup=False, highlight=False)
    return 1 if complaints else 0


@dataclass(frozen=True)
class Moment:
    """When to kill: so long after so many batches have been begun, or after the process has."""

    batch: int
    seconds: float


def drawn(kills: int, last: int, random: np.random.Generator) -> list[Moment]:
    """Draw moments all along the study; one in four while a process is starting or replaying."""
    batches = np.sort(random.integers(0, max(1, int(0.9 * last)), kills)).tolist()
    return [
        Moment(-1, float(random.uniform(0.0, 2.0)))
        if random.uniform() < 0.25
        else Moment(batch, float(random.uniform(0.0, 0.02)))
        for batch in batches
    ]


def killed(folder: Path, starts: int, moment: Moment) -> bool:
    """Run the study in a process and kill that; False if it ended by itself."""
    words = [sys.executable, __file__, "--starts", str(starts), "--child", str(folder)]
    process = subprocess.Popen(words)
    while process.poll() is None and len(logged(folder)) < moment.batch:
        time.sleep(0.002)
    time.sleep(moment.seconds)
    process.send_signal(signal.SIGKILL)
    return process.wait() == -signal.SIGKILL


def logged(folder: Path) -> list[int]:
    """Sizes of the batches begun so far."""
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


def unlike(whole: Path, pieces: Path) -> list[str]:
    """Say what differs between two studies."""
    said = []
    one, other = Study.open(whole), Study.open(pieces)
    if one.best.vector.tobytes() != other.best.vector.tobytes():
        said.append(f"the best design differs: {one.best} and {other.best}")
    if one.finished != other.finished:
        said.append(f"the end differs: {one.finished} and {other.finished}")
    if one.record.designs().tobytes() != other.record.designs().tobytes():
        said.append("the designs differ")
    pair = one.record.outcomes(), other.record.outcomes()
    for name in ("value", "joint_angles", "tip_force", "total_iterations", "event_count"):
        if getattr(pair[0], name).tobytes() != getattr(pair[1], name).tobytes():
            said.append(f"the outcomes differ: {name}")
    one.close()
    other.close()
    return said


if __name__ == "__main__":
    sys.exit(main())
