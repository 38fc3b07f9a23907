"""The paper's finger with what its discussion leaves out, one after another: `./dev beyond`.

Every result is saved as soon as it is computed; after an interruption, the same command resumes.
"""

from __future__ import annotations

import argparse
import sys
import time
from pathlib import Path

from rich.console import Console

from flexor.errors import InputError, unknown
from reproduction.beyond.cases import CASES, compute
from reproduction.beyond.page import write_docs, write_page
from reproduction.study import HERE, QUICK, Effort, Study

DOCS = HERE.parent / "docs" / "beyond.md"
# Fewer designs than the reproduction has, as there are many cases with few parameters.
EFFORT = Effort(multistage=900)


def main(arguments: list[str] | None = None) -> int:
    """Run the command; return its exit code."""
    parser = argparse.ArgumentParser(prog="dev beyond", description=__doc__)
    parser.add_argument(
        "--out", type=Path, default=Path("out/beyond"), help="folder of results and page"
    )
    parser.add_argument("--seed", type=int, default=0, help="random seed")
    parser.add_argument(
        "--what",
        metavar="CASES",
        help=f"comma-separated cases to compute, of {', '.join(CASES)}, without the page",
    )
    parser.add_argument(
        "--quick",
        action="store_true",
        help="tiny budgets, to test the script; the numbers are not valid",
    )
    parser.add_argument(
        "--write", action="store_true", help="also write docs/beyond.md and its images"
    )
    options = parser.parse_args(arguments)
    console, began = Console(stderr=True), time.monotonic()
    try:
        names = _chosen(options.what)
        if options.write and (options.quick or options.what):
            raise InputError("--write requires all cases: omit --what and --quick.")
        if options.seed < 0:
            raise InputError(f"--seed must be at least 0, got {options.seed}.")
        study = Study(options.out, QUICK if options.quick else EFFORT, options.seed)
        results = {}
        for index, name in enumerate(names, start=1):
            started = time.monotonic()
            with console.status(f"{CASES[name].title} ({index} of {len(names)})"):
                results[name] = compute(study, name)
            console.print(f"{name:<12} {time.monotonic() - started:6.1f} s", highlight=False)
        if options.what:
            print(f"results: {study.folder} ({time.monotonic() - began:.0f} s)")
            return 0
        page = write_page(study, results)
        if options.write:
            write_docs(page, DOCS)
    except InputError as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        print("interrupted; run the same command again to resume.", file=sys.stderr)
        return 130
    print(f"page: {page} ({time.monotonic() - began:.0f} s)")
    return 0


def _chosen(names: str | None) -> tuple[str, ...]:
    if names is None:
        return tuple(CASES)
    wanted = [name.strip() for name in names.split(",") if name.strip()]
    for name in wanted:
        if name not in CASES:
            raise unknown("case", name, CASES)
    if not wanted:
        raise InputError(f"--what names no case: expected some of {', '.join(CASES)}.")
    return tuple(wanted)


if __name__ == "__main__":
    sys.exit(main())
