"""Wearers of a device as scenarios: hands of a survey, joints from healthy to spastic."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from statistics import NormalDist
from typing import TYPE_CHECKING, Any

import numpy as np

from flexor.design.fields import keys_of, value_of
from flexor.design.stated_variables import fields_of
from flexor.errors import InputError, unknown
from flexor.model.quantity import Unit, infer_quantity
from flexor.scenarios.scenario import Scenario
from flexor.scenarios.tolerance import Tolerance, samples

if TYPE_CHECKING:
    from flexor.model import Model


@dataclass(frozen=True)
class Hands:
    """Length and breadth of the hands of a population, jointly normal."""

    length: float  # mean [m]
    length_deviation: float  # [m]
    breadth: float  # mean [m]
    breadth_deviation: float  # [m]
    correlation: float
    source: str


SURVEYS = {
    # Statistics of the 4,082 men; hands of women need a source of their own.
    "ansur2-men": Hands(
        *(0.1933, 0.0099, 0.0883, 0.0044, 0.582),
        source="men of the 2012 US Army survey (Gordon et al. 2014, NATICK/TR-15/007)",
    ),
}


def wearers(model: Model, count: int, seed: int = 0) -> tuple[Scenario, ...]:
    """Draw wearers from the population that a model's file states.

    Length and breadth of the hand are normal with the correlation of the survey; the stiffness of
    the joints is a multiple of that in the file, uniform in its logarithm. They are a Sobol
    sequence, the same for the same seed, of which the first wearers are a sample as well.

    Parameters
    ----------
    model
        The model, with a ``[population]``.
    count
        How many.
    seed
        Of the sequence.

    Raises
    ------
    InputError
        If the file states no population, or one of its fields does not exist.
    """
    follow = _Followers.of(model)
    stated = model.file.population
    assert stated is not None
    hands = SURVEYS[stated.hands]
    normal = tuple(Tolerance(name, "normal", 1.0, "") for name in ("length", "breadth"))
    drawn = samples((*normal, Tolerance("stiffness", "uniform", 1.0, "")), count, seed)
    first = drawn[:, 0]
    second = hands.correlation * first + math.sqrt(1.0 - hands.correlation**2) * drawn[:, 1]
    lengths = hands.length + hands.length_deviation * first
    breadths = hands.breadth + hands.breadth_deviation * second
    low, high = np.log(stated.stiffness_range)
    multiples = np.exp(low + (high - low) * 0.5 * (drawn[:, 2] + 1.0))
    rows = zip(lengths.tolist(), breadths.tolist(), multiples.tolist(), strict=True)
    return tuple(follow.scenario(*row, f"wearer {i}") for i, row in enumerate(rows, start=1))


def wearer(
    model: Model, length: float, breadth: float, stiffness: float = 1.0, *, name: str = "wearer"
) -> Scenario:
    """Return a wearer by the length and breadth of the hand [m] and a multiple of stiffness.

    Parameters
    ----------
    model
        The model, with a ``[population]`` that says which fields follow.
    length, breadth
        Of the hand [m].
    stiffness
        Of the joints, in multiples of that in the file.
    name
        What the scenario is called, before its measures.
    """
    return _Followers.of(model).scenario(length, breadth, stiffness, name)


def of_percentile(model: Model, percent: float, stiffness: float = 1.0) -> Scenario:
    """Return a wearer whose hand is as long and as broad as that of a percentile of the survey.

    Parameters
    ----------
    model
        The model, with a ``[population]``.
    percent
        Between 0 and 100: the share of hands that are shorter, and of those that are narrower.
    stiffness
        Of the joints, in multiples of that in the file.
    """
    follow, stated = _Followers.of(model), model.file.population
    assert stated is not None
    hands, off = SURVEYS[stated.hands], NormalDist().inv_cdf(percent / 100.0)
    length = hands.length + off * hands.length_deviation
    breadth = hands.breadth + off * hands.breadth_deviation
    return follow.scenario(length, breadth, stiffness, f"wearer of {percent:g}%")


def _fields(paths: Sequence[str], model: Model) -> Iterator[str]:
    """Yield fields, with those that patterns stand for, each once."""
    yield from dict.fromkeys(
        field for path in paths for field in fields_of(path, model.file, "population")
    )


@dataclass(frozen=True)
class _Followers:
    """The fields that follow the length and breadth of a hand, and the stiffness of its joints."""

    own: tuple[float, float]  # length and breadth of the file's hand [m]
    fields: tuple[tuple[tuple[str, ...], float, Unit, int], ...]  # keys, value, unit, of which
    with_stiffness: bool

    @classmethod
    def of(cls, model: Model) -> _Followers:
        stated = model.file.population
        if stated is None:
            raise InputError(f'the model "{model.name}" has no [population]: state one.')
        hands = SURVEYS.get(stated.hands)
        if hands is None:
            raise unknown("survey of hands", stated.hands, SURVEYS)
        found: list[tuple[tuple[str, ...], float, Unit, int]] = []
        for which, paths in enumerate((stated.length, stated.breadth, stated.stiffness)):
            for path in _fields(paths, model):
                keys = keys_of(path, model.file)
                if keys in {each[0] for each in found}:
                    raise InputError(
                        f'population: "{path}" is named twice: it can follow one measure.'
                    )
                if any(key.isdigit() for key in keys):
                    raise InputError(f'population: "{path}" is an entry of a list: name another.')
                value = value_of(keys, model.file)
                _, unit = infer_quantity(getattr(value, "text", value), path)
                found.append((keys, float(value), unit, which))
        own = stated.hand_length or hands.length, stated.hand_breadth or hands.breadth
        low, high = stated.stiffness_range
        return cls(
            (float(own[0]), float(own[1])), tuple(found), bool(stated.stiffness) and low < high
        )

    def scenario(self, length: float, breadth: float, stiffness: float, name: str) -> Scenario:
        """Return a wearer."""
        factors = length / self.own[0], breadth / self.own[1], stiffness
        changes: dict[str, Any] = {}
        for keys, value, unit, which in self.fields:
            table = changes
            for key in keys[:-1]:
                table = table.setdefault(key, {})
            table[keys[-1]] = unit.exact(value * factors[which])
        measures = f"hand {1e3 * length:.0f} x {1e3 * breadth:.0f} mm"
        if self.with_stiffness:
            measures += f", stiffness x {stiffness:.2g}"
        return Scenario(f"{name} ({measures})", 1.0, changes)
