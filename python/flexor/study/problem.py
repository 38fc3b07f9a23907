"""A design problem, which evaluates designs of a parameter set by an objective."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from os import PathLike
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from flexor.constraints import (
    Constraint,
    check_possible,
    chosen_constraints,
    excesses,
    ranks,
    violation,
    worst_values,
)
from flexor.design import Geometry, ParameterSet, Variables, parameter_set, variables
from flexor.design.start import bounds_in_si
from flexor.errors import InputError
from flexor.model.chunks import chunks
from flexor.model.derivatives import last_step
from flexor.model.loading import require_model
from flexor.model.loads import loads
from flexor.model.results import Path, Paths
from flexor.model.solver import solver_options
from flexor.objectives import Objective, evaluate_objective
from flexor.objectives import objective as named_objective

if TYPE_CHECKING:
    from flexor.model import Model

FloatArray = NDArray[np.float64]

# Derivatives by the engine's parameters, which may be many, that are held at a time.
_HELD = 1_000_000


@dataclass(frozen=True, eq=False)
class Problem:
    """A design problem: a model, its design parameters and an objective.

    Searches, grids and comparisons all evaluate designs through this one function; a
    `DesignEvaluator` says where that happens.

    Attributes
    ----------
    model : Model
        The model.
    parameters : ParameterSet
        Design parameters of the model's exosuit.
    objective : Objective
        The objective.
    options : dict
        Settings of the engine's solver.
    constraints : tuple of Constraint
        What a design has to keep along the whole path.
    """

    model: Model
    parameters: ParameterSet
    objective: Objective
    options: Mapping[str, float] = field(default_factory=dict)
    constraints: tuple[Constraint, ...] = ()

    def __str__(self) -> str:
        return f'parameter set "{self.parameters.name}" or objective "{self.objective.name}"'

    @classmethod
    def of(
        cls,
        model: Model | str | PathLike[str],
        parameters: str | ParameterSet | Mapping[str, Sequence[object]],
        objective: str | Objective | Sequence[str | Objective],
        force: Any = None,
        bounds: Mapping[str, tuple[float, float]] | None = None,
        options: Mapping[str, float] | None = None,
        subject_to: Sequence[str] = (),
        without: Sequence[str] = (),
    ) -> Problem:
        """Make a problem of what users give; see `flexor.optimize`."""
        model = require_model(model)
        if isinstance(parameters, Mapping):
            parameters = variables(parameters, model, "parameters")
        if isinstance(parameters, Variables):
            chosen: ParameterSet = parameters
            model = parameters.prepared(model)
        else:
            chosen = parameter_set(parameters, model.design).on(model.design)
        if bounds:
            chosen = chosen.with_bounds(bounds_in_si(bounds, chosen))
        wanted = named_objective(objective, model)
        kept = chosen_constraints(subject_to, without, model, wanted.of_observable)
        if force is not None:
            wanted = wanted.at(loads(force, model.input_dimensions))
        made = cls(model, chosen, wanted, solver_options(options or {}), kept)
        if kept:
            check_possible(kept, model, made.loads, chosen.varied_inputs)
        return made

    @property
    def loads(self) -> FloatArray:
        """Loads [N or Pa] of every path, (steps, inputs): the objective's or else the model's."""
        if self.objective.loads is not None:
            return np.array(self.objective.loads)
        return self.model.evaluation_loads

    @property
    def force(self) -> FloatArray:
        """Loads of the first input [N or Pa], (steps,); zero without one."""
        return self.loads[:, 0] if self.loads.shape[1] else np.zeros(len(self.loads))

    @property
    def nominal(self) -> Problem:
        """The problem for the model as it is."""
        return self

    @property
    def quantity(self) -> str:
        """What is sought, for display."""
        return self.objective.quantity

    @property
    def unit(self) -> str:
        """Its unit."""
        return self.objective.unit

    @property
    def differentiable(self) -> bool:
        """Whether its value has a gradient."""
        return self.objective.differentiable

    @property
    def sizes(self) -> tuple[int, int, int]:
        """Numbers of parameters, steps and joints."""
        return self.parameters.size, len(self.loads), len(self.model.joints)

    def geometry(self, designs: FloatArray) -> Geometry:
        """Geometry of designs (n, k) at the model's sample points."""
        return self.parameters.geometry(designs, self.model.design.points)

    def evaluate(self, designs: FloatArray, threads: int = 0, gradient: bool = False) -> Paths:
        """Follow the paths of n designs and evaluate the objective.

        Parameters
        ----------
        designs : (n, k) array
            Designs, SI.
        threads : int
            Threads of the engine, 0 for one per core. The results do not depend on it.
        gradient : bool
            Whether to differentiate as well, exactly.

        Returns
        -------
        Paths
            Those arrays that a study records, in the order of the designs. A design whose surface
            is not positive, or whose path did not converge, is marked failed with the reason.
        """
        parts = [self._evaluate(designs[c], threads, gradient) for c in chunks(len(designs))]
        return Paths.concatenate(parts)

    def ranks(self, paths: Paths) -> FloatArray:
        """Numbers (n,) that order designs: feasible ones by value, then others by violation.

        Those of feasible designs are their values, those of designs that failed +inf.
        """
        return ranks(paths.value, paths.violation)

    def excesses(self, paths: Paths) -> FloatArray:
        """How far each constraint is exceeded, (n, c), by its bound; kept where not above 0."""
        return excesses(self.constraints, paths.constraint_values)

    def worst_of(self, values: FloatArray) -> FloatArray:
        """Return the value of each constraint that counts, (c,), of the recorded ones."""
        return values

    def worst_excesses(self, values: FloatArray) -> FloatArray:
        """Return how far each constraint is exceeded, (c,), of the recorded values of a design."""
        return np.asarray(excesses(self.constraints, self.worst_of(values)[None, :])[0])

    def residuals(self, paths: Paths) -> FloatArray:
        """Vectors (n, r) whose norms are the objective's values; NaN where a design failed.

        InputError if the objective is not the norm of a vector.
        """
        vectors = self.objective.residual(self._complete(paths))
        return np.where(np.isfinite(paths.value)[:, None], vectors, np.nan)

    def gradients(self, paths: Paths) -> FloatArray:
        """Gradients (n, k) of the objective's values, per SI unit; NaN where a design failed.

        The paths must have their derivatives. InputError if the objective has no gradient.
        """
        if not self.objective.differentiable:
            raise InputError(f'objective "{self.objective.name}" has no gradient.')
        return np.where(np.isfinite(paths.value)[:, None], paths.value_gradient, np.nan)

    @property
    def linearizable(self) -> bool:
        """Whether the value and all constraints have exact derivatives."""
        observed = (each.observable(self.model) for each in self.constraints)
        return self.differentiable and all(each.differentiable for each in observed)

    def excess_gradients(self, paths: Paths) -> FloatArray:
        """Gradients (n, c, k) of `excesses`, per SI unit; NaN where a design failed.

        The paths must have their derivatives. Of what exists at no load they are zero.
        """
        scale = np.array([each.sign / each.scale for each in self.constraints])
        absent = np.isnan(paths.constraint_values)[..., None]
        found = np.where(absent, 0.0, paths.constraint_gradients * scale[:, None])
        return np.where(np.isfinite(paths.value)[:, None, None], found, np.nan)

    def jacobians(self, paths: Paths) -> FloatArray:
        """Jacobians (n, r, k) of `residuals`, per SI unit; NaN where a design failed.

        The paths must have their derivatives. InputError if the objective is not the norm of a
        vector with a gradient.
        """
        found = self.objective.residual_gradient(self._complete(paths)).chained(paths.derivatives)
        return np.where(np.isfinite(paths.value)[:, None, None], found, np.nan)

    def path(self, design: FloatArray) -> Path:
        """Follow the path of one design (k,) and keep all of it."""
        designs, _ = self.parameters.designs(design[None, :], self.model)
        options = dict[str, Any](self.options)
        return self.model.equilibrium(self.loads_of(design), design=designs, **options)

    def loads_of(self, design: FloatArray) -> FloatArray:
        """Return the loads of the path of one design (k,), (steps, inputs)."""
        own = self.parameters.own_loads(design[None, :], self.loads, self.model)
        return self.loads if own is None else own[0]

    def _complete(self, paths: Paths) -> Paths:
        """Give recorded paths the model and loads that objectives ask for."""
        return replace(paths, model=self.model, loads=self.loads)

    def _evaluate(self, designs: FloatArray, threads: int, gradient: bool) -> Paths:
        chosen, valid = self.parameters.designs(designs, self.model)
        every = Paths.failed(
            len(designs),
            len(self.loads),
            len(self.model.joints),
            "has a length or radius that is not positive",
            self.parameters.size if gradient else None,
            len(self.constraints),
            self.objective.count,
        )
        if not valid.any():
            return every
        options, loads = dict[str, Any](self.options), self.loads
        own = self.parameters.own_loads(designs[valid], loads, self.model)
        paths = self.model.evaluate(chosen, loads if own is None else own, threads, **options)
        worst = worst_values(self.constraints, paths)
        broken = violation(excesses(self.constraints, worst))
        evaluated = evaluate_objective(self.objective, paths)
        broken[~np.isfinite(evaluated.value)] = np.inf
        evaluated = replace(evaluated, constraint_values=worst, violation=broken)
        evaluated.scatter(every, np.flatnonzero(valid))
        if gradient:
            numbers = len(self.model.joints) + 2 + len(self.constraints)
            each = numbers * len(self.parameters.slots(self.model))
            count = max(_HELD // max(each, 1), 1)
            for first in range(0, len(paths), count):
                part = np.arange(first, min(first + count, len(paths)))
                rows = np.flatnonzero(valid)[part]
                self._differentiate(paths[part], designs[rows], every, rows, threads)
        return every

    def _differentiate(
        self, paths: Paths, designs: FloatArray, out: Paths, rows: NDArray[np.intp], threads: int
    ) -> None:
        """Write the derivatives of paths of designs (n, k) into rows of others."""
        model, joints = self.model, paths.joint_angles.shape[2]
        observed = [each.observable(model) for each in self.constraints]
        known = np.array([each.differentiable for each in observed], dtype=bool)
        changes = last_step(paths)
        if self.objective.differentiable:
            changes.append(self.objective.differential(paths))
        changes += [
            each.differential(paths)
            for each, has in zip(self.constraints, known, strict=True)
            if has
        ]
        found = model.differentiate(paths, changes, self.parameters.slots(model), threads)
        slopes = found.by_slots @ self.parameters.slot_jacobian(designs, model)
        by_loads = self.parameters.load_jacobian(self.loads, model)
        if by_loads is not None:
            slopes += np.einsum("nrsu,suk->nrk", found.by_loads, by_loads)
        failed = ~(paths.converged & paths.stable).all(axis=1)
        slopes[failed], found.regularity[failed] = np.nan, "no-equilibrium"
        out.derivatives[rows] = slopes[:, : joints + 1]
        out.regularity[rows] = found.regularity[:, joints]
        first = joints + 1
        if self.objective.differentiable:
            out.value_gradient[rows] = slopes[:, first]
            out.regularity[rows] = found.regularity[:, first]
            first += 1
        out.constraint_gradients[np.ix_(rows, known)] = slopes[:, first:]
        out.constraint_regularity[np.ix_(rows, known)] = found.regularity[:, first:]
        out.constraint_regularity[np.ix_(rows, ~known)] = "no-derivative"
