"""Exact derivatives of numbers that are computed from paths."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from flexor._engine import REGULARITY
from flexor.arrays import Array
from flexor.errors import InputError

if TYPE_CHECKING:
    from flexor.model.results import Paths
    from flexor.model.structure import Structure

# Relative difference below which two numbers are tied.
TIED = 1e-9
# From what says least about a derivative to what says most.
_ORDER = (
    "no-equilibrium",
    "nearly-singular",
    "contact-threshold",
    "snapped",
    "tied",
    "regular",
)
_RANK = np.array([_ORDER.index(name) for name in REGULARITY])
_SNAPPED, _TIED, _REGULAR = map(_ORDER.index, ("snapped", "tied", "regular"))


@dataclass(frozen=True, eq=False)
class Differential:
    """The change of a number of each of n designs, to first order.

    It is the sum of ``parts``, of changes of what the engine differentiates, and of ``explicit``,
    of changes of parameters with all of that held.

    Attributes
    ----------
    parts : tuple of pairs of arrays
        Steps (n,), and the weights (n, outputs) of `Model.engine.outputs` there.
    explicit : (n, P) array or None
        By the engine's parameters.
    tied : (n,) bool array or None
        Whether it is that of the largest of several numbers, and another one equals it.
    """

    parts: tuple[tuple[NDArray[np.intp], Array], ...] = ()
    explicit: Array | None = None
    tied: NDArray[np.bool_] | None = None

    def __mul__(self, factor: Array | float) -> Differential:
        """Multiply by a number, or by one for each design, (n,)."""
        column = np.asarray(factor, dtype=float)
        column = column[:, None] if column.ndim else column
        return Differential(
            tuple((steps, weights * column) for steps, weights in self.parts),
            None if self.explicit is None else self.explicit * column,
            self.tied,
        )

    def __add__(self, other: Differential) -> Differential:
        explicit = [each.explicit for each in (self, other) if each.explicit is not None]
        tied = [each.tied for each in (self, other) if each.tied is not None]
        return Differential(
            self.parts + other.parts,
            sum(explicit[1:], start=explicit[0]) if explicit else None,
            np.logical_or.reduce(tied) if tied else None,
        )


def weights(model: Structure, count: int, by_name: Mapping[str, Array | float]) -> Array:
    """Return weights (n, outputs) of the engine's outputs, those of a group by its name."""
    outputs = model.engine.outputs
    made = np.zeros((count, max(stop for _, stop in outputs.values())))
    for name, given in by_name.items():
        start, stop = outputs[name]
        made[:, start:stop] = given
    return made


def last_step(paths: Paths) -> list[Differential]:
    """Return the changes of the joints' coordinates and, last, of the tip force, at the end."""
    n, steps, joints = paths.joint_angles.shape
    at = np.full(n, steps - 1)
    rows = [{"joints": np.eye(joints)[joint], "tip_force": 0.0} for joint in range(joints)] + [
        {"joints": 0.0, "tip_force": 1.0}
    ]
    return [Differential(((at, weights(paths.model, n, row)),)) for row in rows]


@dataclass(frozen=True, eq=False)
class Derivatives:
    """Total derivatives of r numbers of each of n designs, NaN where there are none.

    Attributes
    ----------
    by_slots : (n, r, m) array
        By m of the engine's parameters.
    by_loads : (n, r, steps, inputs) array
        By the loads of each step; of a controlled input, by its length or volume.
    regularity : (n, r) array of str
        Whether they hold; see `flexor.model.Paths`. ``"tied"``: it is that of the largest of
        several numbers, and another one equals it.
    """

    by_slots: Array
    by_loads: Array
    regularity: NDArray[np.object_]


