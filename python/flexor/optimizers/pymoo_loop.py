"""The generation loop of the population methods from pymoo."""

from __future__ import annotations

from typing import Any

import numpy as np

from flexor.optimizers.interface import FloatArray
from flexor.optimizers.method import Run
from flexor.optimizers.options import require


def check_population(method: str, population: int, patience: int, least: int) -> None:
    """Check the population size and the patience.

    Raises
    ------
    InputError
        If one is too small.
    """
    require(method, "population", population, population >= least, f"at least {least}")
    require(method, "patience", patience, patience >= 1, "at least 1")


def first_population(run: Run, count: int) -> FloatArray:
    """Return the starts, completed by a Latin hypercube sample, (count or more, k)."""
    return run.starts(count, np.random.default_rng(run.seed))


def generations(run: Run, algorithm: Any, patience: int) -> str:
    """Run a pymoo algorithm with each generation as one batch.

    Parameters
    ----------
    run : Run
        The run.
    algorithm : pymoo Algorithm
        The algorithm, constructed with its sampling.
    patience : int
        Number of generations without improvement after which to stop.

    Returns
    -------
    str
        Reason for stopping.
    """
    from pymoo.core.evaluator import Evaluator
    from pymoo.core.problem import Problem
    from pymoo.core.termination import NoTermination
    from pymoo.problems.static import StaticProblem

    k = run.size
    problem = Problem(n_var=k, n_obj=1, xl=np.zeros(k), xu=np.ones(k))
    algorithm.setup(problem, termination=NoTermination(), seed=run.seed, verbose=False)
    best, stalled = np.inf, 0
    while stalled < patience:
        infills = algorithm.ask()
        if infills is None or len(infills) == 0:
            return "the population has lost its diversity"
        points = infills.get("X").astype(np.float64)
        evaluated = StaticProblem(problem, F=run.values(points)[:, None])
        Evaluator().eval(evaluated, infills)
        algorithm.tell(infills=infills)
        stalled = 0 if run.function.value < best else stalled + 1
        best = run.function.value
        spread = np.ptp(algorithm.pop.get("X").astype(np.float64), axis=0).max()
        run.step(f"spread {spread:.2g}")
    return f"no improvement in {patience} generations"
