"""Generalised pattern search, the method of the paper ("PS")."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from flexor.errors import InputError
from flexor.optimizers.budgeted_evaluator import BudgetedEvaluator, BudgetSpent
from flexor.optimizers.interface import (
    BatchFunction,
    Budget,
    FloatArray,
    ProgressCallback,
    SearchResult,
)
from flexor.optimizers.starts import starting_designs


@dataclass
class Poll:
    """One start of a pattern search: its best design so far and its mesh.

    Attributes
    ----------
    design : (k,) array
        Best design of this start.
    value : float
        Its value.
    mesh : float
        Step of the next poll as a fraction of the range of each parameter.
    """

    design: FloatArray
    value: float
    mesh: float


@dataclass(frozen=True)
class PatternSearch:
    """Generalised pattern search (Torczon 1997) on the positive basis 2N, with complete polls.

    Each iteration evaluates the 2k neighbours ``design ± mesh (upper - lower) e_i`` as one batch
    and moves to the best of them if it is strictly better; then the mesh is doubled, else halved.
    A neighbour beyond a bound is moved onto the bound (and left out if that is where the design
    is already), so that optima on bounds are reached exactly and not by halving. Each coordinate
    therefore lies on a lattice anchored at the start, at the lower or at the upper bound: for each
    mesh there are finitely many designs, and with strict decrease the mesh must shrink to its
    tolerance. The seed orders the polls, which decides between equal neighbours, and draws
    the starts that are not given.

    Several starts are polled together as one batch; each keeps its own mesh, and the best wins.

    Attributes
    ----------
    starts : int
        Number of starts, the given ones included.
    initial_mesh, largest_mesh : float
        As fractions of the range of each parameter.
    expansion, contraction : float
        Factors of the mesh after success and failure.
    tolerance : float
        A start is done when its mesh falls below this.
    """

    starts: int = 1
    initial_mesh: float = 0.25
    largest_mesh: float = 1.0
    expansion: float = 2.0
    contraction: float = 0.5
    tolerance: float = 1e-6

    def __post_init__(self) -> None:
        """Check the options.

        Raises
        ------
        InputError
            If one is out of its range.
        """
        for option, inside, allowed in (
            ("starts", self.starts >= 1, "at least 1"),
            ("initial_mesh", 0.0 < self.initial_mesh <= 1.0, "above 0 and at most 1"),
            (
                "largest_mesh",
                self.initial_mesh <= self.largest_mesh <= 1.0,
                "from initial_mesh to 1",
            ),
            ("expansion", 1.0 <= self.expansion < np.inf, "at least 1"),
            ("contraction", 0.0 < self.contraction < 1.0, "between 0 and 1"),
            ("tolerance", 0.0 < self.tolerance < 1.0, "between 0 and 1"),
        ):
            if not inside:
                raise InputError(
                    f"option {option} of pattern-search must be {allowed}, "
                    f"got {getattr(self, option):g}."
                )

    @property
    def name(self) -> str:
        """``"pattern-search"``."""
        return "pattern-search"

    def minimize(
        self,
        function: BatchFunction,
        lower: FloatArray,
        upper: FloatArray,
        start: ArrayLike | None = None,
        seed: int = 0,
        budget: Budget | None = None,
        progress: ProgressCallback | None = None,
    ) -> SearchResult:
        """Minimise; see `flexor.optimizers.Search`."""
        evaluator = BudgetedEvaluator(function, budget)
        iteration, reason = 0, f"the mesh is below {self.tolerance:g}"
        try:
            for iteration, polls in enumerate(self.iterate(evaluator, lower, upper, start, seed)):
                if progress is not None:
                    widest = max(poll.mesh for poll in polls)
                    left = sum(self._remaining(poll) for poll in polls)
                    progress(evaluator.progress(iteration, f"mesh {widest:.3g}", left))
        except BudgetSpent as spent:
            reason = str(spent)
            if progress is not None:
                progress(evaluator.progress(iteration + 1, reason, 0))
        return evaluator.result(iteration, reason)

    def iterate(
        self,
        function: BatchFunction,
        lower: FloatArray,
        upper: FloatArray,
        start: ArrayLike | None = None,
        seed: int = 0,
    ) -> Iterator[list[Poll]]:
        """Search step by step.

        Yields
        ------
        list of Poll
            Every start after each iteration, first before any poll. The same objects each time.
        """
        lower, upper = np.asarray(lower, dtype=np.float64), np.asarray(upper, dtype=np.float64)
        random = np.random.default_rng(seed)
        designs = starting_designs(start, self.starts, lower, upper, random)
        values = _without_nan(function(designs))
        polls = [
            Poll(design, float(value), self.initial_mesh)
            for design, value in zip(designs, values, strict=True)
        ]
        yield polls
        while active := [poll for poll in polls if poll.mesh >= self.tolerance]:
            neighbours = [self._neighbours(poll, lower, upper, random) for poll in active]
            batch = np.concatenate(neighbours)
            values = _without_nan(function(batch)) if len(batch) else np.empty(0)
            first = 0
            for poll, around in zip(active, neighbours, strict=True):
                self._move(poll, around, values[first : first + len(around)])
                first += len(around)
            yield polls

    def _neighbours(
        self, poll: Poll, lower: FloatArray, upper: FloatArray, random: np.random.Generator
    ) -> FloatArray:
        k = poll.design.size
        steps = poll.mesh * (upper - lower)
        basis = np.concatenate((np.diag(steps), np.diag(-steps)))[random.permutation(2 * k)]
        around: FloatArray = np.clip(poll.design + basis, lower, upper)
        return around[np.any(around != poll.design, axis=1)]

    def _move(self, poll: Poll, around: FloatArray, values: FloatArray) -> None:
        best = int(np.argmin(values)) if len(values) else -1
        if best >= 0 and values[best] < poll.value:
            poll.design, poll.value = around[best], float(values[best])
            poll.mesh = min(poll.mesh * self.expansion, self.largest_mesh)
        else:
            poll.mesh *= self.contraction

    def _remaining(self, poll: Poll) -> int:
        """Count the evaluations of a start that finds nothing better any more."""
        halvings = math.log(poll.mesh / self.tolerance) / -math.log(self.contraction)
        return 2 * poll.design.size * max(math.floor(halvings) + 1, 0)


def _without_nan(values: FloatArray) -> FloatArray:
    return np.where(np.isnan(values), np.inf, values)