def differentiate(
    paths: Paths, rows: Sequence[Differential], slots: NDArray[np.intp], threads: int = 0
) -> Derivatives:
    """Differentiate numbers of n designs, each equilibrium along its own branch.

    Parameters
    ----------
    paths
        Paths of the designs, which are followed to the last step that matters.
    rows
        The changes of r numbers with what the engine differentiates.
    slots : (m,) array
        The engine's parameters with respect to which they are differentiated.
    threads
        How many; 0 for one per core. Results do not depend on it.

    Returns
    -------
    Derivatives
        For every number, at the cost of one factorisation for each equilibrium that has a part in
        any, and of one solution for each part. With friction the paths are followed once more and
        differentiated back to their first step.
    """
    model, (n, steps) = paths.model, paths.converged.shape
    found = paths.converged & paths.stable
    by_slots = np.zeros((n, len(rows), len(slots)))
    by_loads = np.zeros((n, len(rows), steps, len(model.inputs)))
    rank = np.full((n, len(rows)), _REGULAR)
    places, owners, given = [], [], []
    for r, row in enumerate(rows):
        if row.explicit is not None:
            by_slots[:, r] = row.explicit[:, slots]
        if row.tied is not None:
            rank[row.tied, r] = _TIED
        for at, each in row.parts:
            used = np.flatnonzero(each.any(axis=1))
            good = found[used, at[used]]
            rank[used[~good], r] = 0
            used = used[good]
            places.append(used * steps + at[used])
            owners.append(np.full(len(used), r))
            given.append(each[used])
    if sum(map(len, places)):
        place, owner, weighed = (np.concatenate(each) for each in (places, owners, given))
        order = np.argsort(place, kind="stable")
        place, owner, weighed = place[order], owner[order], weighed[order]
        of, at = place // steps, place % steps
        jumped = _first_events(paths, steps)[of] <= at
        np.minimum.at(rank, (of[jumped], owner[jumped]), _SNAPPED)
    if model.frictions and sum(map(len, places)):
        parts = np.column_stack([of, owner, at])
        history = _differentiate_histories(paths, parts, weighed, len(rows), slots, threads)
        has = np.zeros(rank.shape, dtype=bool)
        has[of, owner] = True
        by_slots[has] += history.by_slots[has]
        by_loads[has] += history.by_loads[has]
        rank[has] = np.minimum(rank, _RANK[history.regularity])[has]
    elif sum(map(len, places)):
        visited, sums = np.unique(place, return_inverse=True)
        design, step = visited // steps, visited % steps
        parameters = paths.parameters
        varied = np.flatnonzero((parameters != model.parameters).any(axis=0))
        slopes = model.followed.differentiate(
            varied,
            parameters[:, varied],
            design,
            paths.q[design, step],
            paths.applied[design, step],
            sums,
            weighed,
            slots,
            threads,
        )
        unsorted, first = np.argsort(order), 0
        for each in filter(len, owners):
            own = unsorted[first : first + len(each)]
            first += len(each)
            # A design occurs once in each part, and in most parts all do.
            chosen = slice(None) if len(each) == n else of[own]
            by_slots[chosen, each[0]] += slopes["by_parameters"][own]
            by_loads[of[own], each[0], at[own]] += slopes["by_loads"][own]
        np.minimum.at(rank, (of, owner), _RANK[slopes["regularity"]])
    by_slots[rank == 0], by_loads[rank == 0] = np.nan, np.nan
    return Derivatives(by_slots, by_loads, np.array(_ORDER, dtype=object)[rank])


class _Histories(NamedTuple):
    """Derivatives of r numbers of n designs through all steps of their paths."""

    by_slots: Array  # (n, r, m)
    by_loads: Array  # (n, r, steps, inputs)
    regularity: NDArray[np.uint8]  # (n, r), the engine's codes


def _differentiate_histories(
    paths: Paths,
    parts: NDArray[np.intp],
    weighed: Array,
    numbers: int,
    slots: NDArray[np.intp],
    threads: int,
) -> _Histories:
    """Differentiate along paths with friction, which are followed once more.

    Parts (m, 3) are the design, the number and the step of weights (m, outputs).
    """
    model, followed = paths.model, paths.followed
    if followed is None or followed.steps != paths.converged.shape[1]:
        raise InputError(
            f'"{model.frictions[0]}" has friction, whose derivatives need a path from its first '
            "step on: a part of one is given."
        )
    listed = paths.loads if paths.own_loads is None else paths.own_loads
    loads = followed.loads(listed)
    lead = loads.shape[-2] - listed.shape[-2]
    parameters = paths.parameters
    varied = np.flatnonzero((parameters != model.parameters).any(axis=0))
    slopes = model.engine.differentiate_paths(
        varied,
        parameters[:, varied],
        loads.reshape(-1, loads.shape[-1]),
        parts + np.array([0, 0, lead]),
        weighed,
        numbers,
        slots,
        threads,
        steps=loads.shape[-2],
        **followed.settings,
    )
    by_loads = slopes["by_loads"][:, :, lead:]
    return _Histories(slopes["by_parameters"], by_loads, slopes["regularity"])


def _first_events(paths: Paths, steps: int) -> NDArray[np.intp]:
    """Return the step on the way to which each path first left its branch, (n,)."""
    first = [min(table["step"], default=steps) for table in paths.event_table]
    return np.array(first, dtype=np.intp)
