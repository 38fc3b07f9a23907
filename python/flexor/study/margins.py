"""Errors within tolerances for which a design breaks its constraints.

Constraints that hold for every error within the tolerances are a problem with infinitely many
constraints. It is solved by a cutting-set method (Mutapcic and Boyd 2009): a search keeps the
constraints for a few errors, the worst errors of its optimum join them, and the search goes on from
there until none breaks a constraint.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from weakref import WeakKeyDictionary

import numpy as np

from flexor.constraints import excesses
from flexor.scenarios.tolerance import within
from flexor.study.problem import FloatArray
from flexor.study.scenario_problem import ScenarioProblem

# Rounds of searches after the first.
ROUNDS = 8
# Corners of the box of errors, in all scenarios, up to which every one is checked.
CORNERS = 256
# Errors within the tolerances at which a design is checked, besides those that slopes point to.
CHECKED = 128
# Scenarios up to which the corners of each of them are tried in all.
FEW = 4
# A constraint that an error exceeds, or nearly so (in units of the bound), holds for it in the next
# round.
NEAR = 0.05


@dataclass(frozen=True, eq=False)
class WorstErrors:
    """The worst errors of a design for each of c constraints; made by `worst_errors`."""

    errors: FloatArray  # (c, m), SI
    values: FloatArray  # (c,), what is constrained there, SI; NaN where the design then fails
    excess: FloatArray  # (c,), in units of the bounds; +inf where the design then fails
    scenario: tuple[int, ...]  # (c + 1,), in which scenarios; the last of the objective
    # The objective's quantity, for display, and the errors that change it most for the worse.
    shown: float
    error: FloatArray  # (m,)

    @property
    def kept(self) -> bool:
        """Whether every constraint holds for every error that was tried."""
        return not (self.excess > 0.0).any()


# By problem: the design that was checked last, which the verdict asks for again.
_LAST: WeakKeyDictionary[ScenarioProblem, tuple[bytes, WorstErrors]] = WeakKeyDictionary()


def worst_errors(problem: ScenarioProblem, design: FloatArray, threads: int = 0) -> WorstErrors:
    """Find the errors within the tolerances that matter most for a design (k,).

    Errors all over the box are evaluated, and its corners: all where these are few, else the one
    to which the slopes over the whole tolerance of each field point for each constraint, scenario
    and the objective.
    """
    key, (last, known_errors) = design.tobytes(), _LAST.get(problem, (b"", None))
    if known_errors is not None and last == key:
        return known_errors
    found = _found(problem, design, threads)
    _LAST[problem] = key, found
    return found


def _found(problem: ScenarioProblem, design: FloatArray, threads: int) -> WorstErrors:
    reach = np.array([each.reach for each in problem.tolerances])
    axes = np.concatenate([np.diag(reach), -np.diag(reach)])
    m, count = len(reach), len(problem.scenarios)
    spread = within(problem.tolerances, max(CHECKED // count, 8), problem.seed + 1)
    known = problem.corners.reshape(len(problem.corners), m)
    if 2**m * count <= CORNERS:
        corners = np.array(list(itertools.product((-1.0, 1.0), repeat=m))) * reach
    else:
        corners = _steepest_corners(problem, design, reach, axes, threads)
    tried = np.concatenate([known, axes, corners, spread])
    return _worst(problem, tried, _evaluated(problem, design, tried, threads))


def _steepest_corners(
    problem: ScenarioProblem,
    design: FloatArray,
    reach: FloatArray,
    axes: FloatArray,
    threads: int,
) -> FloatArray:
    """Return the corners to which slopes point, (e, m)."""
    m = len(reach)
    slopes = _evaluated(problem, design, np.concatenate([axes, np.zeros((1, m))]), threads)
    with np.errstate(invalid="ignore"):
        rise = slopes[:, :m] - slopes[:, m : 2 * m]  # (S, m, c + 1)
    rise = np.where(np.isfinite(rise), rise, 0.0)
    signs = np.moveaxis(np.sign(rise), 1, 2)  # (S, c + 1, m)
    if len(problem.scenarios) > FEW:
        # Only of the scenario where each is expected to be worst.
        expected = slopes[:, -1] + 0.5 * np.abs(rise).sum(axis=1)
        signs = signs[np.argmax(expected, axis=0), np.arange(signs.shape[1])]
    corners: FloatArray = np.unique(signs.reshape(-1, m) * reach, axis=0)
    return corners


def _evaluated(
    problem: ScenarioProblem, design: FloatArray, errors: FloatArray, threads: int
) -> FloatArray:
    """Return excesses and the value to minimise, in every scenario, (S, e, c + 1)."""
    rows = []
    for paths in problem.by_case(design[None, :], errors, threads):
        over = excesses(problem.constraints, paths.constraint_values)
        failed = ~np.isfinite(paths.value)
        over[failed] = np.inf
        rows.append(np.concatenate([over, paths.value[:, None]], axis=1))
    return np.stack(rows)


def _worst(problem: ScenarioProblem, errors: FloatArray, found: FloatArray) -> WorstErrors:
    c = len(problem.constraints)
    flat = found.reshape(-1, c + 1)
    places = np.argmax(flat, axis=0)  # (c + 1,)
    scenarios, rows = np.divmod(places, len(errors))
    excess = flat[places, np.arange(c + 1)]
    signs = np.array([1.0 if each.sense == "<=" else -1.0 for each in problem.constraints])
    bounds = np.array([each.bound for each in problem.constraints])
    scales = np.array([each.scale for each in problem.constraints])
    with np.errstate(invalid="ignore"):
        values = bounds + signs * scales * excess[:c]
    sign, factor = problem.objective.sign, problem.factor  # type: ignore[attr-defined]
    return WorstErrors(
        errors=errors[rows[:c]],
        values=np.where(np.isfinite(excess[:c]), values, np.nan),
        excess=excess[:c],
        scenario=tuple(map(int, scenarios)),
        shown=float(sign * excess[c] / factor) if np.isfinite(excess[c]) else np.nan,
        error=errors[rows[c]],
    )


def next_corners(problem: ScenarioProblem, found: WorstErrors) -> FloatArray | None:
    """Return the errors of the next round, (e, m); None if the design keeps all constraints."""
    if found.kept:
        return None
    joining = found.errors[found.excess > -NEAR]
    known = problem.corners.reshape(len(problem.corners), joining.shape[1])
    merged = np.concatenate([known, joining])
    _, first = np.unique(merged, axis=0, return_index=True)
    return merged[np.sort(first)]
