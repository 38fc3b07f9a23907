"""Arguments and options shared by several commands."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Annotated

import typer

from flexor.arguments import integer
from flexor.cli.saving import check_model_file


def _writable(figure: Path | None) -> Path | None:
    """Reject a figure that cannot be written before anything is computed."""
    if figure is not None:
        from flexor.plot import writable

        writable(figure)
    return figure


def preset_names(incomplete: str) -> list[str]:
    """Complete the name of a preset, or leave files to the shell."""
    from flexor.model.reading import presets

    return [name for name in presets() if name.startswith(incomplete)]


def method_names(incomplete: str) -> list[str]:
    """Complete the name of a search method."""
    from flexor.optimizers import names

    return [name for name in names() if name.startswith(incomplete)]


def at_least(least: int) -> Callable[[typer.CallbackParam, int | None], int | None]:
    """Return the check of an option that is a number of at least ``least``."""

    def check(parameter: typer.CallbackParam, value: int | None) -> int | None:
        return None if value is None else integer(parameter.opts[0], value, least)

    return check


Model = Annotated[
    str,
    typer.Argument(
        metavar="MODEL",
        help="Model file, or name of a preset (see `flexor presets`).",
        autocompletion=preset_names,
    ),
]
OptionalModel = Annotated[
    str | None,
    typer.Argument(
        metavar="MODEL",
        help="Model file or preset; omit with --resume.",
        autocompletion=preset_names,
    ),
]
Parameters = Annotated[
    str, typer.Option("--parameters", "-p", help="Design parameters (see `flexor sets`).")
]
Objective = Annotated[str, typer.Option("--objective", "-o", help="Objective (see `flexor sets`).")]
Vary = Annotated[
    list[str] | None,
    typer.Option(
        metavar="FIELD=LOW:HIGH",
        help="Vary a numeric field of the model file instead of `--parameters`, such as "
        "`exosuit.length=8 cm:11 cm`, or a size along a rod as a spline, "
        "`exosuit.section.wall=1.5 mm:3 mm:spline 4`; may be repeated.",
    ),
]
Choose = Annotated[
    list[str] | None,
    typer.Option(
        metavar="FIELD=VALUE,VALUE",
        help="Choose the value of a field, such as `exosuit.material=dragon-skin-30,ecoflex-00-30`,"
        " or whether there is something, `middle=with,without`; may be repeated, and all "
        "combinations are tried.",
    ),
]
Maximise = Annotated[
    list[str] | None,
    typer.Option(
        metavar="NAME", help="Maximise an observable (see `flexor sets`); several give a front."
    ),
]
Minimise = Annotated[list[str] | None, typer.Option(metavar="NAME", help="Minimise an observable.")]
SubjectTo = Annotated[
    list[str] | None,
    typer.Option(
        metavar="CONSTRAINT",
        help="Constraint along the whole path, such as `overlap <= 0.5 mm`; may be repeated.",
    ),
]
Without = Annotated[
    list[str] | None,
    typer.Option(
        metavar="NAME",
        help="Switch off a default constraint: `overlap`, `centreline`, `strain`, `stress`, "
        "`stretch` or `defaults` for all; may be repeated. They hold with --maximise and "
        "--minimise.",
    ),
]
Scenarios = Annotated[
    str | None,
    typer.Option(
        metavar="NAMES",
        help="Variants of the file under which each design is evaluated, such as "
        "`healthy,stiff=0.5` with other weights than those of the file, `all`, or wearers by "
        "the percentile of their hand, `5%,95%`.",
    ),
]
Aggregate = Annotated[
    str | None,
    typer.Option(
        metavar="HOW",
        help="What counts over the scenarios: `mean`, `worst`, `quantile 0.9`, or `served 60 deg`, "
        "the share that reaches that and keeps the constraints.",
    ),
]
Tolerance = Annotated[
    list[str] | None,
    typer.Option(
        metavar="FIELD=ERROR",
        help="Error of a field for which constraints hold, such as `exosuit.section.wall=0.1 mm`, "
        "or its standard deviation, `0.1 mm normal`; may be repeated.",
    ),
]
Wearers = Annotated[
    int | None,
    typer.Option(
        callback=at_least(1),
        help="Number of wearers, drawn from the file's `[population]`, that are scenarios.",
    ),
]
Sizes = Annotated[
    int | None,
    typer.Option(
        callback=at_least(1),
        help="Find so many designs that together serve the wearers or scenarios best.",
    ),
]
Samples = Annotated[
    int | None,
    typer.Option(
        callback=at_least(0),
        help="Number of errors within the tolerances over which the objective counts as well.",
    ),
]
Load = Annotated[
    list[str] | None,
    typer.Option(
        "--load",
        "--force",
        metavar="LOADS",
        help="Loads, as for `simulate`; the objective is evaluated at the last.",
    ),
]
Folder = Annotated[
    Path | None,
    typer.Option("--out", help="Output folder; by default a new one in `studies/`."),
]
OneOf = Annotated[
    str | None,
    typer.Option(
        "--design",
        metavar="NAME",
        help="Of a folder of --choose or --sizes another study than the best: its number, or the "
        "name of the combination.",
    ),
]
Which = Annotated[
    str | None,
    typer.Option(
        "--design",
        metavar="N|NAME",
        help="Number of a recorded design of the study, from 1 in the order of evaluation; of a "
        "folder of --choose or --sizes another study than the best: its number, or the name of "
        "the combination.",
    ),
]
Resume = Annotated[Path | None, typer.Option(help="Resume the work in this folder.")]
Seed = Annotated[int, typer.Option(callback=at_least(0), help="Random seed.")]
Threads = Annotated[
    int,
    typer.Option(
        callback=at_least(0),
        help="Number of threads; 0 for one per core. Does not affect results.",
    ),
]
Cluster = Annotated[
    str | None,
    typer.Option(
        metavar="ADDRESS",
        help="Evaluate on a Dask cluster, such as `tcp://HOST:8786`; `local:4` starts four local "
        "workers. Does not affect results.",
    ),
]
Variant = Annotated[
    str | None,
    typer.Option(
        "--variant",
        "--constants",
        help="Variant of the file to apply, such as `printed` of the preset `finger`.",
    ),
]
Set = Annotated[
    list[str] | None,
    typer.Option(
        "--set", metavar="KEY=VALUE", help="Override a field of the file; may be repeated."
    ),
]
Solver = Annotated[
    list[str] | None,
    typer.Option(
        "--solver",
        metavar="KEY=VALUE",
        help="Option of the equilibrium solver, such as `max_seconds=10` for each load step; may "
        "be repeated.",
    ),
]
Plot = Annotated[
    Path | None,
    typer.Option(help="Save the figure to this PNG, SVG or PDF file.", callback=_writable),
]
Save = Annotated[
    Path | None,
    typer.Option(
        metavar="FILE",
        callback=check_model_file,
        help="Write the design as a model file: yours, with its values in place.",
    ),
]
Json = Annotated[bool, typer.Option("--json", help="Print a JSON object instead of text.")]
