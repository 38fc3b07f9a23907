"""Performance and data profiles of a comparison."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexor.study.comparison.result import WITHIN, MethodComparison
from flexor.study.problem import FloatArray


@dataclass(frozen=True, eq=False)
class Profile:
    """An increasing step function: the fraction of problems solved at each cost."""

    method: str  # its label
    cost: FloatArray  # (n,), of the steps, ascending
    solved: FloatArray  # (n,), fraction solved from there on

    def at(self, cost: float) -> float:
        """Return the fraction solved at a cost."""
        below = int(np.searchsorted(self.cost, cost, side="right"))
        return float(self.solved[below - 1]) if below else 0.0


def performance_profiles(comparison: MethodComparison, within: float = WITHIN) -> list[Profile]:
    """Fraction of problems solved within a multiple of the fastest method (Dolan, Moré 2002).

    A problem is a parameter set with a seed; its cost for a method is the evaluations to the
    target (`MethodComparison.target`) over those of the method that needed fewest. At 1 stands how
    often a method was the fastest, far right how often it succeeded at all.
    """
    needed = {method: comparison.needed(method, within) for method in comparison.methods}
    fastest = np.min(np.stack(list(needed.values())), axis=0)
    ratios = {
        method: np.divide(mine, fastest, out=np.full(mine.shape, np.inf), where=np.isfinite(mine))
        for method, mine in needed.items()
    }
    return [_profile(method, ratio) for method, ratio in ratios.items()]


def data_profiles(comparison: MethodComparison, within: float = WITHIN) -> list[Profile]:
    """Fraction of problems that each method solves within a budget (Moré, Wild 2009).

    The budget is counted in groups of k + 1 evaluations, k the parameters of the set: what one
    simplex gradient costs.
    """
    group = np.array(list(comparison.sets.values()))[:, None] + 1.0
    return [
        _profile(method, comparison.needed(method, within) / group) for method in comparison.methods
    ]


def _profile(method: str, costs: FloatArray) -> Profile:
    cost = np.sort(costs[np.isfinite(costs)])
    return Profile(method, cost, np.arange(1, cost.size + 1) / costs.size)
