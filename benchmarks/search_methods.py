"""How reliably each method finds the best known designs, written to docs/search-methods.md.

Every method searches each problem (`_design_problems.py`) from random starts with an equal budget.
A search succeeds when it reaches 99 % of the gain of the best known design, found by long searches
(`best_known.py`), over the default design. Searches are recorded in a folder, so that the benchmark
can be interrupted and run again.
"""

from __future__ import annotations

import argparse
from dataclasses import replace
from pathlib import Path

import numpy as np
from _design_problems import CONSTANTS, DEMO, NAMES, SETS, best_known, problem, record, recorded
from _machine import machine

import flexor
from flexor import plot
from flexor.optimizers import available, entries
from flexor.study.comparison import MethodComparison, compare

ROOT = Path(__file__).resolve().parent.parent
PAGE, FIGURE = ROOT / "docs/search-methods.md", ROOT / "docs/images/search-methods.png"
OURS = "auto"
WANTED = 0.9  # of the searches that should succeed
LEFT_OUT = (OURS, "grid", "pareto", "surrogate", "levenberg-marquardt")


def main() -> None:
    """Search, then write the page and the figure."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--problems", nargs="+", default=NAMES, choices=NAMES)
    parser.add_argument("--seeds", type=int, default=10, help="searches of each problem by auto")
    parser.add_argument("--others", type=int, default=10, help="searches by each other method")
    parser.add_argument("--methods", nargs="+", default=None, help="other methods; by default all")
    parser.add_argument("--budget", type=int, default=3000, help="designs of each search")
    parser.add_argument("--folder", type=Path, default=ROOT / "out/search-methods")
    parser.add_argument("--workers", type=int, default=0)
    options = parser.parse_args()
    others = options.methods or [name for name in available() if name not in LEFT_OUT]
    known = best_known()

    def compared(label: str, methods: list[str], seeds: int) -> MethodComparison:
        parts = []
        if sets := [name for name in options.problems if name in SETS]:
            folder = options.folder / f"{label}-sets"
            parts.append(
                compare(
                    flexor.load("finger", CONSTANTS), sets, "bending", methods=methods,
                    seeds=seeds, budget=options.budget, known=known, folder=folder,
                    resume=folder.exists(), workers=options.workers,
                )
            )  # fmt: skip
        if DEMO in options.problems:
            folder, stated = options.folder / f"{label}-{DEMO}", problem(DEMO)
            design = stated.model.file.design
            assert design is not None
            found = compare(
                stated.model, [stated.parameters], design.aims[0], methods=methods,
                subject_to=design.subject_to, without=design.without, seeds=seeds,
                budget=options.budget, folder=folder, resume=folder.exists(),
                workers=options.workers,
            )  # fmt: skip
            parts.append(_renamed(found, stated.parameters.name, known))
        return _joined(parts)

    ours = compared(OURS, [OURS], options.seeds)
    rivals = compared("others", others, options.others) if options.others else None
    for found in (ours, rivals):
        if found is not None:
            _keep_better(found)
    PAGE.write_text(page(ours, rivals), encoding="utf-8")
    print(f"written: {PAGE.relative_to(ROOT)}")
    if rivals is not None:
        plot.save(plot.profiles(_together(ours, rivals)), FIGURE)
        print(f"written: {FIGURE.relative_to(ROOT)}")


def _keep_better(found: MethodComparison) -> None:
    """Record designs that are better than the best known."""
    for name in found.sets:
        best, stated = found.best(name), problem(name)
        known = recorded().get(name)
        if known is not None and best.result.value >= known["value"] - 1e-9:
            continue
        paths = stated.evaluate(best.result.design[None, :])
        run = {
            "run": f"search_methods, seed {best.seed}",
            "method": best.method,
            "designs": best.result.evaluations,
            "seconds": round(best.seconds),
            "violation": float(paths.violation[0]),
            "value": float(paths.value[0]),
            "design": best.result.design.tolist(),
        }
        record(name, run, stated)


def _renamed(found: MethodComparison, name: str, known: dict[str, float]) -> MethodComparison:
    """Return a comparison on the demo with that as the name of its only problem."""
    return replace(
        found,
        sets={DEMO: found.sets[name]},
        reference={DEMO: found.reference[name]},
        runs=tuple(replace(run, parameters=DEMO) for run in found.runs),
        known=known,
    )


def _joined(parts: list[MethodComparison]) -> MethodComparison:
    """Join comparisons of the same methods and seeds on different problems."""
    first = parts[0]
    return replace(
        first,
        sets={name: size for part in parts for name, size in part.sets.items()},
        reference={name: value for part in parts for name, value in part.reference.items()},
        runs=tuple(run for part in parts for run in part.runs),
    )


def _together(ours: MethodComparison, rivals: MethodComparison) -> MethodComparison:
    """Return both, on the seeds that they have in common."""
    seeds = tuple(seed for seed in rivals.seeds if seed in ours.seeds)
    return replace(
        rivals,
        methods=(*ours.methods, *rivals.methods),
        seeds=seeds,
        runs=tuple(run for run in (*ours.runs, *rivals.runs) if run.seed in seeds),
    )


def page(ours: MethodComparison, rivals: MethodComparison | None) -> str:
    """Return docs/search-methods.md."""
    problems = list(ours.sets)
    demo = " and on the problem that `examples/pneumatic-finger.toml` states, with its constraints"
    demo = f"{demo}, without tolerances (demo)" if DEMO in problems else ""
    seeds = f"--seeds {len(ours.seeds)} --others {0 if rivals is None else len(rivals.seeds)}"
    lines = [
        "# Search methods, measured",
        "",
        f"<!-- Written by `python benchmarks/search_methods.py {seeds}`; do not edit. -->",
        "",
        f"Searches with at most {ours.budget:,} designs from random starts, on the seven sets of "
        f"the paper (f_b, variant `{CONSTANTS}`){demo}. A search succeeds "
        "when it reaches 99 % of the gain of the best known design over the default design; if "
        "that is infeasible, over the worst of the first feasible designs.",
        "",
        f"{machine()}.",
        "",
        f"## `{OURS}`",
        "",
        f"{len(ours.seeds)} searches of each problem. *gain*: of the best known, at the median and "
        "at the worst of the searches; *to 1 %*: median designs of the successful searches.",
        "",
        "| problem | parameters | default | best known | successes | gain, median | gain, worst | "
        "to 1 % | designs |",
        "|---|--:|--:|--:|--:|--:|--:|--:|--:|",
    ]
    resisting = []
    for name in problems:
        found, best = ours.summary(name, OURS), ours.best_known(name)
        target = ours.target(name)
        first = best + (target - best) / 0.01
        gains = [
            f"{100.0 * (first - v) / (first - best):.1f} %" for v in (found.median, found.worst)
        ]
        lines.append(
            f"| {name} | {ours.sets[name]} | {first:.5g} | {best:.6g} | "
            f"{found.success * found.searches:.0f} of {found.searches} | {' | '.join(gains)} | "
            f"{found.evaluations:.0f} | {found.spent:.0f} |"
        )
        if found.success < WANTED:
            last = [
                each.result.improvement_evaluations[-1]
                for each in ours.runs
                if each.parameters == name
            ]
            resisting.append(
                f"{name} (half of the searches reach {gains[0]} of the gain, all {gains[1]}; the "
                f"last improvement is after {np.median(last):,.0f} designs)"
            )
    if resisting:
        lines += [
            "",
            f"Fewer than {100 * WANTED:.0f} % of the searches succeed on {', '.join(resisting)}.",
        ]
    if rivals is not None:
        together = _together(ours, rivals)
        lines += [
            "",
            "## All methods",
            "",
            f"Successes of {_counted(len(together.seeds))} of each problem, and in brackets the "
            "median number of designs of the successful ones.",
            "",
            f"| method | {' | '.join(problems)} | all |",
            f"|---|{'--:|' * (len(problems) + 1)}",
        ]
        rows = []
        for method in together.methods:
            cells, total = [], 0
            for name in problems:
                found = together.summary(name, method)
                count = round(found.success * found.searches)
                total += count
                cells.append(f"{count} ({found.evaluations:.0f})" if count else "0")
            title = entries()[method].title
            rows.append((-total, f"| {title} | {' | '.join(cells)} | {total} |"))
        lines += [row for _, row in sorted(rows)]
        lines += [
            "",
            "![Performance and data profiles of all methods](images/search-methods.png)",
        ]
    lines += [
        "",
        "## Best known designs",
        "",
        *_best_known_table({name: ours.target(name) for name in problems}),
    ]
    return "\n".join(lines) + "\n"


def _counted(searches: int) -> str:
    """Return a number of searches in words; one alone shows little."""
    return "one search" if searches == 1 else f"{searches} searches"


def _best_known_table(targets: dict[str, float]) -> list[str]:
    table = recorded()
    lines = [
        "Found by `python benchmarks/best_known.py`, long searches by a multistage search, `auto`, "
        "differential evolution, CMA-ES and pattern search from random starts, or by a search of "
        "the tables above where that is better; every run is in `benchmarks/best_known.json`. "
        "*as good*: runs within 1 % of the gain of the best.",
        "",
        "| problem | value | runs | designs of each | as good | by |",
        "|---|--:|--:|--:|--:|---|",
    ]
    for name in targets:
        runs = table[name]["runs"]
        best = min(runs, key=lambda run: (run["violation"], run["value"]))
        most = max(run["designs"] for run in runs)
        first = targets[name]
        as_good = sum(run["violation"] == 0.0 and run["value"] <= first for run in runs)
        lines.append(
            f"| {name} | {best['value']:.6g} | {len(runs)} | {most:,} | {as_good} | "
            f"{best['method']} |"
        )
    return lines


if __name__ == "__main__":
    main()
