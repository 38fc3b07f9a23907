"""The constraints of a design problem: those asked for, and defaults not switched off."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

import numpy as np

from flexor.arrays import Array
from flexor.constraints.constraint import Constraint, constraint
from flexor.constraints.defaults import default_constraints
from flexor.errors import InputError, unknown_name
from flexor.model.results import Paths
from flexor.model.structure import Structure
from flexor.model.validation import describe

ALL = "defaults"


def chosen_constraints(
    subject_to: Iterable[str], without: Sequence[str], model: Structure, defaults: bool = True
) -> tuple[Constraint, ...]:
    """Return the constraints of a problem.

    Parameters
    ----------
    subject_to
        Texts such as ``"overlap <= 0.5 mm"``; one about the observable of a default in the same
        sense replaces it. With an overlap of at most half of the radius of a rod its centreline
        is in no body, and that default is left out.
    without
        Names of defaults that do not hold; ``"defaults"`` for all.
    model
        The model.
    defaults
        Whether there are defaults.

    Raises
    ------
    InputError
        If a constraint cannot be read or there is no default of a name.
    """
    subject_to, without = _texts("subject_to", subject_to), _texts("without", without)
    asked = tuple(constraint(text, model) for text in subject_to)
    every = default_constraints(model) if defaults or without else ()
    names = [each.default for each in every]
    for name in without:
        if name not in (*names, ALL):
            what = unknown_name("default constraint", name, (*names, ALL))
            raise InputError(f"{what}.")
    replaced = {(each.name, each.sense) for each in asked}
    kept = [
        each
        for each in every
        if defaults
        and ALL not in without
        and each.default not in without
        and (each.name, each.sense) not in replaced
    ]
    return tuple(each for each in (*kept, *asked) if not _is_implied(each, (*kept, *asked), model))


def _is_implied(each: Constraint, others: Iterable[Constraint], model: Structure) -> bool:
    """Return whether a default follows from a constraint on the overlap, by a factor of two."""
    if each.default != "centreline":
        return False
    half = 0.5 * model.least_touching_radius
    overlaps = [each for each in others if each.name == "overlap" and each.sense == "<="]
    return any(each.bound <= half and not each.at_end for each in overlaps)


def _texts(what: str, given: object) -> tuple[str, ...]:
    """Return the texts in a sequence; one text is one."""
    found = [given] if isinstance(given, str) else given
    if not isinstance(found, Iterable) or isinstance(found, Mapping):
        raise InputError(f"{what} is {describe(given)}: it must be a sequence of texts.")
    for each in (texts := tuple(found)):
        if not isinstance(each, str):
            raise InputError(f"{what} has {describe(each)}: each must be a text.")
    return texts


def joined_constraints(
    stated: Iterable[str], asked: Sequence[str], model: Structure
) -> tuple[str, ...]:
    """Return constraints that are asked for in addition to others.

    Parameters
    ----------
    stated, asked
        Texts such as ``"overlap <= 0.5 mm"``; one that is asked for replaces those stated about
        the same observable, in the same sense and at the same loads.
    model
        The model.

    Raises
    ------
    InputError
        If a constraint cannot be read.
    """
    replaced = [_about(text, model) for text in asked]
    return (*(text for text in stated if _about(text, model) not in replaced), *asked)


def _about(text: str, model: Structure) -> tuple[object, ...]:
    read = constraint(text, model)
    return read.name, read.sense, read.at_end


def worst_values(constraints: Sequence[Constraint], paths: Paths) -> Array:
    """Return the worst value of each of c constraints along n paths, SI, (n, c)."""
    if not constraints:
        return np.zeros((len(paths), 0))
    return np.stack([each.worst(paths) for each in constraints], axis=1)


def excesses(constraints: Sequence[Constraint], worst: Array) -> Array:
    """Return how far each is exceeded, (n, c); kept where not above 0."""
    if not constraints:
        return np.zeros((len(worst), 0))
    columns = [each.excess(worst[:, i]) for i, each in enumerate(constraints)]
    return np.stack(columns, axis=1)


# Above every value of an objective, so that feasible designs come first, and below that of designs
# that failed: the least rank of an infeasible design.
INFEASIBLE = 1e9


def ranks(value: Array, broken: Array) -> Array:
    """Return numbers (n,) in the order of designs: feasibility first, then the objective.

    Parameters
    ----------
    value, broken : (n,) arrays
        Values of the objective, and violations.

    Returns
    -------
    (n,) array
        Values of feasible designs; larger than any of these and growing with the violation for
        others, after Deb (2000); +inf where a design failed.
    """
    infeasible = np.isfinite(value) & (broken > 0.0)
    return np.where(infeasible, INFEASIBLE * (1.0 + broken), value)


def feasible_parts(ranked: Array) -> tuple[Array, Array]:
    """Return values (n,), NaN of infeasible designs, and their violations from their `ranks`."""
    infeasible = np.isfinite(ranked) & (ranked >= INFEASIBLE)
    violations = np.where(infeasible, ranked / INFEASIBLE - 1.0, 0.0)
    return np.where(infeasible, np.nan, ranked), violations


def violation(excess: Array) -> Array:
    """Return the sum of what n designs exceed their constraints by, (n,); 0 if feasible."""
    total = np.zeros(len(excess))
    for column in range(excess.shape[1]):
        total += np.maximum(excess[:, column], 0.0)
    return total
