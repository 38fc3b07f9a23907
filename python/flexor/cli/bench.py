"""`flexor bench`: measurements on a bench against what is predicted."""

from __future__ import annotations

from pathlib import Path as FilePath
from typing import Annotated, Any

import numpy as np
import typer

from flexor.cli import options
from flexor.cli.console import note, print_json, say
from flexor.cli.export import designed
from flexor.cli.table import fixed, number, show


def bench(
    design: Annotated[
        str,
        typer.Argument(
            metavar="DESIGN",
            help="Model file, preset, or study folder (its optimum, or --design N).",
            autocompletion=options.preset_names,
        ),
    ],
    table: Annotated[
        FilePath,
        typer.Argument(
            metavar="CSV",
            help="Measured angles: `bench.csv` of `flexor export DESIGN --finger DIR`, filled in.",
        ),
    ],
    which: options.Which = None,
    variant: options.Variant = None,
    changes: options.Set = None,
    plot: options.Plot = None,
    as_json: options.Json = False,
) -> int:
    """Compare joint angles that were measured on a bench with those that are predicted.

    The table has a column for each input and for each joint that was measured, in the units of
    its headings; rows are in the order of the experiment, so that loads may rise and fall.

    Examples
    --------
    * `flexor export pneumatic-finger --finger finger/`, measure, then
      `flexor bench pneumatic-finger finger/bench.csv --plot bench.png`
    """
    from flexor.export import bench as benches

    model, _, geometry = designed(design, which, variant, changes)
    found = benches.bench(model, table, geometry)
    if as_json:
        print_json(_as_json(found))
    else:
        _print(found)
    if plot is not None:
        from flexor import plot as figures

        figures.save(benches.figure(found), plot)
        note(f"figure: {plot}")
    return 0


def _print(found: Any) -> None:
    model = found.model
    labels = found.joints
    headings = [f"{name} / {model.load_unit(i)[1]}" for i, name in enumerate(model.inputs)]
    for label in labels:
        headings += [f"{label} / °", "predicted / °"]
    rows = []
    for row, loads in enumerate(found.loads):
        cells = [number(x / model.load_unit(i)[0]) for i, x in enumerate(loads)]
        for column in range(len(labels)):
            both = (found.measured[row, column], found.predicted[row, column])
            cells += ["" if np.isnan(x) else fixed(float(np.degrees(x))) for x in both]
        rows.append(cells)
    show(headings, rows, left=0)
    for label, deviation in zip(labels, found.deviations, strict=True):
        if np.isfinite(deviation):
            say(f"{label}: root mean square deviation {fixed(float(np.degrees(deviation)))}°")


def _as_json(found: Any) -> dict[str, Any]:
    """Return loads, angles [rad] and deviations [rad] by the name of the joint."""
    return {
        "loads": found.loads.tolist(),
        "measured": dict(zip(found.joints, found.measured.T.tolist(), strict=True)),
        "predicted": dict(zip(found.joints, found.predicted.T.tolist(), strict=True)),
        "deviation": dict(zip(found.joints, found.deviations.tolist(), strict=True)),
    }
