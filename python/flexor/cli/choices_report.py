"""Output of `flexor optimize --choose`: what was tried, and the best combination."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import AbstractContextManager
from pathlib import Path
from typing import TYPE_CHECKING, Any

from flexor.cli import outcome
from flexor.cli.console import print_json, say
from flexor.cli.folders import carry_out_searches, interrupted
from flexor.cli.progress import duration
from flexor.cli.saving import save_model
from flexor.cli.table import number, show
from flexor.study.optimum import optimum_files

if TYPE_CHECKING:
    from flexor.study import Choices

_MARKS = ("", " (not robust)", " (not feasible)")


def carry_out(
    work: Callable[..., Choices],
    executor: AbstractContextManager[Any],
    place: Path,
    plot: Path | None,
    save: Path | None,
    as_json: bool,
    resumed: bool = False,
) -> int:
    """Try all combinations, print them and the best; return the exit code."""
    from flexor.study import is_choices

    def report(found: Choices, seconds: float) -> None:
        if as_json:
            print_json(_as_json(found, seconds, place))
        else:
            _print(found, seconds, resumed)
        outcome.draw(found.best, found.best.best, plot, as_json, place)
        save_model(found.best.best, save, f"the best design of {place}")

    def stopped(error: BaseException) -> int:
        return interrupted(place, "flexor optimize --resume", error, is_choices(place))

    return carry_out_searches(executor, work, report, stopped)


def _as_json(found: Choices, seconds: float, place: Path) -> dict[str, Any]:
    """Return what was tried, and the best design as of any study."""
    tried = [
        {
            "choices": dict(each.combination.values),
            "violation": each.violation,
            "value": each.value,
            "robust": each.robust,
            "rounds": each.rounds,
            "evaluations": each.study.evaluations,
            "folder": each.study.folder,
        }
        for each in found.tried
    ]
    best = outcome.as_json(found.best, found.best.best, seconds)
    chosen = {"choices": dict(found.combination.values), "tried": tried, "failed": found.failed}
    own = {"folder": place, "evaluations": found.evaluations, "models": optimum_files(place)}
    return {**chosen, **best, **own}


def _print(found: Choices, seconds: float, resumed: bool) -> None:
    best = found.best
    problem = best.problem
    rows = []
    for each in found.tried:
        shown = "fails"
        if each.value < float("inf"):
            shown = number(each.study.best.shown) + _MARKS[each.standing]
        rows.append((each.name, f"{each.study.evaluations:,}", str(each.rounds), shown))
    unit = f" / {problem.unit}" if problem.unit else ""
    show(("combination", "designs", "rounds", f"{problem.quantity}{unit}"), rows)
    for name, why in found.failed.items():
        say(f"{name} could not be searched: {why}")
    say(f"best of {len(rows)} combinations: {found.combination.name}.")
    outcome.print_summary(best, best.best, seconds, cost=_cost(found, seconds, resumed))


def _cost(found: Choices, seconds: float, resumed: bool) -> str:
    count = f"{found.evaluations:,} designs of all combinations"
    if resumed and not found.evaluated:
        return f"{count} in total: all searches had ended, and nothing was evaluated."
    more = f"in total, {found.evaluated:,} of them now in" if resumed else "in"
    return f"{count} {more} {duration(seconds)}."
