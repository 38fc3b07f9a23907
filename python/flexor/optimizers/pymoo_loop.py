"""One loop for the population methods of pymoo."""

from __future__ import annotations

from typing import Any

import numpy as np

from flexor.optimizers.interface import FloatArray
from flexor.optimizers.method import Run
from flexor.optimizers.options import require


def check_population(method: str, population: int, patience: int, least: int) -> None:
    """Refuse a population that the operators cannot work with, or no patience.

    Raises
    ------
    InputError
        If one is too small.
    """
    require(method, "population", population, population >= least, f"at least {least}")
    require(method, "patience", patience, patience >= 1, "at least 1")


def first_population(run: Run, count: int) -> FloatArray:
    """Return the starts and a Latin hypercube, (count or more, k) in the unit box."""
    return run.starts(count, np.random.default_rng(run.seed))


def generations(run: Run, algorithm: Any, patience: int) -> str:
    """Run a pymoo algorithm, each generation one batch.

    Parameters
    ----------
    run : Run
        What is searched.
    algorithm : pymoo Algorithm
        As constructed, with its sampling.
    patience : int
        Generations without a better design after which it ends.

    Returns
    -------
    str
        Why it ended.
    """
    from pymoo.core.evaluator import Evaluator
    from pymoo.core.problem import Problem
    from pymoo.core.termination import NoTermination
    from pymoo.problems.static import StaticProblem

    k = run.size
    problem = Problem(n_var=k, n_obj=1, xl=np.zeros(k), xu=np.ones(k))
    algorithm.setup(problem, termination=NoTermination(), seed=run.seed, verbose=False)
    best, since = np.inf, 0
    while since < patience:
        asked = algorithm.ask()
        if asked is None or len(asked) == 0:
            return "the population is all alike"
        points = asked.get("X").astype(np.float64)
        known = StaticProblem(problem, F=run.values(points)[:, None])
        Evaluator().eval(known, asked)
        algorithm.tell(infills=asked)
        since = 0 if run.function.value < best else since + 1
        best = run.function.value
        spread = np.ptp(algorithm.pop.get("X").astype(np.float64), axis=0).max()
        run.step(f"spread {spread:.2g}")
    return f"nothing better in {patience} generations"
