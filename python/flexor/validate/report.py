"""The report of a validation: Markdown with tables and figures."""

from __future__ import annotations

import os
import platform
import sys
from collections.abc import Sequence
from datetime import date
from importlib import metadata
from pathlib import Path as FilePath

from flexor.errors import InputError
from flexor.validate.case import FAMILIES
from flexor.validate.comparison import Comparison
from flexor.validate.running import Result

IMAGES = FilePath("images") / "validation"
_INTRODUCTION = """\
# Validation

Written by `flexor validate --out docs`; no reference value in it was produced by Flexor. The models
go the whole way from the tables of a model file to the engine.

*Error* is the largest deviation divided by the scale of the quantity (its largest reference
value, or what it says it is divided by); of an array, the reference and Flexor's value are shown
where they differ most. A case passes if no error exceeds its *tolerance*; `flexor validate` ends
with exit code 1 if one fails. Cases that need another library are skipped where it is missing;
the extra `flexor[validate]` brings all of them, and a skipped case says how to install it here.
"""


def write(results: Sequence[Result], folder: FilePath) -> FilePath:
    """Write the report and its figures.

    Parameters
    ----------
    results
        Cases that were run.
    folder
        Where to write ``validation.md`` and ``images/validation/``.

    Returns
    -------
    pathlib.Path
        The report.

    Raises
    ------
    InputError
        If the folder cannot be written.
    """
    target = folder / "validation.md"
    try:
        (folder / IMAGES).mkdir(parents=True, exist_ok=True)
        figures = {result.case.name: _figure(result, folder) for result in results}
        target.write_text(markdown(results, figures), encoding="utf-8")
    except OSError as error:
        raise InputError(f"cannot write the report {target}: {error.strerror}.") from None
    return target


def markdown(results: Sequence[Result], figures: dict[str, bool]) -> str:
    """Return the text of the report.

    Parameters
    ----------
    results
        Cases that were run.
    figures
        Of each case, whether it has a figure.
    """
    parts = [_INTRODUCTION, _circumstances(results), _summary(results)]
    for family in FAMILIES:
        members = [result for result in results if result.case.family == family]
        if members:
            parts.append(f"## {family}\n")
        parts += [_section(result, figures[result.case.name]) for result in members]
    return "\n".join(parts)


def _circumstances(results: Sequence[Result]) -> str:
    packages = ["flexor", "numpy", "scipy"]
    versions = [f"{package} {metadata.version(package)}" for package in packages]
    libraries = {result.case.library for result in results if result.outcome is not None}
    versions += sorted(library.version for library in libraries if library is not None)
    machine = f"{platform.system()} {platform.machine()}, {os.cpu_count()} cores"
    python = ".".join(str(part) for part in sys.version_info[:3])
    return f"{date.today().isoformat()}, Python {python}, {machine}: {', '.join(versions)}.\n"


def _summary(results: Sequence[Result]) -> str:
    lines = ["| Case | | Quantities | Closest to its tolerance | |", "|---|---|--:|--:|---|"]
    for result in results:
        count, share = "", ""
        if result.outcome is not None:
            found = result.outcome.comparisons
            count, share = str(len(found)), f"{100.0 * max(map(_share, found)):.2g} %"
        cells = (f"[{result.case.name}](#{result.case.name})", result.case.title, count, share)
        lines.append(f"| {' | '.join(cells)} | {_mark(result)} |")
    return "\n".join(lines) + "\n"


def _share(comparison: Comparison) -> float:
    if comparison.tolerance > 0.0:
        return comparison.error / comparison.tolerance
    return 0.0 if comparison.passed else float("inf")


def _mark(result: Result) -> str:
    return result.verdict if result.passed or result.skipped else f"**{result.verdict}**"


def _section(result: Result, figure: bool) -> str:
    case = result.case
    lines = [f"### {case.name}", "", f"**{case.title}.** {case.about}", ""]
    if result.outcome is None:
        return "\n".join([*lines, f"{result.verdict.capitalize()}: {result.reason}.", ""])
    lines += [
        "| Quantity | Values | Reference | Flexor | Error | Tolerance | |",
        "|---|--:|--:|--:|--:|--:|---|",
    ]
    for found in result.outcome.comparisons:
        cells = (found.quantity, str(found.count), *cells_of(found))
        lines.append(f"| {' | '.join(cells)} | {'passed' if found.passed else '**failed**'} |")
    if figure:
        image = (IMAGES / f"{case.name}.png").as_posix()
        lines += ["", f"![{case.title}]({image})", "", f"*{result.outcome.caption}*"]
    return "\n".join([*lines, ""])


def cells_of(found: Comparison, digits: int = 10) -> tuple[str, str, str, str]:
    """Return reference, ours, error and tolerance as they are shown.

    Parameters
    ----------
    found
        A comparison.
    digits
        Of the two values.
    """
    if isinstance(found.reference, str):
        return found.reference, str(found.ours), "", ""
    reference, ours = (
        "0" if value == 0.0 else f"{float(value):.{digits}g}"
        for value in (found.reference, found.ours)
    )
    return reference, ours, f"{found.error:.1e}", f"{found.tolerance:.2g}"


def _figure(result: Result, folder: FilePath) -> bool:
    """Draw the case, if it knows how; say whether it does."""
    if result.outcome is None or result.outcome.draw is None:
        return False
    from matplotlib.figure import Figure

    from flexor.plot.style import PAGE, save, style

    with style():
        size = (4.8, 3.2) if result.outcome.panels == 1 else (PAGE, 0.4 * PAGE)
        figure = Figure(figsize=size, layout="constrained")
        result.outcome.draw(figure)
    save(figure, folder / IMAGES / f"{result.case.name}.png")
    return True
