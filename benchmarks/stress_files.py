"""A hundred thousand damaged files: each must be read, or rejected with one clear sentence.

Model files, targets files and study folders (settings, model or record) are damaged at random:
flipped bits, truncation, pasted pieces, extreme numbers, values of other types, misplaced pages of
the record. Files that can be read are also used: a model is written and read again, a study is read
to its last row and 10 % are resumed. The exit code is 1 if a file raises anything but one clear
sentence or takes longer than `--longest` seconds of processor time; it is then saved in `--keep`.

File n depends on the seed and n only: `--first n --files 1` repeats it.
"""

from __future__ import annotations

import argparse
import faulthandler
import shutil
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Callable
from pathlib import Path

import numpy as np
from _machine import machine
from _mutations import damaged_binary, damaged_json, damaged_text
from rich.console import Console
from rich.progress import track
from rich.table import Table

import flexor
from flexor.calibration.reading import read as read_targets
from flexor.errors import InputError
from flexor.model import Model, parse, presets, read
from flexor.model.reading import locate
from flexor.study import Study, optimize, resume

ROOT = Path(__file__).resolve().parent.parent
KINDS = {"model": 0.5, "targets": 0.1, "settings": 0.15, "study model": 0.05, "record": 0.2}
ERRORS = sys.__stderr__ or sys.stderr
PARTS = {"settings": "settings.json", "study model": "model.toml", "record": "record.sqlite"}


def main() -> int:
    """Damage and read the files, and print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--files", type=int, default=100_000)
    parser.add_argument("--first", type=int, default=0, help="number of the first file")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--longest", type=float, default=5.0, help="time limit per file [s]")
    parser.add_argument("--keep", type=Path, default=Path("stress-files"))
    options = parser.parse_args()
    counts: dict[str, Counter[str]] = {kind: Counter() for kind in KINDS}
    failures: list[str] = []
    slowest, began = (0.0, 0), time.process_time()
    with tempfile.TemporaryDirectory() as place:
        files = Files(Path(place), options.seed)
        numbers = range(options.first, options.first + options.files)
        for number in track(numbers, "files", console=Console(stderr=True)):
            # Ends a hang in compiled code with a traceback; the file remains in the folder.
            faulthandler.dump_traceback_later(30.0 * options.longest, exit=True, file=ERRORS)
            kind, path = files.damaged(number)
            start = time.process_time()
            failure, end = "", "read"
            try:
                USES[kind](path, number)
            except InputError as error:
                end, failure = "rejected", unclear(str(error))
            except Exception as error:
                end, failure = "failed", f"{type(error).__name__}: {error}"
            seconds = time.process_time() - start
            if seconds > options.longest:
                failure = failure or f"{seconds:.1f} s"
            slowest = max(slowest, (seconds, number))
            counts[kind][end] += 1
            if failure:
                failures.append(f"file {number} ({kind}): {failure[:300]}")
                save(path, options.keep / str(number))
        faulthandler.cancel_dump_traceback_later()
    report(counts, options.seed, slowest, time.process_time() - began, failures)
    return 1 if failures else 0


class Files:
    """Valid files, and a folder for damaged ones."""

    def __init__(self, place: Path, seed: int) -> None:
        self.place, self.seed = place, seed
        everything = ROOT / "tests" / "model" / "everything.toml"
        self.models = [locate(name).read_bytes() for name in presets()] + [everything.read_bytes()]
        targets = sorted((ROOT / "examples").glob("*-targets.toml"))
        self.targets = [path.read_bytes() for path in targets]
        self.study = place / "valid"
        model = flexor.load("finger", "calibrated")
        optimize(model, "R01", method="bfgs", budget=8, folder=self.study).close()
        self.parts = {kind: (self.study / name).read_bytes() for kind, name in PARTS.items()}

    def damaged(self, number: int) -> tuple[str, Path]:
        """Write the damaged file or study with a number; return its kind and path."""
        random = np.random.default_rng([self.seed, number])
        kind = str(random.choice(list(KINDS), p=list(KINDS.values())))
        if kind in ("model", "targets"):
            valid = self.models if kind == "model" else self.targets
            content = valid[int(random.integers(len(valid)))]
            path = self.place / f"{kind}.toml"
            path.write_bytes(damaged_text(content, self.models + self.targets, random))
            return kind, path
        folder = self.place / "study"
        shutil.rmtree(folder, ignore_errors=True)
        shutil.copytree(self.study, folder)
        content = self.parts[kind]
        if kind == "record":
            content = damaged_binary(content, random)
        elif kind == "settings" and random.uniform() < 0.5:
            content = damaged_json(content, random)
        else:
            content = damaged_text(content, self.models, random)
        (folder / PARTS[kind]).write_bytes(content)
        return kind, folder


def use_model(path: Path, number: int) -> None:
    """Read a model file, build the engine, write it and read it again."""
    file = read(path)
    model = Model(file, source=str(path))
    model.engine.energy(model.parameters, np.zeros(model.dof), np.zeros(len(model.inputs)))
    if parse(file.to_toml()) != file:
        raise AssertionError("the model changed by writing and reading it")


def use_targets(path: Path, number: int) -> None:
    """Read a targets file."""
    read_targets(path)


def use_study(folder: Path, number: int) -> None:
    """Read a study to its last row; resume 10 %."""
    study = Study.open(folder)
    try:
        study.table()
        study.record.known()
        study.record.failures()
        for design in study.record.designs():
            study.record.derivatives(design)
        repr(study)
        repr(study.best)
        str(study.finished)
    finally:
        study.close()
    if number % 10 == 0:
        resume(folder, budget=10).close()


USES: dict[str, Callable[[Path, int], None]] = {
    "model": use_model,
    "targets": use_targets,
    **dict.fromkeys(PARTS, use_study),
}


def unclear(sentence: str) -> str:
    """Return what is wrong with the form of an error message, or an empty string."""
    if "\n" in sentence or not sentence.isprintable():
        return f"not one line: {sentence!r}"
    if not sentence.endswith("."):
        return f"no full stop: {sentence}"
    if len(sentence) > 1000:
        return f"{len(sentence)} characters: {sentence}"
    return ""


def save(path: Path, place: Path) -> None:
    """Copy a file or folder that caused a failure."""
    place.parent.mkdir(parents=True, exist_ok=True)
    if path.is_dir():
        shutil.copytree(path, place, dirs_exist_ok=True)
    else:
        shutil.copy(path, place.with_suffix(path.suffix))


def report(
    counts: dict[str, Counter[str]],
    seed: int,
    slowest: tuple[float, int],
    seconds: float,
    failures: list[str],
) -> None:
    """Print the table."""
    ends = ("read", "rejected", "failed")
    table = Table("damaged", *ends)
    for column in table.columns[1:]:
        column.justify = "right"
    for kind, found in counts.items():
        table.add_row(kind, *(f"{found[end]:,}" for end in ends))
    console = Console()
    console.print(machine(), markup=False)
    console.print(table)
    files = sum(sum(found.values()) for found in counts.values())
    lines = (
        f"{files:,} files, seed {seed}",
        f"processor time: {1e3 * seconds / files:.1f} ms per file, at most {slowest[0]:.2f} s "
        f"(file {slowest[1]})",
        f"failures: {len(failures)}",
        *failures[:40],
    )
    for line in lines:
        console.print(line, markup=False, highlight=False, soft_wrap=True)


if __name__ == "__main__":
    sys.exit(main())
