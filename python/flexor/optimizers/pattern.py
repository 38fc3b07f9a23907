"""Generalised pattern search, the paper's "PS"."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from flexor.optimizers.budgeted_evaluator import BudgetedEvaluator, BudgetExhausted
from flexor.optimizers.interface import (
    BatchFunction,
    Budget,
    FloatArray,
    ProgressCallback,
    SearchResult,
)
from flexor.optimizers.options import FRACTION, Options, Range, at_least, at_most, option
from flexor.optimizers.starts import starting_designs


@dataclass
class PollState:
    """State of the search from one start."""

    design: FloatArray  # (k,): best design so far
    value: float  # its value
    mesh: float  # mesh size of the next poll, as a fraction of each parameter's range


@dataclass(frozen=True)
class PatternSearch(Options):
    """Generalised pattern search (Torczon 1997) with the positive basis 2N and complete polling.

    Each iteration evaluates the 2k neighbours ``design ± mesh (upper - lower) e_i`` as one batch
    and moves to the best one if it is strictly better. The mesh is then expanded, otherwise
    contracted. Neighbours are projected onto the bounds (and dropped if that leaves the design
    unchanged), so that optima on bounds are reached exactly. Every coordinate thus lies on a
    lattice anchored at the start or at one of the bounds; there are finitely many designs per
    mesh size, and with strict decrease the mesh shrinks to its tolerance. The seed determines the
    polling order, which breaks ties, and the random starts.

    Several starts are polled together as one batch, each with its own mesh; the best one wins.

    Attributes
    ----------
    starts : int
        Number of starts, including the given ones.
    initial_mesh, largest_mesh : float
        Mesh sizes as fractions of each parameter's range.
    expansion, contraction : float
        Mesh factors after a successful and an unsuccessful poll.
    tolerance : float
        The search from a start ends when its mesh falls below this.
    """

    name = "pattern-search"
    title = "pattern search"
    aliases = ("ps", "gps")
    description = "the paper's PS: polls along the coordinate axes"

    starts: int = option(1, at_least(1))
    initial_mesh: float = option(0.25, at_most(1))
    largest_mesh: float = 1.0
    expansion: float = option(2.0, Range(lambda value: 1.0 <= value < np.inf, "at least 1"))
    contraction: float = option(0.5, FRACTION)
    tolerance: float = option(1e-6, FRACTION)

    def __post_init__(self) -> None:
        """Check the options; see `Options`."""
        super().__post_init__()
        between = Range(lambda mesh: self.initial_mesh <= mesh <= 1.0, "from initial_mesh to 1")
        self._require("largest_mesh", between)

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
                    mesh = max(poll.mesh for poll in polls)
                    remaining = sum(self._remaining(poll) for poll in polls)
                    progress(evaluator.progress(iteration, f"mesh {mesh:.3g}", remaining))
        except BudgetExhausted as stop:
            reason = str(stop)
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
    ) -> Iterator[list[PollState]]:
        """Run the search one iteration at a time.

        Yields
        ------
        list of PollState
            State of every start, initially and after each iteration. The objects are reused.
        """
        lower, upper = np.asarray(lower, dtype=np.float64), np.asarray(upper, dtype=np.float64)
        random = np.random.default_rng(seed)
        designs = starting_designs(start, self.starts, lower, upper, random)
        values = _nan_to_inf(function(designs))
        polls = [
            PollState(design, float(value), self.initial_mesh)
            for design, value in zip(designs, values, strict=True)
        ]
        yield polls
        while active := [poll for poll in polls if poll.mesh >= self.tolerance]:
            neighbours = [self._neighbours(poll, lower, upper, random) for poll in active]
            batch = np.concatenate(neighbours)
            values = _nan_to_inf(function(batch)) if len(batch) else np.empty(0)
            first = 0
            for poll, candidates in zip(active, neighbours, strict=True):
                self._update(poll, candidates, values[first : first + len(candidates)])
                first += len(candidates)
            yield polls

    def _neighbours(
        self, poll: PollState, lower: FloatArray, upper: FloatArray, random: np.random.Generator
    ) -> FloatArray:
        k = poll.design.size
        steps = poll.mesh * (upper - lower)
        basis = np.concatenate((np.diag(steps), np.diag(-steps)))[random.permutation(2 * k)]
        candidates: FloatArray = np.clip(poll.design + basis, lower, upper)
        return candidates[np.any(candidates != poll.design, axis=1)]

    def _update(self, poll: PollState, candidates: FloatArray, values: FloatArray) -> None:
        best = int(np.argmin(values)) if len(values) else -1
        if best >= 0 and values[best] < poll.value:
            poll.design, poll.value = candidates[best], float(values[best])
            poll.mesh = min(poll.mesh * self.expansion, self.largest_mesh)
        else:
            poll.mesh *= self.contraction

    def _remaining(self, poll: PollState) -> int:
        """Return the remaining evaluations of a start if it finds no further improvement."""
        contractions = math.log(poll.mesh / self.tolerance) / -math.log(self.contraction)
        return 2 * poll.design.size * max(math.floor(contractions) + 1, 0)


def _nan_to_inf(values: FloatArray) -> FloatArray:
    return np.where(np.isnan(values), np.inf, values)
