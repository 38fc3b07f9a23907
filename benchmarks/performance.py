"""Run all performance benchmarks and write `docs/performance.md`.

Numbers are medians of several runs, interleaved where they are compared. `--quick` uses smaller
sizes and takes ten minutes on two idle cores; otherwise the sizes reach a million designs and a
thousand degrees of freedom. `--only speed gradients` updates these sections of a document of the
same day, machine, version and sizes. The exit code is 1 if the results of a peer or of a smaller
load step deviate by more than expected.
"""

from __future__ import annotations

import argparse
import datetime
import os
import re
import sys
import time
from collections.abc import Callable
from pathlib import Path

import gradients
import growth
import hotspots
import load_steps
import memory
import peers
import speed
import structure
from _machine import machine, others, warning
from _section import Missing, Section
from rich.console import Console

DOCS = Path(__file__).resolve().parents[1] / "docs"
Sections = dict[str, Callable[[], tuple[Section, bool]]]


def main() -> int:
    """Measure everything, and write the document."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--runs", type=int, default=3, help="number of runs; medians are reported")
    parser.add_argument("--quick", action="store_true", help="smaller sizes")
    parser.add_argument("--out", type=Path, default=DOCS, help="folder of the document")
    parser.add_argument("--only", nargs="+", choices=list(full(0)), help="sections to update")
    arguments = parser.parse_args()
    load, console, began = others(), Console(stderr=True), time.perf_counter()
    if warning(load):
        console.print(f"warning: {warning(load)}", markup=False)
    texts, fine = [], True
    works = quick(arguments.runs) if arguments.quick else full(arguments.runs)
    target = arguments.out / "performance.md"
    document = opening(load, quick=arguments.quick)
    if arguments.only:
        found = target.read_text(encoding="utf-8") if target.is_file() else ""
        if not found.startswith(opening(0.0, quick=arguments.quick)):
            parser.error(
                f"--only: {target} is missing or of another day, machine, version or size; "
                "run all benchmarks"
            )
        works, document = {name: works[name] for name in arguments.only}, found
    for i, (name, measure) in enumerate(works.items()):
        console.print(f"[bold]{i + 1} of {len(works)}: {name}[/bold]")
        section, good = measure()
        section.show()
        fine &= good
        if not good:
            section.parts.append("**Some results deviate by more than expected.**")
        image = f"images/{name}.png" if section.figure is not None else None
        if image is not None:
            (arguments.out / image).parent.mkdir(parents=True, exist_ok=True)
            section.save(arguments.out / image)
        texts.append(section.markdown(image))
    minutes = (time.perf_counter() - began) / 60.0
    for text in texts:
        document = renewed(document, text)
    target.write_text(document.rstrip() + "\n", encoding="utf-8")
    spent = sum(os.times()[:4]) / 60.0
    times = f"after {minutes:.1f} minutes, {spent:.1f} of processor time"
    console.print(f"{target}, {times}", markup=False)
    return 0 if fine else 1


def quick(runs: int) -> Sections:
    """Return what is measured in a few minutes."""
    return {
        "speed": lambda: (speed.measure(1_000, runs), True),
        "growth": lambda: (growth.measure(runs, quick=True), True),
        "structure": lambda: (structure.measure(runs, quick=True), True),
        "hotspots": lambda: profile(runs, short=True),
        "peers": lambda: peers.measure(runs, quick=True),
        "memory": lambda: (memory.measure(10_000, runs), True),
        "load steps": lambda: load_steps.measure(50, (3, 4, 5)[:runs]),
        "gradients": lambda: (gradients.measure(50, runs), True),
        "observables": lambda: (gradients.observed(50, runs), True),
    }


def full(runs: int) -> Sections:
    """Return all that is measured."""
    return {
        "speed": lambda: (speed.measure(2_000, max(runs, 5)), True),
        "growth": lambda: (growth.measure(runs, quick=False), True),
        "structure": lambda: (structure.measure(runs, quick=False), True),
        "hotspots": lambda: profile(runs, short=False),
        "peers": lambda: peers.measure(runs, quick=False),
        "memory": lambda: (memory.measure(100_000, runs), True),
        "load steps": lambda: load_steps.measure(400, (3, 4, 5)[:runs]),
        "gradients": lambda: (gradients.measure(200, runs), True),
        "observables": lambda: (gradients.observed(200, runs), True),
    }


def tried(measure: Callable[[], Section], title: str, command: str) -> tuple[Section, bool]:
    """Run a benchmark that needs optional tools, or report which one is missing."""
    try:
        return measure(), True
    except Missing as missing:
        return Section(title, command, [f"Skipped: {missing}"]), True


def profile(runs: int, *, short: bool) -> tuple[Section, bool]:
    """Profile the engine."""
    return tried(lambda: hotspots.measure(runs, quick=short), "Profile", "./dev bench hotspots")


def renewed(document: str, text: str) -> str:
    """Replace the section with the same heading, or append it."""
    heading = text.partition("\n")[0] + "\n"
    parts = re.split(r"^(?=## )", document, flags=re.MULTILINE)
    if not any(part.startswith(heading) for part in parts):
        return document + "\n" + text
    return "".join(text + "\n" if part.startswith(heading) else part for part in parts)


def opening(load: float, *, quick: bool) -> str:
    """Return the text before the sections."""
    command = "./dev bench" + " --quick" * quick
    lines = [
        "# Performance",
        "",
        f"Generated by `{command}`; each section names the command that reproduces it. Times are "
        "medians of several runs, interleaved where they are compared.",
        "",
        f"{datetime.date.today().isoformat()}; {machine()}.",
        "",
    ]
    if warning(load):
        lines += [f"**{warning(load)}**", ""]
    return "\n".join(lines)


if __name__ == "__main__":
    sys.exit(main())
