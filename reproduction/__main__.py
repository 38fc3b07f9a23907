"""Reproduce the published study: `./dev reproduce`.

Every result is saved as soon as it is computed; after an interruption, the same command resumes.
"""

from __future__ import annotations

import argparse
import sys
import time
from pathlib import Path

from rich.console import Console

from flexor.errors import InputError
from reproduction.report import ITEMS, chosen, write_docs, write_report
from reproduction.study import HERE, QUICK, Effort, Study

DOCS = HERE.parent / "docs" / "reproduction.md"


def main(arguments: list[str] | None = None) -> int:
    """Run the command; return its exit code."""
    parser = argparse.ArgumentParser(prog="dev reproduce", description=__doc__)
    parser.add_argument(
        "--what",
        metavar="ITEMS",
        help=f"comma-separated subset of {', '.join(ITEMS)}; default: all",
    )
    parser.add_argument(
        "--out", type=Path, default=Path("out/reproduction"), help="folder of results and report"
    )
    parser.add_argument("--seed", type=int, default=0, help="random seed")
    parser.add_argument(
        "--quick",
        action="store_true",
        help="tiny budgets, to test the scripts; the numbers are not valid",
    )
    parser.add_argument(
        "--write", action="store_true", help="also write docs/reproduction.md and its images"
    )
    options = parser.parse_args(arguments)
    console, began = Console(stderr=True), time.monotonic()
    try:
        names = chosen(options.what)
        if options.write and (options.quick or names != tuple(ITEMS)):
            raise InputError("--write requires the whole study: omit --what and --quick.")
        if options.seed < 0:
            raise InputError(f"--seed must be at least 0, got {options.seed}.")
        with console.status("") as status:
            study = Study(
                options.out, QUICK if options.quick else Effort(), options.seed,
                lambda what: status.update(f"computing {what}"),
            )  # fmt: skip
            results = {}
            for name in names:
                started = time.monotonic()
                results[name] = ITEMS[name].compute(study)
                console.print(f"{name:<12} {time.monotonic() - started:6.1f} s", highlight=False)
            status.update("drawing")
            report = write_report(study, results)
            if options.write:
                write_docs(report, DOCS)
    except InputError as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        print("interrupted; run the same command again to resume.", file=sys.stderr)
        return 130
    print(f"report: {report / 'report.html'} ({time.monotonic() - began:.0f} s)")
    return 0


if __name__ == "__main__":
    sys.exit(main())
