"""Values that observables of a model are to reach."""

from __future__ import annotations

import contextlib
from collections.abc import Mapping
from dataclasses import dataclass

from flexor.arguments import assignments
from flexor.errors import InputError, unknown_name
from flexor.model.quantity import parse_quantity
from flexor.model.structure import Structure
from flexor.observables import Observable, kinds, observable


@dataclass(frozen=True)
class Target:
    """A value that an observable is to reach.

    Attributes
    ----------
    observable : Observable
        What is to reach it.
    value : float
        SI.
    """

    observable: Observable
    value: float

    def __str__(self) -> str:
        return f"{self.observable.name} = {self.observable.shown(self.value, 6)}"


def targets(given: str | Mapping[str, str | float], model: Structure) -> tuple[Target, ...]:
    """Read targets.

    Parameters
    ----------
    given
        Values by the name of a joint or of an observable, such as ``{"ph_1": "40 deg",
        "tip-force": "2 N"}``; or one text, ``"ph_1 = 40 deg, ph_2 = 30 deg"``.
    model
        The model.

    Raises
    ------
    InputError
        If there is no target, a name is not known or occurs twice, or a value has another unit.
    """
    if isinstance(given, str):
        given = assignments("reach", given.split(","), "ph_1=40 deg")
    table = dict(given)
    if not table:
        raise InputError('reach has no target: give one, such as "ph_1 = 40 deg".')
    found = [_target(name, value, model) for name, value in table.items()]
    names = [each.observable.name for each in found]
    for name in names:
        if names.count(name) > 1:
            raise InputError(f'reach has two values for "{name}".')
    return tuple(found)


def _target(name: str, value: str | float, model: Structure) -> Target:
    label = model.joint_labels.get(name, name)
    labels = list(model.joint_labels.values())
    if label in labels:
        found = observable(f"angle.{label}", model)
    elif name.partition(".")[0].casefold().replace("_", "-") in kinds():
        found = observable(name, model)
    else:
        raise InputError(f"{unknown_name('joint or observable', name, [*labels, *kinds()])}.")
    if found.dimension is None:
        with contextlib.suppress(ValueError):  # reported below
            value = float(value)
    number, _ = parse_quantity(value, found.dimension, f"reach: {name}")
    return Target(found, number)
