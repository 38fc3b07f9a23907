"""Check the optima of the published study with ten independent searches each.

Compares the optimum of every parameter set, as found by `flexor reproduce`, with ten independent
searches with five times its evaluations: differential evolution, CMA-ES and pattern search in turn,
from random starts. The exit code is 1 if one of them improves the gain over the default design by
more than 0.1 %, or if a set is worse than one of its subsets. Takes half an hour on two cores.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
from pathlib import Path

from _machine import machine
from rich.console import Console
from rich.progress import track
from rich.table import Table

import flexor
from flexor.optimizers import CmaEs, DifferentialEvolution, PatternSearch, Search
from flexor.paper import Settings
from flexor.paper.context import Context
from flexor.paper.folder import Folder
from flexor.paper.optimum import true_optimum
from flexor.paper.settings import OBJECTIVES, SETS
from flexor.paper.table3 import NESTED

SEARCHES, TIMES, SLACK = 10, 5, 1e-3


def rival(seed: int, budget: int, size: int) -> Search:
    """Return the search for a seed, with enough restarts or starts to use its budget."""
    kinds: tuple[Search, ...] = (
        DifferentialEvolution(population=60, patience=1_000_000),
        CmaEs(restarts=50),
        PatternSearch(starts=max(budget // (60 * size), 8)),
    )
    return kinds[seed % len(kinds)]


def main() -> int:
    """Run the searches and print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--sets", nargs="+", default=SETS, choices=SETS)
    parser.add_argument("--objective", default="bending", choices=OBJECTIVES)
    parser.add_argument("--constants", default="calibrated")
    parser.add_argument("--thorough", type=int, default=Settings().thorough)
    arguments = parser.parse_args()
    settings = Settings(constants=arguments.constants, thorough=arguments.thorough)
    table = Table(
        "set",
        f"optimum {arguments.objective}",
        "evaluations",
        "best rival",
        "rival",
        "as good",
        "true",
    )
    sound = True
    with tempfile.TemporaryDirectory() as place:
        folder = Folder.create(Path(place) / "o", {"settings": {}, "provenance": {}, "items": []})
        context = Context(settings, folder, lambda _: None)
        optima = {name: true_optimum(context, name, arguments.objective) for name in arguments.sets}
        unchanged = context.problem("L", arguments.objective)
        default = float(unchanged.evaluate(unchanged.parameters.start[None, :]).value[0])
        ours = {name: optimum.value for name, optimum in optima.items()}
        for name in arguments.sets:
            problem = context.problem(name, arguments.objective)
            budget = TIMES * optima[name].evaluations
            slack = SLACK * (default - ours[name])
            found = []
            for seed in track(range(SEARCHES), name, console=Console(stderr=True)):
                search = rival(seed, budget, problem.parameters.size)
                study = flexor.optimize(
                    problem.model, problem.parameters, arguments.objective, search,
                    start="random", seed=1000 + seed, budget=budget,
                )  # fmt: skip
                found.append((study.best.value, search.name))
            best, method = min(found)
            true = ours[name] <= best + slack
            as_good = sum(value <= ours[name] + slack for value, _ in found)
            held = all(ours[name] <= ours[inner] for inner in NESTED.get(name, ()) if inner in ours)
            sound &= true and held
            table.add_row(
                name, f"{ours[name]:.6f}", f"{optima[name].evaluations:,}", f"{best:.6f}", method,
                f"{as_good} of {SEARCHES}", "yes" if true and held else "NO",
            )  # fmt: skip
            listed = ", ".join(f"{value:.6f} ({by})" for value, by in sorted(found))
            Console(stderr=True).print(f"{name}: {ours[name]:.6f} against {listed}", soft_wrap=True)
    print(machine(), f"constants {arguments.constants}, thorough {arguments.thorough}")
    Console().print(table)
    return 0 if sound else 1


if __name__ == "__main__":
    sys.exit(main())
