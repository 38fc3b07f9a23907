"""`flexor front`: the front of a study with several objectives, and its points as model files."""

from __future__ import annotations

import math
from contextlib import closing
from pathlib import Path as FilePath
from typing import TYPE_CHECKING, Annotated, Any

import typer

from flexor.cli import options
from flexor.cli.console import note, print_json, say
from flexor.cli.folders import study_folder
from flexor.cli.saving import save_model
from flexor.cli.table import number, show
from flexor.errors import InputError

if TYPE_CHECKING:
    from flexor.study import Design


def front(
    study: Annotated[FilePath, typer.Argument(metavar="STUDY", help="Study folder.")],
    point: Annotated[
        int | None,
        typer.Option(
            callback=options.at_least(1), help="Show this point, by its number in the table."
        ),
    ] = None,
    which: options.OneOf = None,
    save: options.Save = None,
    plot: options.Plot = None,
    as_json: options.Json = False,
) -> int:
    """Show the front of a study with several objectives, or one of its points.

    A front has the designs that no other design is better than in all objectives, in the order of
    the first objective. Of a study with one objective it is the optimum. The study may be running.

    Examples
    --------
    * `flexor optimize pneumatic-finger --maximise range-of-motion --minimise mass --out studies/m`
    * `flexor front studies/m --plot front.png`
    * `flexor front studies/m --point 7 --save light.toml`, then `flexor simulate light.toml`
    """
    from flexor.cli import front_report
    from flexor.study import Study

    if save is not None and point is None:
        raise InputError("--save needs --point: the number of a point of the front.")
    study = study_folder(study, which)
    with closing(Study.open(study)) as opened:
        found = opened.front
        if point is not None:
            design = found.point(point)
            if as_json:
                print_json(_as_json(found.as_json()[point - 1], design))
            else:
                _print_point(found.headings, found.shown[point - 1].tolist(), design)
            save_model(design, save, f"point {point} of the front of {study}")
        elif as_json:
            print_json(front_report.front_as_json(opened, found))
        else:
            front_report.print_front(opened, found)
        if plot is not None:
            from flexor import plot as figures

            figures.save(figures.front(opened), plot)
            note(f"figure: {plot}")
    return 0


def _print_point(headings: tuple[str, ...], shown: list[float], design: Design) -> None:
    from flexor.cli.verdict import print_constraints

    chosen = design.problem.parameters
    rows = [(heading, number(value, 6)) for heading, value in zip(headings, shown, strict=True)]
    values = (design.vector / chosen.scale).tolist()
    for label, unit, value in zip(chosen.labels, chosen.units, values, strict=True):
        rows.append((label if unit == "1" else f"{label} / {unit}", number(value, 6)))
    show(("", "value"), [(name.replace(" / ", ", "), value) for name, value in rows])
    if design.problem.constraints:
        print_constraints(design.kept)
    say(f"bending {math.degrees(design.bending):.1f}°, {design.events} events along the path")


def _as_json(point: dict[str, Any], design: Design) -> dict[str, Any]:
    from flexor.cli.verdict import constraints_as_json

    return {
        **point,
        "feasible": design.feasible,
        "constraints": constraints_as_json(design),
        "joint_angles": design.joint_angles[-1].tolist(),
    }
