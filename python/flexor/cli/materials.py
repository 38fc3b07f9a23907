"""`flexor materials`, and the fit of a material to tensile tests."""

from __future__ import annotations

import math
import re
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from flexor.cli import options
from flexor.cli.console import print_json, say
from flexor.cli.folders import save_figure
from flexor.cli.table import number, show
from flexor.errors import InputError

if TYPE_CHECKING:
    from flexor.materials import Material
    from flexor.materials.fit import Fit

Law = Annotated[
    str | None,
    typer.Option(
        metavar="LAW",
        help="For tensile tests: fit only this law (neo-hookean, mooney-rivlin, yeoh, ogden-1 or "
        "ogden-2).",
    ),
]
Strains = Annotated[
    str | None,
    typer.Option(
        metavar="MIN:MAX",
        help="For tensile tests: range of strains to fit, such as 0:1.5 for 150 %.",
    ),
]


def materials(
    name: Annotated[
        str | None, typer.Argument(metavar="NAME", help="A material; omit to list all.")
    ] = None,
    plot: options.Plot = None,
    as_json: options.Json = False,
) -> None:
    """List the library of materials, or show one as a table of a model file.

    Examples
    --------
    * `flexor materials`
    * `flexor materials dragon-skin-10 --plot dragon-skin-10.png`

    To fit constants to your own tensile tests, see `flexor calibrate`.
    """
    from flexor.materials.library import find, library
    from flexor.materials.table import model_table

    chosen = list(library().values()) if name is None else [find(name)]
    if plot is not None:
        from flexor.plot import save
        from flexor.plot.material_figure import draw_materials

        save(draw_materials(chosen), plot)
    if as_json:
        tables = {material.name: _to_dict(material) for material in chosen}
        print_json(tables if name is None else tables[name])
    elif name is None:
        rows = [
            (
                material.name,
                material.title,
                material.kind,
                _range(material),
                number(material.young_modulus / 1e3),
                number(material.density),
            )
            for material in chosen
        ]
        headings = ("material", "", "law", "strains", "E / kPa", "density / kg/m³")
        show(headings, rows, left=4)
    else:
        say(model_table(chosen[0]).rstrip())
    if plot is not None and not as_json:
        say(str(plot))


def _to_dict(material: Material) -> dict[str, object]:
    """Return a material for JSON, in SI units."""
    return {
        "kind": material.kind,
        **material.constants,
        "winding": material.winding,
        "density": material.density,
        "strain_limit": material.strain_limit,
        "stress_limit": material.stress_limit,
        "stretch_range": material.stretch_range,
        "young_modulus_at_rest": material.young_modulus,
        "title": material.title,
        "source": material.source,
    }


def calibrate_material(
    files: list[str],
    name: str,
    law: str | None,
    strains: str | None,
    folder: Path | None,
    as_json: bool,
) -> int:
    """Fit a material to the CSV files of tensile tests, and print or write it.

    Parameters
    ----------
    files
        One per specimen.
    name
        Of the material.
    law
        Law to fit; by default the one that predicts best.
    strains
        The range ``MIN:MAX``; by default all that the specimens reach.
    folder
        Where to write the table and a figure; nowhere by default.
    as_json
        Print one JSON object.

    Returns
    -------
    int
        The exit code.
    """
    from flexor.materials.fit import LAWS, fit_laws, mean_curve
    from flexor.materials.table import model_table
    from flexor.materials.tensile import read_test

    if not re.fullmatch(r"[A-Za-z][A-Za-z0-9_-]*", name):
        raise InputError(f'--name is "{name}": expected a letter, then letters, digits, _ and -.')
    tests = [read_test(file) for file in files]
    curve = mean_curve(tests, None if strains is None else _ends(strains))
    fits = fit_laws(curve, tuple(LAWS) if law is None else (law,), name)
    best = fits[0]
    written: list[Path] = []
    if folder is not None:
        from flexor.plot.material_figure import draw_fits
        from flexor.store import write_text

        folder.mkdir(parents=True, exist_ok=True)
        written.append(folder / "material.toml")
        write_text(written[0], model_table(best.material))
        written += save_figure(draw_fits(curve, tests, fits), folder, "material")
    if as_json:
        print_json(_report(fits, curve.slack))
        return 0
    rows = [
        (
            fit.law,
            str(LAWS[fit.law].size),
            number(fit.material.young_modulus / 1e3),
            f"{fit.rms:.1%}",
            f"{fit.largest:.1%}",
            number(fit.error, 3) if math.isfinite(fit.error) else "-",
            "yes" if fit.stable else "NO",
        )
        for fit in fits
    ]
    show(("law", "constants", "E / kPa", "rms", "largest", "predicted", "stable"), rows)
    specimens = "1 specimen" if curve.specimens == 1 else f"{curve.specimens} specimens"
    say(
        f"{specimens}, {curve.slack:.1%} of slack removed. rms and largest: "
        "deviation from the mean stress; predicted: rms over the scatter, each fifth of the "
        "strains from the others."
    )
    say("")
    say(model_table(best.material).rstrip())
    for file in written:
        say(str(file))
    return 0


def _report(fits: list[Fit], slack: float) -> dict[str, object]:
    return {
        "material": _to_dict(fits[0].material),
        "slack": slack,
        "fits": [
            {
                "law": fit.law,
                "constants": dict(fit.material.constants),
                "rms": fit.rms,
                "largest": fit.largest,
                "predicted": fit.error,
                "stable": fit.stable,
            }
            for fit in fits
        ],
    }


def _ends(strains: str) -> tuple[float, float]:
    try:
        low, high = map(float, strains.split(":"))
    except ValueError:
        low = high = math.nan
    if not (-1.0 < low < high < math.inf):
        raise InputError(f'--strains is "{strains}": expected MIN:MAX, such as 0:1.5 for 150 %.')
    return low, high


def _range(material: Material) -> str:
    if material.stretch_range is None:
        return ""
    low, high = material.stretch_range
    return f"{low - 1.0:.0%} to {high - 1.0:.0%}"
