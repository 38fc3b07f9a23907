"""Arguments and options that several commands have."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

Model = Annotated[
    str,
    typer.Argument(
        metavar="MODEL", help="A model file, or the name of a preset (see `flexor presets`)."
    ),
]
ModelUnlessResumed = Annotated[
    str | None,
    typer.Argument(metavar="[MODEL]", help="A model file or preset; not needed to resume."),
]
Parameters = Annotated[
    str, typer.Option("--parameters", "-p", help="What may change (see `flexor sets`).")
]
JudgedForce = Annotated[
    str | None, typer.Option(help="Forces in N, as for `simulate`; judged at the last.")
]
StudyFolder = Annotated[
    Path | None,
    typer.Option("--out", help="The study folder to make; one in `studies/` by default."),
]
Seed = Annotated[int, typer.Option(min=0, help="Random seed.")]
Threads = Annotated[
    int, typer.Option(min=0, help="Threads; 0 for one per core. Results do not depend on it.")
]
Cluster = Annotated[
    str | None,
    typer.Option(
        metavar="ADDRESS",
        help="Evaluate on a Dask cluster, such as `tcp://HOST:8786`; `local:4` starts four workers "
        "here. Results do not depend on it.",
    ),
]
Constants = Annotated[
    str | None, typer.Option(help="The file's set of constants to use, such as `printed`.")
]
Set = Annotated[
    list[str] | None,
    typer.Option("--set", metavar="KEY=VALUE", help="Change a field of the file; may be repeated."),
]
