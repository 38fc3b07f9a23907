"""Output of `flexor optimize --sizes`: the sizes, and whom each serves."""

from __future__ import annotations

import time
from collections.abc import Callable
from contextlib import AbstractContextManager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from flexor.cli import verdict
from flexor.cli.console import note, print_json, say
from flexor.cli.folders import INTERRUPTED
from flexor.cli.progress import SearchProgress, duration
from flexor.cli.table import number, show

if TYPE_CHECKING:
    from flexor.study import Sizes


def carry_out(
    work: Callable[..., Sizes],
    executor: AbstractContextManager[Any],
    place: Path,
    as_json: bool,
) -> int:
    """Find sizes, print them, and write whom each serves; return the exit code."""
    from flexor.store import csv_text, write_text

    began = time.monotonic()
    try:
        with executor as where, SearchProgress() as progress:
            found = work(executor=where, progress=progress)
    except KeyboardInterrupt:
        note(f"interrupted; studies of sizes that were finished are in {place}.")
        return INTERRUPTED
    file = place / "wearers.csv"
    write_text(file, csv_text(_rows(found)))
    if as_json:
        print_json(_as_json(found, time.monotonic() - began, place))
    else:
        _print(found, time.monotonic() - began, place, file)
    for study in found.studies:
        study.close()
    return 0


def _print(found: Sizes, seconds: float, place: Path, file: Path) -> None:
    problem = found.problem
    chosen = problem.parameters
    rows = []
    for i, (label, unit, scale) in enumerate(
        zip(chosen.labels, chosen.units, chosen.scale.tolist(), strict=True)
    ):
        cells = [number(study.best.vector[i] / scale) for study in found.studies]
        rows.append((f"{label}{'' if unit == '1' else f' / {unit}'}", *cells))
    counts = [len(found.members(i)) for i in range(len(found.studies))]
    rows.append(("wearers served", *map(str, counts)))
    for what, reduce in (("least", np.min), ("mean", np.mean), ("greatest", np.max)):
        cells = [
            number(float(reduce(found.shown[i][found.size == i]))) if counts[i] else "-"
            for i in range(len(counts))
        ]
        rows.append((f"{problem.objective.quantity}, {what} / {problem.objective.unit}", *cells))
    show(("", *(f"size {i}" for i in range(1, len(counts) + 1))), rows)
    for i, study in enumerate(found.studies):
        names = "; ".join(each.name for each in found.members(i))
        say(f"size {i + 1} serves {names or 'no one'}.")
        verdict.print_verdict(study.best)
    missing = [each.name for each, i in zip(found.wearers, found.size, strict=True) if i < 0]
    if missing:
        say(f"NOT SERVED: {'; '.join(missing)}.")
    share = f"{100.0 * found.served:.0f} % of {len(found.wearers)} wearers"
    say(f"{share} are served; in {duration(seconds)}.")
    say(f"studies: {place}")
    say(f"file:    {file}")


def _rows(found: Sizes) -> list[list[Any]]:
    quantity = f"{found.problem.objective.quantity} / {found.problem.objective.unit}"
    heads = [f"{quantity}, size {i}" for i in range(1, len(found.studies) + 1)]
    rows: list[list[Any]] = [["wearer", "weight", "size", *heads]]
    for i, each in enumerate(found.wearers):
        size = int(found.size[i]) + 1
        values = [number(value, 6) for value in found.shown[:, i].tolist()]
        rows.append([each.name, each.weight, size or "", *values])
    return rows


def _as_json(found: Sizes, seconds: float, place: Path) -> dict[str, Any]:
    """Return each size with its design (SI) and whom it serves."""
    return {
        "sizes": [
            {
                "parameters": study.best.parameters,
                "wearers": [each.name for each in found.members(i)],
                "feasible": study.best.feasible,
                "folder": study.folder,
            }
            for i, study in enumerate(found.studies)
        ],
        "served": found.served,
        "seconds": seconds,
        "folder": place,
    }
