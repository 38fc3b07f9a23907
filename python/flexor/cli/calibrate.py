"""`flexor calibrate`: fit constants of a model to targets."""

from __future__ import annotations

import math
import re
import shlex
from pathlib import Path as FilePath
from typing import TYPE_CHECKING, Annotated, Any

import typer

from flexor.cli import options
from flexor.cli.console import print_json, say
from flexor.cli.folders import carry_out, executor_for, new_folder, save_figure
from flexor.cli.materials import Law, Strains, calibrate_material
from flexor.cli.progress import CalibrationBar, duration
from flexor.cli.table import number, show
from flexor.cli.values import load_changed
from flexor.errors import InputError

if TYPE_CHECKING:
    from flexor.calibration import Calibration
    from flexor.calibration.report import Row

CALIBRATIONS = FilePath("calibrations")
_MISFIT = 2.0  # residuals in tolerances above which the model does not explain the values


def calibrate(
    context: typer.Context,
    model: Annotated[
        str,
        typer.Argument(metavar="MODEL", help="Model file or preset; or the CSV of a tensile test."),
    ],
    inputs: Annotated[
        list[str] | None,
        typer.Argument(
            metavar="TARGETS",
            help="Targets file (see docs/calibration.md); or tensile tests of further specimens.",
        ),
    ] = None,
    folder: Annotated[
        FilePath | None,
        typer.Option("--out", help="Output folder; by default a new one in `calibrations/`."),
    ] = None,
    resume: Annotated[
        FilePath | None,
        typer.Option(help="Resume the calibration in this folder, of the same MODEL and TARGETS."),
    ] = None,
    seed: options.Seed = 0,
    samples: Annotated[
        int | None,
        typer.Option(callback=options.at_least(1), help="Points of the global search."),
    ] = None,
    starts: Annotated[
        int | None,
        typer.Option(callback=options.at_least(1), help="Number of these points that are refined."),
    ] = None,
    name: Annotated[
        str, typer.Option(help="Name of the variant that the constants become, or of the material.")
    ] = "calibrated",
    threads: options.Threads = 0,
    cluster: options.Cluster = None,
    variant: options.Variant = None,
    changes: options.Set = None,
    law: Law = None,
    strains: Strains = None,
    as_json: options.Json = False,
) -> int:
    """Fit constants of a model to measured values, or of a material to tensile tests.

    TARGETS defines the fields of the model to fit, with their ranges, and the measured values:
    angles, forces, positions. The constants are written to the folder, ready to be pasted into the
    model file, with a table, a report and a figure. Every evaluation is recorded immediately, so a
    calibration can be interrupted (Ctrl-C) and resumed with `--resume FOLDER`.

    Examples
    --------
    * `flexor calibrate finger examples/bench-targets.toml --variant calibrated`
    * `flexor calibrate finger examples/bench-targets.toml --variant calibrated --out bench`
    * `flexor calibrate finger examples/bench-targets.toml --variant calibrated --resume bench`
    * `flexor calibrate specimen-1.csv specimen-2.csv --name silicone --strains 0:1.5`

    With CSV files of tensile tests instead of a model, one per specimen, hyperelastic laws are
    fitted to their mean, and the one that predicts best is printed as the table `[materials.NAME]`
    of a model file; `--out` writes it with a figure (see docs/materials.md).

    The exit code is 1 if a hard target is not met.
    """
    if model.lower().endswith(".csv"):
        return calibrate_material([model, *(inputs or [])], name, law, strains, folder, as_json)
    if law is not None or strains is not None:
        raise InputError("--law and --strains are for tensile tests: give their CSV files.")
    if inputs is None or len(inputs) != 1:
        raise InputError("expected MODEL and one file TARGETS, or the CSV files of tensile tests.")
    targets = inputs[0]
    from flexor import calibration
    from flexor.calibration import figure
    from flexor.calibration import report as reports

    if not re.fullmatch(r"[A-Za-z0-9_-]+", name):
        raise InputError(f'--name is "{name}": letters, digits, _ and - are allowed.')
    loaded = load_changed(model, variant, changes)
    if resume is not None and folder is not None:
        raise InputError("--resume takes the folder: omit --out.")
    place = resume or folder or new_folder(loaded.name, FilePath(targets).stem, parent=CALIBRATIONS)

    def report(found: Calibration, seconds: float) -> int:
        files = reports.write(found, place, name)
        files += save_figure(figure.draw(found), place, "calibration")
        if as_json:
            print_json(reports.to_dict(found))
        else:
            _show(found, seconds, files)
        return 0 if found.best.met else 1

    def work(**shared: Any) -> None:
        calibration.calibrate(
            loaded,
            targets,
            seed=seed,
            samples=samples,
            starts=starts,
            folder=place,
            resume=resume is not None,
            **shared,
        )

    again = shlex.join(["flexor", "calibrate", model, targets, *_given(context), "--resume"])
    where = executor_for(threads, cluster)
    return carry_out(again, place, where, CalibrationBar(), work, report)


