"""The default design (Table I), from which gains are measured."""

from __future__ import annotations

from flexor.paper.context import Context
from flexor.paper.folder import Data
from flexor.paper.optimum import evaluated
from flexor.study.comparison.result import WITHIN


def default_design(context: Context) -> Data:
    """Return what the default design does; see `flexor.paper.optimum.evaluated`."""

    def compute() -> Data:
        problem = context.problem("L")
        return evaluated(problem, problem.parameters.start)

    return context.part("default", compute).data


def target(context: Context, best: float) -> float:
    """Return the f_b that counts as having found a minimum.

    Parameters
    ----------
    context : Context
        Models, settings and folder.
    best : float
        The minimum.

    Returns
    -------
    float
        That with 99 % of the minimum's gain over the default design, as in `flexor.compare`.
    """
    default = float(default_design(context)["value"])
    return default - (1.0 - WITHIN) * (default - best)
