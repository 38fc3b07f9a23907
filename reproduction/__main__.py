"""Reproduce the published study: `./dev reproduce`.

Every finished result is kept in the folder at once: run the same command again after an
interruption, and it continues.
"""

from __future__ import annotations

import argparse
import sys
import time
from pathlib import Path

from rich.console import Console

from flexor.errors import InputError
from reproduction.report import ITEMS, chosen, write_docs, write_report
from reproduction.study import BRIEF, HERE, Effort, Study

DOCS = HERE.parent / "docs" / "reproduction.md"


def main(arguments: list[str] | None = None) -> int:
    """Run the command; return its exit code."""
    reading = argparse.ArgumentParser(prog="dev reproduce", description=__doc__)
    reading.add_argument(
        "--what", metavar="ITEMS", help=f"some of {', '.join(ITEMS)}, with commas; all by default"
    )
    reading.add_argument(
        "--out", type=Path, default=Path("out/reproduction"), help="folder of results and report"
    )
    reading.add_argument("--seed", type=int, default=0, help="random seed")
    reading.add_argument(
        "--brief", action="store_true", help="tiny budgets, to try the scripts: no valid numbers"
    )
    reading.add_argument(
        "--write", action="store_true", help="also write docs/reproduction.md and its images"
    )
    asked = reading.parse_args(arguments)
    console, began = Console(stderr=True), time.monotonic()
    try:
        names = chosen(asked.what)
        if asked.write and (asked.brief or names != tuple(ITEMS)):
            raise InputError("--write needs the whole study: leave out --what and --brief.")
        if asked.seed < 0:
            raise InputError(f"--seed must be at least 0, got {asked.seed}.")
        with console.status("") as status:
            study = Study(
                asked.out, BRIEF if asked.brief else Effort(), asked.seed,
                lambda what: status.update(f"computing {what}"),
            )  # fmt: skip
            results = {}
            for name in names:
                first = time.monotonic()
                results[name] = ITEMS[name].compute(study)
                console.print(f"{name:<12} {time.monotonic() - first:6.1f} s", highlight=False)
            status.update("drawing")
            report = write_report(study, results)
            if asked.write:
                write_docs(report, DOCS)
    except InputError as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        print("interrupted; run the same command again to continue.", file=sys.stderr)
        return 130
    print(f"report: {report / 'report.html'} ({time.monotonic() - began:.0f} s)")
    return 0


if __name__ == "__main__":
    sys.exit(main())
