"""`flexor validate`: Flexor against closed forms and other libraries."""

from __future__ import annotations

from pathlib import Path as FilePath
from typing import TYPE_CHECKING, Annotated

import typer

from flexor.cli.console import err, out
from flexor.cli.table import show

if TYPE_CHECKING:
    from flexor.validate import Result


def validate(
    only: Annotated[
        list[str] | None,
        typer.Option(metavar="CASE,…", help="Run these cases only; may be repeated."),
    ] = None,
    listed: Annotated[bool, typer.Option("--list", help="List the cases and run none.")] = False,
    folder: Annotated[
        FilePath | None,
        typer.Option("--out", metavar="DIR", help="Write validation.md and its figures there."),
    ] = None,
) -> int:
    """Compare Flexor with closed forms and other libraries.

    Prints, for each quantity, its reference, Flexor's value, error and tolerance; ends with exit
    code 1 if one is off. References from other libraries are skipped where these are missing; what
    is printed then says how to install them, all in the extra `flexor[validate]`.

    For example:

    * `flexor validate --list`
    * `flexor validate --only cantilever,elastica`
    * `flexor validate --out docs`
    """
    from flexor import validate as validation

    names = [name.strip() for part in only or [] for name in part.split(",") if name.strip()]
    wanted = validation.chosen(names)
    if listed:
        rows = [
            (case.name, case.title, case.library.package if case.library else "") for case in wanted
        ]
        show(("case", "what it is", "needs"), rows, left=3)
        return 0
    results = []
    for case in wanted:
        with err.status(f"{case.name}: {case.title}"):
            results.append(validation.run(case))
        _tell(results[-1])
    counts = {word: sum(r.verdict == word for r in results) for word in _COLOURS}
    out.print(", ".join(f"{count} {word}" for word, count in counts.items() if count))
    if folder is not None:
        err.print(f"report: {validation.write(results, folder)}", markup=False, soft_wrap=True)
    return 1 if counts["failed"] else 0


_COLOURS = {"passed": "green", "failed": "bold red", "skipped": "yellow"}


def _tell(result: Result) -> None:
    from rich.markup import escape

    from flexor.validate.report import cells_of

    head = f"{result.case.name}: {result.case.title} ({result.seconds:.1f} s)"
    out.print(f"[{_COLOURS[result.verdict]}]{result.verdict}[/]", end=" ")
    out.print(head, markup=False, soft_wrap=True)
    if result.outcome is None:
        out.print(f"  {result.reason}\n", markup=False, soft_wrap=True)
        return
    rows = [
        (escape(found.quantity), *map(escape, cells_of(found, 7)), "" if found.passed else "failed")
        for found in result.outcome.comparisons
    ]
    show(("quantity", "reference", "Flexor", "error", "tolerance", ""), rows)