def _given(context: typer.Context) -> list[str]:
    """Return the given options that must be repeated when resuming."""
    words: list[str] = []
    for each in context.command.params:
        source = context.get_parameter_source(each.name or "")
        if each.param_type_name == "option" and source and source.name == "COMMANDLINE":
            value = context.params[each.name or ""]
            if each.name in ("seed", "samples", "starts", "name", "constants"):
                words += [max(each.opts, key=len), str(value)]
            elif each.name == "changes":
                words += [word for change in value for word in ("--set", change)]
    return words


def _show(found: Calibration, seconds: float, files: list[FilePath]) -> None:
    from flexor.calibration.report import rows

    best, identifiability = found.best, found.identifiability
    cells: list[tuple[str, str, str, str]] = []
    for i, constant in enumerate(identifiability.constants):
        low, high = (constant.shown(end, 4) for end in identifiability.interval(i))
        value = constant.shown(best.constants[constant.name])
        cells.append((constant.name, value, f"{low} to {high}", identifiability.verdict(i)))
    show(("constant", "fitted", "95 % confidence", ""), cells)
    lines = []
    for row in rows(best):
        met = abs(row.off) <= row.tolerance
        verdict = {"hard": "met" if met else "MISSED", "soft": "", "held-out": "held out"}
        lines.append(
            (
                row.target,
                "" if row.force is None else number(row.force),
                row.unit,
                number(row.wanted),
                number(row.found) if math.isfinite(row.found) else "-",
                _deviation_text(row),
                number(row.tolerance, 2) if math.isfinite(row.tolerance) else "",
                verdict[row.weight],
            )
        )
    headings = ("target", "force / N", "unit", "wanted", "found", "off", "tolerance", "")
    show(headings, lines)
    say("Combinations of constants, the best identified first:")
    for direction in identifiability.directions:
        say(f"  {identifiability.describe(direction)}")
    _print_other_fits(found)
    say(_sentence(found, seconds))
    for file in files:
        say(str(file))


def _deviation_text(row: Row) -> str:
    if not math.isfinite(row.off):
        return ""
    nothing = 1e-3 * (row.tolerance if math.isfinite(row.tolerance) else abs(row.wanted))
    return "0" if abs(row.off) < nothing else number(row.off, 2)


def _print_other_fits(found: Calibration) -> None:
    others = found.fits[1:]
    if not others:
        return
    cells = []
    for fit in others:
        values = ", ".join(
            f"{constant.name} {constant.shown(fit.constants[constant.name], 4)}"
            for constant in fit.problem.constants
        )
        met = "meets the hard targets" if fit.met else "misses a hard target"
        cells.append(("another minimum", values, met, number(fit.misfit)))
    show(("other fits", "constants", "", "misfit"), cells, left=3)


def _sentence(found: Calibration, seconds: float) -> str:
    best = found.best
    hard = sum(target.hard for target in best.problem.targets)
    said = f"All {hard} hard targets are met" if best.met else "Not every hard target is met"
    said = said if hard else "Fitted"
    if found.degrees_of_freedom > 0:
        ratio = math.sqrt(best.misfit / found.degrees_of_freedom)
        noise = f"; the residuals are {number(ratio, 2)} times their tolerances"
        if ratio > _MISFIT:
            noise += (
                ": the model does not explain the values, and the confidence limits do not hold"
            )
    else:
        noise = "; there are as many constants as values, so the fit alone proves nothing"
    return f"{said}{noise}. {found.evaluations:,} evaluations in {duration(seconds)}."
