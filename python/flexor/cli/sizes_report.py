"""Output of `flexor optimize --sizes`: the sizes, and whom each serves."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from flexor.cli import verdict
from flexor.cli.console import note, print_error, print_json, say
from flexor.cli.folders import INTERRUPTED, LOST, carry_out_searches, save_figure
from flexor.cli.progress import duration
from flexor.cli.table import number, show
from flexor.errors import ClusterError
from flexor.study.optimum import optimum_files
from flexor.study.verdict import binding

if TYPE_CHECKING:
    from flexor.scenarios import Scenario
    from flexor.study import Sizes
    from flexor.study.scenario_problem import ScenarioProblem

MOST_NAMES = 6


def carry_out(
    work: Callable[..., Sizes],
    executor: AbstractContextManager[Any],
    place: Path,
    also: Path | None,
    as_json: bool,
) -> int:
    """Find sizes, print them, and write whom each serves and a figure; return the exit code.

    The figure is drawn to another file as well, and with JSON to that alone.
    """
    from flexor import plot
    from flexor.store import csv_text, write_text

    def report(found: Sizes, seconds: float) -> None:
        file = place / "wearers.csv"
        write_text(file, csv_text(_rows(found)))
        if as_json:
            print_json(_as_json(found, seconds, place))
            if also is not None:
                plot.save(plot.sizes(found), also)
        else:
            _print(found, seconds, place, file)
            for drawn in save_figure(plot.sizes(found), place, "sizes", also):
                say(f"figure:  {drawn}")

    def stopped(error: BaseException) -> int:
        if isinstance(error, ClusterError):
            print_error(str(error))
        begin = "" if isinstance(error, ClusterError) else "interrupted; "
        note(f"{begin}studies of sizes that were finished are in {place}.")
        return LOST if isinstance(error, ClusterError) else INTERRUPTED

    return carry_out_searches(executor, work, report, stopped)


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
    for i in range(len(counts)):
        design = found.design(i)
        if design is None:
            say(f"size {i + 1} SERVES NO ONE: {_unserved(problem)}.")
            continue
        say(f"size {i + 1} serves {_names(found.members(i))}. What is worst of these:")
        verdict.print_constraints(design.kept, binding(problem, design.vector))
    if missing := found.members(-1):
        say(f"NOT SERVED: {_names(missing)}.")
    share = f"{100.0 * found.served:.0f} % of {len(found.wearers)} wearers"
    say(f"{share} are served; in {duration(seconds)}.")
    say(f"studies: {place}")
    for i, study in enumerate(found.studies):
        if counts[i] and study.folder is not None:
            for model in optimum_files(study.folder):
                say(f"model:   {model}")
    say(f"file:    {file}")


def _names(wearers: Sequence[Scenario]) -> str:
    """Return the names of a few wearers, or how many there are."""
    if len(wearers) > MOST_NAMES:
        return f"{len(wearers)} wearers, named in the file"
    return "; ".join(each.name for each in wearers)


def _unserved(problem: ScenarioProblem) -> str:
    """Return what no wearer reaches."""
    if problem.aggregate.everywhere:
        return "it keeps the constraints for no wearer"
    kept = " with the constraints kept" if problem.constraints else ""
    return f"no wearer reaches {problem.aggregate.text.removeprefix('served ')}{kept}"


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
                "feasible": len(found.members(i)) > 0,  # with it their constraints hold
                "folder": study.folder,
            }
            for i, study in enumerate(found.studies)
        ],
        "served": found.served,
        "seconds": seconds,
        "folder": place,
    }
