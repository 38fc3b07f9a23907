"""Output of a front of designs: table, figure and JSON."""

from __future__ import annotations

from pathlib import Path as FilePath
from typing import TYPE_CHECKING, Any

from flexor.cli.console import out, say
from flexor.cli.folders import save_figure
from flexor.cli.outcome import cost_of
from flexor.cli.progress import working
from flexor.cli.table import number, show
from flexor.study.ineffective import ineffective
from flexor.study.optimum import optimum_files
from flexor.study.sentences import without_effect

if TYPE_CHECKING:
    from flexor.study import Front, Study

# Rows of the table; the file has all.
MOST_ROWS = 40


def print_front(
    study: Study, front: Front, seconds: float | None = None, resumed: bool = False
) -> None:
    """Print the front as a table, spread over its points, and the cost."""
    if not len(front):
        _print_empty(study)
    else:
        _print_table(front)
        names = " and ".join(each.name for each in front.objectives)
        count = f"{len(front)} designs" if len(front) > 1 else "one design"
        if len(front.objectives) > 1:
            say(f"front: {count} that no other is better than in all, to {names}.")
        else:
            say(f"The study has one objective, to {names}: this is its best design.")
    if seconds is not None and len(front):
        for text in without_effect(ineffective(study.problem, front.designs[[0, -1]])):
            say(text)
    if seconds is None:
        say(f"{study.evaluations:,} designs: {study.finished}.")
    else:
        say(cost_of(study, seconds, resumed))
    if len(front) and study.folder is not None:
        say(f"model file of a point: flexor front {study.folder} --point 1 --save point.toml")


def _print_empty(study: Study) -> None:
    say("NOT FEASIBLE: no design that was tried keeps the constraints.")
    least = study.best
    excess = study.problem.worst_excesses(least.constraint_values)
    broken = [
        each.text(study.problem.model)
        for each, over in zip(study.problem.constraints, excess, strict=True)
        if over > 0.0
    ]
    say(f"The nearest, {least.text}, exceeds {' and '.join(broken)}.")


def _print_table(front: Front) -> None:
    rows = front.spread(MOST_ROWS)
    chosen = front.problem.parameters
    objectives = [[number(value, 5) for value in row] for row in front.shown[rows].tolist()]
    designs = (front.designs[rows] / chosen.scale).tolist()
    parameters = [[number(value) for value in row] for row in designs]
    points = [[str(row + 1)] for row in rows]
    labels = [
        label if unit == "1" else f"{label} / {unit}"
        for label, unit in zip(chosen.labels, chosen.units, strict=True)
    ]
    headings = ["point", *front.headings]
    # The parameters as well, where they fit.
    width = sum(2 + max(len(part) for part in head.split(" / ")) for head in (*headings, *labels))
    if width <= out.width:
        headings = [*headings, *labels]
        cells = [a + b + c for a, b, c in zip(points, objectives, parameters, strict=True)]
    else:
        cells = [a + b for a, b in zip(points, objectives, strict=True)]
    show(headings, cells, left=0)
    if len(rows) < len(front):
        say(f"{len(rows)} of {len(front)} points are shown; front.csv has all.")


def draw_front(
    study: Study, front: Front, also: FilePath | None, quiet: bool = False
) -> list[FilePath]:
    """Save the figure and the table of a front to its folder, the figure to another file too."""
    from flexor import plot

    files: list[FilePath] = []
    if study.folder is not None:
        files.append(front.save(study.folder))
    if len(front) and (also is not None or study.folder is not None):
        with working("drawing the front", at_once=False) as progress:
            figure = plot.front(study)
            if study.folder is not None:
                files += save_figure(figure, study.folder, "front", also, progress)
            elif also is not None:
                files.append(plot.save(figure, also))
    if not quiet:
        if study.folder is not None:
            say(f"study:  {study.folder}")
            for file in optimum_files(study.folder):
                say(f"model:  {file}")
        for file in files:
            say(f"file:   {file}")
    return files


def front_as_json(study: Study, front: Front, seconds: float | None = None) -> dict[str, Any]:
    """Return every point of a front, SI, and the cost."""
    return {
        "objectives": [each.name for each in front.objectives],
        "front": front.as_json(),
        "evaluations": study.evaluations,
        "seconds": seconds,
        "reason": study.finished,
        "folder": study.folder,
        "models": [] if study.folder is None else optimum_files(study.folder),
    }
