"""The paper's own way to an optimum: one pattern search from the default design."""

from __future__ import annotations

from flexor.paper.context import Context
from flexor.paper.folder import Data
from flexor.paper.optimum import Optimum, described, optimum_of
from flexor.study import StudyProgress, optimize


def paper_search(context: Context, parameters: str, objective: str = "bending") -> Optimum:
    """Search a set as the paper did, from the model's own exosuit.

    Parameters
    ----------
    context : Context
        Models, settings and folder.
    parameters, objective : str
        What is searched.

    Returns
    -------
    Optimum
        Where the search ended.
    """
    problem = context.problem(parameters, objective)

    def tell(at: StudyProgress) -> None:
        context.say(f"pattern search of {parameters} for {objective}, {at.evaluations:,} designs")

    def compute() -> Data:
        study = optimize(
            problem.model,
            problem.parameters,
            objective,
            "pattern-search",
            seed=context.settings.seed,
            budget=context.settings.search,
            progress=tell,
            executor=context.executor,
        )
        return described(study)

    part = context.part(f"search-{parameters}-{objective}", compute)
    return optimum_of(problem, part.data, part.seconds)
