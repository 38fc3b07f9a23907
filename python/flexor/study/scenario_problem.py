"""A design problem over scenarios, whose value is an aggregate of what a design does in each."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field, fields, replace
from functools import cached_property, partial
from typing import TYPE_CHECKING, Any

import numpy as np

from flexor.constraints import excesses
from flexor.design import ParameterSet, Variables
from flexor.design.fields import keys_of, value_of
from flexor.design.strap_places import with_moving_straps
from flexor.errors import InputError
from flexor.model.interruption import cancel_solves
from flexor.model.loading import changed_model
from flexor.model.quantity import infer_quantity
from flexor.model.results import Path, Paths
from flexor.objectives import Extremum
from flexor.objectives import objective as named_objective
from flexor.observables import observable
from flexor.scenarios import (
    Aggregate,
    Scenario,
    Tolerance,
    aggregate,
    scenarios,
    tolerances,
    wearers,
)
from flexor.scenarios.scenario import Given
from flexor.scenarios.tolerance import samples
from flexor.study.limb_batch import LimbBatch, limb_batch
from flexor.study.problem import FloatArray, Problem

if TYPE_CHECKING:
    from flexor.model import Model

AS_IT_IS = Scenario("as it is")
# Arrays of derivatives, which are those of the aggregate.
_SLOPES = ("derivatives", "regularity", "value_gradient", "constraint_gradients")


@dataclass(frozen=True)
class Uncertainty:
    """What a design has to be good for, as users state it; see `flexor.optimize`."""

    scenarios: Given = ()
    aggregate: str = "mean"
    tolerance: Mapping[str, object] = field(default_factory=dict)
    samples: int = 0
    wearers: int = 0  # of the population that the model's file states, besides the scenarios

    def __bool__(self) -> bool:
        several = bool(self.scenarios) or bool(self.tolerance) or bool(self.wearers)
        return several or bool(self.samples) or self.aggregate != "mean"


@dataclass(frozen=True, eq=False)
class ScenarioProblem(Problem):
    """A design problem over scenarios and errors within tolerances.

    Every scenario with every error is a case. The recorded arrays of a path, such as its joint
    angles, are those of the model as it is; its value is the aggregate over the cases, and its
    constraints are those of all cases.

    Attributes
    ----------
    scenarios : tuple of Scenario
        At least one; the model as it is unless variants are named.
    aggregate : Aggregate
        Of their values.
    tolerances : tuple of m Tolerance
        Errors of design parameters and other fields.
    samples : int
        Number of errors over which the objective is aggregated; with none, that without an error.
    seed : int
        Of these, the same for all designs and scenarios.
    corners : (e, m) array
        Errors for which constraints have to hold besides; see `flexor.study.margins`.
    """

    scenarios: tuple[Scenario, ...] = (AS_IT_IS,)
    aggregate: Aggregate = field(default_factory=lambda: aggregate("mean"))
    tolerances: tuple[Tolerance, ...] = ()
    samples: int = 0
    seed: int = 0
    corners: FloatArray = field(default_factory=lambda: np.zeros((0, 0)))

    @classmethod
    def over(cls, nominal: Problem, stated: Uncertainty, seed: int = 0) -> ScenarioProblem:
        """Make a problem of one for the model as it is; see `flexor.optimize`."""
        model, chosen = nominal.model, nominal.parameters
        if not isinstance(nominal.objective, Extremum):
            raise InputError(
                f'objective "{nominal.objective.name}" is not evaluated over scenarios: maximise '
                "or minimise an observable."
            )
        quantity = observable(nominal.objective.quantity, model)
        wanted = aggregate(stated.aggregate, nominal.objective.sign, quantity.dimension)
        made = cls(
            **{each.name: getattr(nominal, each.name) for each in fields(Problem)},
            scenarios=(
                *scenarios(stated.scenarios, model),
                *(wearers(model, stated.wearers, seed) if stated.wearers else ()),
            )
            or (AS_IT_IS,),
            aggregate=wanted,
            tolerances=tolerances(stated.tolerance, chosen, model),
            samples=stated.samples,
            seed=seed,
        )
        if not wanted.everywhere and made.tolerances and not stated.samples:
            raise InputError(
                f'aggregate "{wanted.text}" counts errors within the tolerances as samples: state '
                "a number of these, or leave the tolerances out."
            )
        if stated.samples and not made.tolerances:
            raise InputError("samples of errors need a tolerance: state one or leave them out.")
        if wanted.kind != "mean" and len(made.weights) == 1:
            raise InputError(
                f'aggregate "{wanted.text}": there is one scenario; name several, or sample errors.'
            )
        made._check_tolerances()
        made.cases  # noqa: B018 - a scenario that breaks the model is said at once
        return made

    def __getstate__(self) -> dict[str, Any]:
        # Another process makes models and maps in the same order, to the same bits.
        return {each.name: getattr(self, each.name) for each in fields(self)}

    @cached_property
    def nominal(self) -> Problem:
        """The problem for the model as it is, without errors."""
        return Problem(**{each.name: getattr(self, each.name) for each in fields(Problem)})

    @property
    def factor(self) -> float:
        """SI value of the unit of the objective's quantity."""
        return observable(self.objective.quantity, self.model).unit[0]

    @property
    def quantity(self) -> str:
        """What is aggregated, for display."""
        if self.aggregate.kind == "served":
            return f"served ({self.objective.quantity} {self.aggregate.text.split(' ', 1)[1]})"
        if len(self.weights) == 1:
            return self.objective.quantity
        return f"{self.objective.quantity} ({self.aggregate.text})"

    @property
    def unit(self) -> str:
        """Its unit."""
        return "%" if self.aggregate.kind == "served" else self.objective.unit

    @property
    def differentiable(self) -> bool:
        """Whether its value has a gradient."""
        return super().differentiable and self.aggregate.differentiable

    def with_corners(self, corners: FloatArray) -> ScenarioProblem:
        """Return the problem with other errors for which constraints have to hold."""
        made = replace(self, corners=np.asarray(corners, dtype=np.float64))
        for name in ("models", "cases", "_extra", "_values", "_extended", "_limb_batch"):
            made.__dict__[name] = getattr(self, name)  # models and maps stay
        return made

    @cached_property
    def cases(self) -> tuple[Problem, ...]:
        """A problem for each scenario, whose last parameters are fields with a tolerance only."""
        if not self._extra:
            # First, so that the numbers of the model as it is do not depend on scenarios.
            self.parameters.designs(self.parameters.start[None, :], self.model)
        return tuple(map(self._case, self.scenarios, self.models))

    @cached_property
    def errors(self) -> FloatArray:
        """Errors over which the objective is aggregated, (s, m): none, or samples."""
        if not self.samples:
            return np.zeros((1, len(self.tolerances)))
        return samples(self.tolerances, self.samples, self.seed)

    @property
    def count(self) -> int:
        """Number of cases in which a design is evaluated."""
        return len(self.scenarios) * (len(self.errors) + len(self.corners))

    @cached_property
    def weights(self) -> FloatArray:
        """Weight of each scenario with each of these errors, (S s,)."""
        share = np.array([each.weight for each in self.scenarios])
        return np.repeat(share, len(self.errors)) / len(self.errors)

    def excesses(self, paths: Paths) -> FloatArray:
        """How far each constraint of each case is exceeded, (n, cases c); none if they may be."""
        if not self.aggregate.everywhere:
            return np.zeros((len(paths), 0))
        return self._excesses(paths.constraint_values)

    def worst_of(self, values: FloatArray) -> FloatArray:
        """Return the worst value of each constraint over all cases, (c,), of those (cases c,)."""
        c = len(self.constraints)
        table = values.reshape(-1, c) if c else np.zeros((1, 0))
        found = [
            np.fmax.reduce(column) if each.sense == "<=" else np.fmin.reduce(column)
            for each, column in zip(self.constraints, table.T, strict=True)
        ]
        return np.array(found)

    def gradients(self, paths: Paths) -> FloatArray:
        """Gradients (n, k) of the aggregate, per SI unit; NaN where a design failed."""
        if paths.value_gradient is None:
            raise InputError("the paths have no gradient: evaluate them with gradient=True.")
        return np.where(np.isfinite(paths.value)[:, None], paths.value_gradient, np.nan)

    @property
    def linearizable(self) -> bool:
        """Whether the aggregate and all constraints have exact derivatives."""
        return super().linearizable and self.aggregate.differentiable

    def excess_gradients(self, paths: Paths) -> FloatArray:
        """Gradients (n, cases c, k) of `excesses`, per SI unit; NaN where a design failed."""
        n, k = len(paths), self.parameters.size
        if not self.aggregate.everywhere or not self.constraints:
            return np.zeros((n, 0, k))
        cases = paths.constraint_values.shape[1] // len(self.constraints)
        signs = [each.sign / each.scale for each in self.constraints] * cases
        found = paths.constraint_gradients * np.array(signs)[:, None]
        found = np.where(np.isnan(paths.constraint_values)[..., None], 0.0, found)
        return np.where(np.isfinite(paths.value)[:, None, None], found, np.nan)

    def by_case(
        self, designs: FloatArray, errors: FloatArray, threads: int = 0, gradient: bool = False
    ) -> list[Paths]:
        """Evaluate designs (n, k) with errors (e, m) in every scenario.

        Returns
        -------
        list of Paths
            Of each scenario: n e paths, those of the first design first.
        """
        placed = [self._placed(designs, errors, index) for index in range(len(self.cases))]
        if self._limb_batch is not None:
            return self._limb_batch.evaluate(placed, threads, gradient)
        work = [
            partial(case.evaluate, each, gradient=gradient)
            for case, each in zip(self.cases, placed, strict=True)
        ]
        return _all_of(work, threads)

    @cached_property
    def _limb_batch(self) -> LimbBatch | None:
        """All cases as one problem, if they are of one model but for its parameters."""
        return limb_batch(self.cases, self.scenarios)

    def path_of(self, design: FloatArray, error: FloatArray, scenario: int = 0) -> Path:
        """Follow the path of a design (k,) with an error (m,) in one of the scenarios."""
        return self.cases[scenario].path(self._placed(design[None], error[None], scenario)[0])

    def unit_of(self, tolerance: Tolerance) -> tuple[str, float]:
        """Return the unit of a field with a tolerance, and its SI value."""
        chosen = self.cases[0].parameters
        i = chosen.labels.index(tolerance.field)
        return chosen.units[i], float(chosen.scale[i])

    def _evaluate(self, designs: FloatArray, threads: int, gradient: bool) -> Paths:
        n, corners = len(designs), self.corners.reshape(len(self.corners), len(self.tolerances))
        errors = np.concatenate([self.errors, corners])
        found = self.by_case(designs, errors, threads, gradient)
        every = self._as_it_is(designs, found, threads)
        e, s, c = len(errors), len(self.errors), len(self.constraints)

        def table(name: str) -> FloatArray:
            return np.stack([getattr(each, name).reshape(n, e) for each in found], axis=1)

        values, shown, broken = table("value"), table("shown"), table("violation")
        kept = np.stack([each.constraint_values.reshape(n, e, c) for each in found], axis=1)
        counted, weights = values[:, :, :s].reshape(n, -1), self.weights
        ranked = broken[:, :, :s].reshape(n, -1)
        every.value[:] = self.aggregate.value(counted, weights, ranked)
        every.shown[:] = self._shown(counted, shown[:, :, :s].reshape(n, -1), ranked)
        every.reason[:] = ""
        every = replace(every, constraint_values=kept.reshape(n, -1))
        if self.aggregate.everywhere:
            every.violation[:] = broken.reshape(n, -1).max(axis=1)
            self._mark_failures(every, found, values)
        else:
            every.violation[:] = 0.0
        if gradient and self.differentiable:
            slopes = np.stack(
                [
                    case.gradients(paths)[:, : self.parameters.size].reshape(n, e, -1)[:, :s]
                    for case, paths in zip(self.cases, found, strict=True)
                ],
                axis=1,
            ).reshape(n, len(weights), -1)
            shares, total = self.aggregate.shares(counted, weights), np.zeros(designs.shape)
            for i in range(len(weights)):
                with np.errstate(invalid="ignore"):
                    total += (
                        np.where(shares[:, i, None] > 0.0, slopes[:, i], 0.0) * shares[:, i, None]
                    )
            kept_slopes = [
                paths.constraint_gradients[..., : self.parameters.size].reshape(n, e * c, -1)
                if c
                else np.zeros((n, 0, self.parameters.size))
                for paths in found
            ]
            bounded = np.concatenate(kept_slopes, axis=1)
            every = replace(every, value_gradient=total, constraint_gradients=bounded)
        return every

    def _mark_failures(self, every: Paths, found: list[Paths], values: FloatArray) -> None:
        """Let designs fail that fail in a case, and say which."""
        for i in np.flatnonzero(np.isinf(values).any(axis=(1, 2))):
            scenario, error = np.argwhere(np.isinf(values[i]))[0]
            reason = found[scenario].reason[i * values.shape[2] + error]
            where = f' in scenario "{self.scenarios[scenario].name}"' if self.named else ""
            within = " with an error within the tolerances" if len(self.tolerances) else ""
            every.value[i], every.shown[i], every.violation[i] = np.inf, np.nan, np.inf
            every.reason[i] = f"{reason}{where}{within}"

    @property
    def named(self) -> bool:
        """Whether there are scenarios besides the model as it is."""
        return self.scenarios != (AS_IT_IS,)

    def _shown(self, values: FloatArray, shown: FloatArray, broken: FloatArray) -> FloatArray:
        """Aggregate what is shown like the values."""
        if self.aggregate.kind == "served":
            share = 100.0 * self.weights / self.weights.sum()
            served = self.aggregate.shortfalls(values, broken) <= 0.0
            return np.array([share[row].sum() for row in served])
        shares = self.aggregate.shares(values, self.weights)
        total = np.zeros(len(values))
        for i in range(values.shape[1]):
            total += np.where(shares[:, i] > 0.0, shown[:, i], 0.0) * shares[:, i]
        return total

    def _as_it_is(self, designs: FloatArray, found: list[Paths], threads: int) -> Paths:
        """Return the paths of the model as it is, of the arrays that are recorded."""
        plain = [i for i, each in enumerate(self.scenarios) if not each.changes]
        if plain and not self.errors.any():
            rows = np.arange(len(designs)) * (len(found[plain[0]]) // max(len(designs), 1))
            return found[plain[0]][rows].recorded(without=_SLOPES)
        return self.nominal.evaluate(designs, threads).recorded()

    def _placed(self, designs: FloatArray, errors: FloatArray, index: int) -> FloatArray:
        """Return designs (n, k) with errors (e, m) as those of a case, (n e, k + extra)."""
        k, extra = self.parameters.size, len(self._extra)
        start = self._values[index]
        whole = np.concatenate([designs, np.broadcast_to(start, (len(designs), extra))], axis=1)
        labels = (*self.parameters.labels, *self._extra)
        shift = np.zeros((len(errors), k + extra))
        for column, each in enumerate(self.tolerances):
            shift[:, labels.index(each.field)] = errors[:, column]
        return (whole[:, None, :] + shift[None, :, :]).reshape(-1, k + extra)

    @cached_property
    def _extra(self) -> tuple[str, ...]:
        """Fields with a tolerance that are no design parameters."""
        labels = self.parameters.labels
        return tuple(each.field for each in self.tolerances if each.field not in labels)

    def _case(self, scenario: Scenario, model: Model) -> Problem:
        try:
            chosen = self._parameters(scenario, model)
            wanted = named_objective(self.objective.name, model)
            if self.objective.loads is not None:
                wanted = wanted.at(np.array(self.objective.loads))
            for each in self.constraints:
                each.observable(model)
            made = Problem(model, chosen, wanted, self.options, self.constraints)
            made.loads  # noqa: B018 - those of the scenario have to be defined
            chosen.designs(chosen.start[None, :], model)  # and the parameters varied
        except InputError as error:
            if scenario is AS_IT_IS:
                raise
            raise InputError(f'scenario "{scenario.name}": {error}') from None
        return made

    def _parameters(self, scenario: Scenario, model: Model) -> ParameterSet:
        chosen = self.parameters
        if not isinstance(chosen, Variables):
            return chosen.on_model(model) if scenario.changes else chosen
        changed = set(scenario.keys)
        for label in chosen.fields:
            keys = keys_of(label, self.model.file)
            if any(keys[: len(each)] == each for each in changed):
                raise InputError(
                    f'it changes "{label}", which is a design variable: leave out one of them.'
                )
        return self._extended

    @cached_property
    def _extended(self) -> Variables:
        """The design parameters and the fields with a tolerance only, for all scenarios."""
        chosen, names = self.parameters, self._extra
        assert isinstance(chosen, Variables)
        if not names:
            return chosen
        reach = {each.field: each.reach for each in self.tolerances}
        size = np.array([reach[each] for each in names])
        kinds = [_kind(each, self.model) for each in names]
        more = Variables(
            name=chosen.name,
            labels=names,
            units=tuple(kind.text or "1" for kind in kinds),
            lower=self._values.min(axis=0) - size,
            upper=self._values.max(axis=0) + size,
            start=self._values[0],
            kinds=tuple(kinds),
        )
        return chosen.extended(more)

    @cached_property
    def models(self) -> tuple[Model, ...]:
        """The model of each scenario, in which straps with a tolerance of their place can move."""
        fields = self._extra
        return tuple(with_moving_straps(each.model(self.model), fields) for each in self.scenarios)

    @cached_property
    def _values(self) -> FloatArray:
        """Values of the fields with a tolerance only in each scenario, (S, extra)."""
        found = np.zeros((len(self.scenarios), len(self._extra)))
        for row, model in zip(found, self.models, strict=True):
            row[:] = [value_of(keys_of(each, model.file), model.file) for each in self._extra]
        for each in self.tolerances:
            if each.field in self._extra:
                column = found[:, self._extra.index(each.field)]
                least = float(column[np.argmin(np.abs(column))])
                if not each.reach < abs(least):
                    keys = keys_of(each.field, self.model.file)
                    stated = getattr(value_of(keys, self.model.file), "text", "")
                    _, unit = infer_quantity(stated or least, each.field)
                    raise _too_large(each, "value", f"{least / unit.factor:.4g} {unit.text}")
        return found

    def _check_tolerances(self) -> None:
        """Check that no error within the tolerances leaves a size of a design without any."""
        chosen = self.parameters
        for each in self.tolerances:
            if not isinstance(chosen, Variables) or each.field not in chosen.labels:
                continue
            i = chosen.labels.index(each.field)
            low, unit, scale = float(chosen.lower[i]), chosen.units[i], float(chosen.scale[i])
            if not 0.0 < low <= each.reach:
                continue
            changes = {each.field: chosen.kinds[i].exact(low - each.reach)}
            try:
                changed_model(self.model, changes)
            except InputError:  # it is a size, and no position or angle
                text = f"{low / scale:.4g} {unit if unit != '1' else ''}"
                raise _too_large(each, "lower bound", text) from None

    def _excesses(self, values: FloatArray) -> FloatArray:
        n, c = len(values), len(self.constraints)
        if not c:
            return np.zeros((n, 0))
        return excesses(self.constraints, values.reshape(-1, c)).reshape(n, -1)


def _too_large(tolerance: Tolerance, what: str, text: str) -> InputError:
    return InputError(
        f'the tolerance of "{tolerance.field}", {tolerance.largest}, is not below its {what}, '
        f"{text.rstrip()}: it has to be smaller."
    )


def _kind(path: str, model: Model) -> Any:
    value = value_of(keys_of(path, model.file), model.file)
    return infer_quantity(getattr(value, "text", value), path)[1]


def _all_of(work: Sequence[Callable[..., Paths]], threads: int) -> list[Paths]:
    """Do work on so many threads, 0 for one per core; on all of them where it is one piece."""
    workers = min(threads or os.cpu_count() or 1, len(work))
    if workers == 1:
        return [each(threads=threads) for each in work]
    with ThreadPoolExecutor(workers) as pool:
        futures = [pool.submit(each, threads=1) for each in work]
        try:
            return [each.result() for each in futures]
        except BaseException:
            cancel_solves(futures)
            raise
