"""The true optimum of a parameter set, as far as a thorough search can tell."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from flexor.design.legendre import CENTIMETRE
from flexor.paper import published
from flexor.paper.context import Array, Context
from flexor.paper.folder import Data
from flexor.paper.thorough import Thorough
from flexor.study import Problem, Study, StudyProgress, optimize

# Evaluations do not grow with the number of parameters without end.
MOST_COUNTED = 3
# The other objectives count contacts or look at one sphere: they jump where f_b slides.
OTHERS_HARDER = 2


@dataclass(frozen=True, eq=False)
class Optimum:
    """The best design of a set and what it does.

    Attributes
    ----------
    parameters, objective : str
        Of what it is the optimum.
    design : (k,) array
        SI.
    value : float
        Of the objective.
    bending : float
        Sum of the joint angles at the last load [rad].
    joint_angles : (j,) array
        At the last load [rad].
    tip_force : float
        At the last load [N].
    touching : int
        Spheres of the exosuit that touch, at the last load.
    events : int
        Snaps on the way.
    evaluations : int
        Designs evaluated to find it.
    seconds : float
        How long that took [s].
    """

    parameters: str
    objective: str
    design: Array
    value: float
    bending: float
    joint_angles: Array
    tip_force: float
    touching: int
    events: int
    evaluations: int
    seconds: float


def evaluated(problem: Problem, design: Array) -> Data:
    """Return what a design (k,) does, as plain values; see `Optimum`."""
    outcomes = problem.evaluate(np.asarray(design, dtype=np.float64)[None, :])
    return {
        "design": [float(value) for value in design],
        "value": float(outcomes.value[0]),
        "bending": float(outcomes.joint_angles[0, -1].sum()),
        "joint_angles": outcomes.joint_angles[0, -1].tolist(),
        "tip_force": float(outcomes.tip_force[0, -1]),
        "touching": int(outcomes.touching[0, -1]),
        "events": int(outcomes.event_count[0]),
    }


def optimum_of(problem: Problem, data: Data, seconds: float) -> Optimum:
    """Make an `Optimum` of plain values that also have its ``evaluations``."""
    values: dict[str, Any] = dict(data)
    values["design"] = np.array(values["design"])
    values["joint_angles"] = np.array(values["joint_angles"])
    return Optimum(
        parameters=problem.parameters.name,
        objective=problem.objective.name,
        seconds=seconds,
        **values,
    )


def described(study: Study) -> Data:
    """Return a study's best design and its evaluations as plain values."""
    return {
        **evaluated(study.problem, study.best.vector),
        "evaluations": study.evaluations,
    }


def true_optimum(context: Context, parameters: str, objective: str = "bending") -> Optimum:
    """Search a set thoroughly.

    The search begins from the model's own exosuit, from the published optimum, and from the optima
    of the set's parts and of what they hold: so a larger set is never worse than a smaller one
    within it.

    Parameters
    ----------
    context : Context
        Models, settings and folder.
    parameters, objective : str
        Of what the optimum is wanted.

    Returns
    -------
    Optimum
        The best design found.
    """
    problem = context.problem(parameters, objective)
    starts = _starts(context, problem)
    most = context.settings.thorough * min(problem.parameters.size, MOST_COUNTED)
    if objective != "bending":
        most *= OTHERS_HARDER

    def tell(at: StudyProgress) -> None:
        share = min(at.evaluations / most, 1.0)
        context.say(f"optimum of {parameters} for {objective}", share)

    def compute() -> Data:
        study = optimize(
            problem.model,
            problem.parameters,
            objective,
            Thorough(most),
            start=starts,
            seed=context.settings.seed,
            progress=tell,
            executor=context.executor,
        )
        return described(study)

    part = context.part(f"optimum-{parameters}-{objective}", compute)
    return optimum_of(problem, part.data, part.seconds)


def _starts(context: Context, problem: Problem) -> Array:
    parameters, objective = problem.parameters.name, problem.objective.name
    chosen = problem.parameters
    starts = [chosen.start]
    if objective == "bending":
        starts.append(np.array(published.TABLE_III[parameters].design))
    elif parameters == "L+R01":
        starts += [np.array(optimum.design) for optimum in published.TABLE_IV.values()]
        starts.append(true_optimum(context, parameters).design)
    if objective == "bending":
        starts += _from_parts(context, parameters, chosen.start)
    inside = np.clip(np.array(starts), chosen.lower, chosen.upper)
    return np.unique(inside, axis=0)


def _from_parts(context: Context, parameters: str, start: Array) -> list[Array]:
    """Optima of smaller sets, as designs of this one."""
    length, plus, shape = parameters.partition("+")
    if plus:
        best_length = true_optimum(context, length).design
        best_shape = true_optimum(context, shape).design
        starts = [
            np.concatenate((best_length, start[1:])),
            np.concatenate((start[:1], best_shape)),
            np.concatenate((best_length, best_shape)),
        ]
        if shape == "RLP":
            linear = true_optimum(context, "L+R01").design
            starts.append(np.concatenate((linear[:1], as_legendre(linear[1:], start.size - 1))))
        return starts
    if parameters == "RLP":
        return [as_legendre(true_optimum(context, "R01").design, start.size)]
    return []


def as_legendre(radii: Array, count: int) -> Array:
    """Return the coefficients (12) of the straight surface between two radii.

    Parameters
    ----------
    radii : (2,) array
        At base and tip [m].
    count : int
        How many coefficients.

    Returns
    -------
    (count,) array
        They may lie outside the bounds of the set.
    """
    coefficients = np.zeros(count)
    coefficients[0] = radii[0] / (2.0 * CENTIMETRE)
    coefficients[1] = 1.5 * (radii[1] - radii[0]) / CENTIMETRE
    return coefficients
