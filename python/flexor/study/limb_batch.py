"""Scenarios that differ in the sizes of the limb only, evaluated as one batch of one model."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from flexor.design import ParameterSet, Variables
from flexor.model.geometry import SlotValues
from flexor.model.results import Paths
from flexor.model.schema import Rod
from flexor.scenarios import Scenario
from flexor.study.problem import FloatArray, Problem

if TYPE_CHECKING:
    from flexor.model import Model
    from flexor.model.structure import Structure

# Arrays of derivatives, whose last axis is that of the parameters.
_SLOPES = ("derivatives", "value_gradient", "constraint_gradients")


@dataclass(frozen=True, eq=False)
class _Cases(ParameterSet):
    """Designs of several models as one of these has them; the last parameter says which one."""

    varied: Variables = field(kw_only=True)
    models: tuple[Model, ...] = field(kw_only=True)
    indices: NDArray[np.intp] = field(kw_only=True)  # (m,), parameters that are not all the same
    own: FloatArray = field(kw_only=True)  # (S, m), those of the models themselves
    place: NDArray[np.intp] = field(kw_only=True)  # which of these are varied

    def _check_units(self) -> None:
        """Those of the variables."""

    def designs(self, p: FloatArray, model: Structure) -> tuple[SlotValues, NDArray[np.bool_]]:
        """Return the engine's parameters of designs; see `ParameterSet.designs`."""
        case = p[:, -1].astype(np.intp)
        values = self.own[case]
        for index in np.unique(case).tolist():
            rows = np.flatnonzero(case == index)
            found, _ = self.varied.designs(p[rows, :-1], self.models[index])
            values[np.ix_(rows, self.place)] = found.values
        return SlotValues(self.indices, values), np.ones(len(p), dtype=bool)

    def slots(self, model: Structure) -> NDArray[np.intp]:
        """Return which of the engine's parameters the designs change."""
        return self.indices[self.place]

    def slot_jacobian(self, p: FloatArray, model: Structure) -> FloatArray:
        """Differentiate these of n designs by the parameters, (n, m, k)."""
        case, found = p[:, -1].astype(np.intp), np.zeros((len(p), len(self.place), p.shape[1]))
        for index in np.unique(case).tolist():
            rows = np.flatnonzero(case == index)
            found[rows, :, :-1] = self.varied.slot_jacobian(p[rows, :-1], self.models[index])
        return found


@dataclass(frozen=True, eq=False)
class LimbBatch:
    """Cases as one problem of one model; made by `limb_batch`."""

    problem: Problem  # of the first model; the last parameter is which case

    def evaluate(
        self, placed: Sequence[FloatArray], threads: int = 0, gradient: bool = False
    ) -> list[Paths]:
        """Evaluate designs (n, k) of each case, with the results that the case itself has."""
        rows = [
            np.concatenate([each, np.full((len(each), 1), float(case))], axis=1)
            for case, each in enumerate(placed)
        ]
        found = self.problem.evaluate(np.concatenate(rows), threads, gradient)
        slopes = {name: getattr(found, name) for name in _SLOPES}
        kept = {name: each[..., :-1] for name, each in slopes.items() if each is not None}
        found = replace(found, **kept)
        ends = np.cumsum([0, *map(len, placed)]).tolist()
        return [found[first:last] for first, last in pairwise(ends)]


def limb_batch(cases: Sequence[Problem], scenarios: Sequence[Scenario]) -> LimbBatch | None:
    """Return cases as one problem.

    None where their models differ in more than what the engine has as parameters, or one has
    loads of its own: these are evaluated one by one.
    """
    first, varied = cases[0], cases[0].parameters
    if len(cases) < 2 or not isinstance(varied, Variables) or varied.varied_inputs:
        return None
    if not all(_of_the_limb(each, first.model) for each in scenarios):
        return None
    models, slots = tuple(each.model for each in cases), varied.slots(first.model)
    for case in cases[1:]:
        alike = case.model.engine.has_structure_of(first.model.engine)
        if not alike or case.parameters is not varied:
            return None
        if not np.array_equal(case.loads, first.loads):
            return None
        if not np.array_equal(varied.slots(case.model), slots):
            return None
    every = np.stack([each.parameters for each in models])
    apart = (every != every[0]).any(axis=0)
    apart[slots] = True
    indices = np.flatnonzero(apart)
    count = len(cases)
    made = _Cases(
        name=varied.name,
        labels=(*varied.labels, "case"),
        units=(*varied.units, "1"),
        lower=np.append(varied.lower, 0.0),
        upper=np.append(varied.upper, float(count)),
        start=np.append(varied.start, 0.0),
        varied=varied,
        models=models,
        indices=indices,
        own=every[:, indices],
        place=np.searchsorted(indices, slots),
    )
    return LimbBatch(replace(first, parameters=made))


def _of_the_limb(scenario: Scenario, model: Model) -> bool:
    """Whether a scenario changes only links and where rods begin.

    Results read these from the engine; of others, such as limits of materials, the file counts.
    """
    bodies = model.file.bodies
    for keys in scenario.keys:
        if len(keys) < 3 or keys[0] != "bodies" or keys[1] not in bodies:
            return False
        if isinstance(bodies[keys[1]], Rod) and keys[2] != "placement":
            return False
    return True
