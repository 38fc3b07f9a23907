"""What moves the answer most if it is off by 1 %: every number of the model and every load."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from pydantic import BaseModel

from flexor.design import Variables
from flexor.design.changes_by_part import ChangesByPart
from flexor.design.fields import value_of
from flexor.errors import InputError
from flexor.model.geometry import SlotValues
from flexor.model.quantity import infer_quantity
from flexor.objectives import evaluate_objective
from flexor.study.designed_model import designed_model
from flexor.study.problem import FloatArray, Problem

if TYPE_CHECKING:
    from flexor.model import Model

Keys = tuple[str, ...]

# How far everything is off, as a share of its value.
SHARE = 0.01
# Change of the answer, as a share of it, that is worth a warning.
FRAGILE = 0.1
# Tables that are no part of what is made or worn.
_OTHER = ("design", "evaluation", "start", "solver")


@dataclass(frozen=True)
class Fragile:
    """A number of the model, or a load, of which 1 % moves the answer by more than a tenth."""

    name: str  # such as ``"ph_1.joint.stiffness"``
    change: float  # of the answer, as a share of it; NaN if the design then fails


def fragile(problem: Problem, x: FloatArray) -> tuple[Fragile, ...]:
    """Find what moves the objective of a design (k,) by more than a tenth if it is off by 1 %.

    Every number of the model's file, and every load, is changed both ways; of parameter sets that
    are no fields of the file, their parameters in place of the length and the radius of the rod.
    """
    chosen = problem.parameters
    model, left = designed_model(problem, x), set[Keys]()
    if not isinstance(chosen, Variables):
        design = model.file.design
        assert design is not None
        assert design.rod is not None
        left = {("bodies", design.rod, key) for key in ("length", "radius")}
    names, rows, fixed = _neighbours(model, left)
    here = model.parameters
    loads, options = problem.loads, dict[str, Any](problem.options)
    own = chosen.own_loads(x[None, :], loads, model)
    loads = loads if own is None else own[0]

    def shown(paths: Any) -> FloatArray:
        return evaluate_objective(problem.objective, paths).shown

    every = np.arange(here.size, dtype=np.intp)
    # Of a change of 1 % the other way the parameters are those of a straight line.
    both = np.concatenate([rows, 2.0 * here - rows[1:]])
    off = shown(model.evaluate(SlotValues(every, both), loads, **options))
    design_values = SlotValues(every, here[None, :])
    value, count = off[0], len(names)
    changes = dict(zip(names, np.abs(off[1:].reshape(2, count) - value).max(axis=0), strict=True))
    if not isinstance(chosen, Variables):
        around = SHARE * np.diag(np.abs(x))
        of_set = problem.evaluate(np.concatenate([x[None, :], x + around, x - around])).shown
        most = np.abs(of_set[1:].reshape(2, chosen.size) - of_set[0]).max(axis=0)
        changes |= dict(zip(chosen.labels, most, strict=True))
    for i, name in enumerate(model.inputs):
        if loads[:, i].any():
            ends = []
            for factor in (1.0 + SHARE, 1.0 - SHARE):
                scaled = loads.copy()
                scaled[:, i] *= factor
                ends.append(shown(model.evaluate(design_values, scaled, **options))[0])
            changes[f"the load {name}"] = np.abs(np.array(ends) - value).max()
    for name, (keys, number) in fixed.items():
        off_by = [_with(model, keys, number * (1.0 + sign * SHARE)) for sign in (1.0, -1.0)]
        ends = [shown(m.evaluate(m.own_design, loads, 1, **options))[0] for m in off_by if m]
        changes[name] = np.abs(np.array(ends) - value).max(initial=0.0)
    size = max(abs(value), 1e-300)
    return tuple(
        Fragile(name, float(change / size))
        for name, change in changes.items()
        if not change <= FRAGILE * size
    )


def _neighbours(
    model: Model, left: set[Keys]
) -> tuple[list[str], FloatArray, dict[str, tuple[Keys, float]]]:
    """Return names of numbers, and the engine's parameters if each is more, those of all before.

    Numbers that are no parameters of the engine, such as limits of joints, come last, with their
    keys. What is ``left`` out is given by the first three keys.
    """
    fixed: dict[str, tuple[Keys, float]] = {}
    names, rows, changes = [], [model.parameters], ChangesByPart(model)
    for keys, value in numbers(model):
        if keys[:3] in left:
            continue
        # The table need not be said where the name of the entry says which.
        name = ".".join(keys[1:] if len(keys) > 2 else keys)
        changed = changes.parameters_with(keys, value * (1.0 + SHARE))
        if changed is None:
            fixed[name] = (keys, value)
        elif not np.array_equal(changed, model.parameters):
            names.append(name)
            rows.append(changed)
    return names, np.stack(rows), fixed


def _with(model: Model, keys: Keys, value: float) -> Model | None:
    """Return the model with another value of a number; None if it is then no model."""
    from flexor.model import load

    own = value_of(keys, model.file)
    _, unit = infer_quantity(getattr(own, "text", own), ".".join(keys))
    try:
        return load(model.file, changes={".".join(keys): unit.exact(value)})
    except InputError:
        return None


def numbers(model: Model) -> Iterator[tuple[tuple[str, ...], float]]:
    """Yield every number of a model's file that is not zero, by its keys."""
    for table in type(model.file).model_fields:
        if table not in _OTHER:
            yield from _leaves(getattr(model.file, table), (table,))


def _leaves(node: Any, keys: tuple[str, ...]) -> Iterator[tuple[tuple[str, ...], float]]:
    if isinstance(node, float):
        if node != 0.0 and np.isfinite(node):
            yield keys, float(node)
    elif isinstance(node, BaseModel):
        for name in type(node).model_fields:
            yield from _leaves(getattr(node, name), (*keys, name))
    elif isinstance(node, dict):
        if keys[0] not in ("constants", "variants"):
            for name, value in node.items():
                yield from _leaves(value, (*keys, name))
    elif isinstance(node, tuple):
        for i, value in enumerate(node):
            yield from _leaves(value, (*keys, str(i)))
