"""Scenarios: variants of a model with weights, under which a design is evaluated."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

from flexor.errors import InputError, unknown_name
from flexor.model.reading import with_changes
from flexor.model.validation import describe
from flexor.model.variants import changes as changes_of
from flexor.model.variants import leaf_keys, leaves

if TYPE_CHECKING:
    from flexor.model import Model

ALL = "all"


@dataclass(frozen=True)
class Scenario:
    """Changes of a model file under which a design is evaluated, and how much they count.

    Attributes
    ----------
    name : str
        Such as that of the variant of the file.
    weight : float
        Above 0; those of all scenarios may have any sum.
    changes : dict
        Tables of the file with the fields that change, as in a variant.
    """

    name: str
    weight: float = 1.0
    changes: Mapping[str, Any] = field(default_factory=dict)

    @property
    def keys(self) -> tuple[tuple[str, ...], ...]:
        """Keys of the fields that change."""
        return tuple(leaf_keys(self.changes))

    @property
    def fields(self) -> tuple[str, ...]:
        """Dotted paths of the fields that change."""
        return tuple(leaves(self.changes))

    def model(self, model: Model) -> Model:
        """Return a model with the changes; InputError, naming the scenario, if it is none."""
        from flexor.model import Model as Built

        if not self.changes:
            return model
        source = f'scenario "{self.name}"'
        return Built(with_changes(model.file, self.changes, source), source)


Given = str | Sequence[str | Scenario] | Mapping[str, float] | None


def scenarios(given: Given, model: Model) -> tuple[Scenario, ...]:
    """Return scenarios of a model.

    Parameters
    ----------
    given
        Names of variants of the model's file, ``"NAME=WEIGHT"`` in place of a name for another
        weight than that of the file, or a table of weights by name; ``"all"`` variants; wearers by
        the percentile of their hand, such as ``"5%"``; or ready scenarios. A text lists names with
        commas.
    model
        The model.

    Raises
    ------
    InputError
        If there is no such variant, no population for percentiles or one is not between 0 and 100,
        a scenario is named twice, or a weight is not above 0.
    """
    if not given:
        return ()
    if not isinstance(given, (str, Mapping, Iterable)):
        raise InputError(
            f"scenarios is {describe(given)}: it must be names of variants or a table of weights."
        )
    if isinstance(given, Mapping):
        pairs: list[Any] = list(given.items())
    else:
        texts = given.split(",") if isinstance(given, str) else given
        pairs = [_pair(each) if isinstance(each, str) else each for each in texts]
        for each in pairs:
            if not isinstance(each, (tuple, Scenario)):
                raise InputError(f"scenarios has {describe(each)}: each must be a name.")
    known = model.variants
    found: dict[str, Scenario] = {}
    for each in pairs:
        made = [each] if isinstance(each, Scenario) else _named(each[0], each[1], known, model)
        for scenario in made:
            if scenario.name in found:
                raise InputError(f'scenario "{scenario.name}" is given twice.')
            _check_weight(scenario.name, scenario.weight)
            found[scenario.name] = scenario
    return tuple(found.values())


def _pair(text: str) -> tuple[str, float | str | None]:
    name, equals, weight = (part.strip() for part in text.partition("="))
    return name, (weight if equals else None)


def _named(
    name: str, weight: float | str | None, known: Mapping[str, float], model: Model
) -> list[Scenario]:
    if name.endswith("%") and name not in known:
        return [_of_percentile(name, weight, model)]
    if name == ALL and ALL not in known:
        if not known:
            raise InputError(f'scenarios "all": the model "{model.name}" has no variants.')
        names = list(known)
    elif not known:
        raise InputError(f'scenario "{name}": the model "{model.name}" has no variants.')
    elif name not in known:
        raise InputError(f"{unknown_name('variant', name, known)}.")
    else:
        names = [name]
    made = []
    for each in names:
        number = known[each] if weight is None else _number(each, weight)
        made.append(Scenario(each, number, changes_of(model.file.variants[each])))
    return made


def _of_percentile(name: str, weight: float | str | None, model: Model) -> Scenario:
    from flexor.scenarios.population import of_percentile

    try:
        percent = float(name[:-1])
    except ValueError:
        percent = math.nan
    if not 0.0 < percent < 100.0:
        raise InputError(
            f'scenario "{name}": write a percentile between 0 and 100, such as "95%", or the name '
            "of a variant."
        )
    made = of_percentile(model, percent)
    return made if weight is None else replace(made, weight=_number(name, weight))


def _number(name: str, weight: object) -> float:
    try:
        return float(weight)  # type: ignore[arg-type]
    except (TypeError, ValueError):
        raise _bad_weight(name, weight) from None


def _check_weight(name: str, weight: float) -> None:
    if not 0.0 < weight < math.inf:
        raise _bad_weight(name, weight)


def _bad_weight(name: str, weight: object) -> InputError:
    return InputError(f'scenario "{name}" has the weight {weight}: it must be a number above 0.')
