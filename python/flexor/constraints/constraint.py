"""A bound that an observable has to keep along the whole path."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Literal

import numpy as np

from flexor.arrays import Array
from flexor.errors import InputError
from flexor.model.derivatives import TIED, Differential
from flexor.model.quantity import parse_quantity
from flexor.model.results import Path, Paths
from flexor.model.structure import Structure
from flexor.observables import Observable, observable

_TEXT = re.compile(
    r"\s*(?P<name>[^<>=]+?)\s*(?P<sense><=|>=)\s*(?P<bound>[^<>=]+?)(?P<end>\s+at\s+end)?\s*"
)


@dataclass(frozen=True)
class Constraint:
    """An observable that must not leave a bound at any load; made by `constraint`.

    Attributes
    ----------
    name : str
        The observable.
    sense : str
        ``"<="`` or ``">="``.
    bound : float
        SI.
    scale : float
        What counts as an excess of one, SI: the bound, or one display unit if that is zero.
    default : str
        What it is called among those that hold by default; empty if it was asked for.
    at_end : bool
        Whether it has to hold at the last load only, where a path may begin beyond the bound.
    """

    name: str
    sense: Literal["<=", ">="]
    bound: float
    scale: float
    default: str = ""
    at_end: bool = False

    def text(self, model: Structure) -> str:
        """Return it as it is written, such as ``"overlap <= 0.5 mm"``."""
        bound = self.observable(model).shown(self.bound, 12)
        return f"{self.name} {self.sense} {bound}{' at end' if self.at_end else ''}"

    def observable(self, model: Structure) -> Observable:
        """Return what it bounds."""
        return observable(self.name, model)

    @property
    def sign(self) -> float:
        """The sense: 1 if larger values are worse, -1 if smaller ones are."""
        return 1.0 if self.sense == "<=" else -1.0

    def worst(self, paths: Paths) -> Array:
        """Return the value nearest to the bound or farthest beyond it along each path, (n,).

        NaN where the observable has no value at any load.
        """
        values = self._at_loads(self.observable(paths.model).values(paths))
        reduce = np.fmax if self.sense == "<=" else np.fmin
        return np.asarray(reduce.reduce(values, axis=1))

    def differential(self, paths: Paths) -> Differential:
        """Return the first-order change of `worst`; InputError if the observable has none.

        It is that at the worst step, and tied where the value at another step equals it.
        """
        found = self.observable(paths.model)
        values = self._at_loads(found.values(paths))
        ranked = values if self.sense == "<=" else -values
        ranked = np.where(np.isnan(ranked), -np.inf, ranked)
        steps = ranked.argmax(axis=1)
        change = found.differential(paths, steps)
        # What does not depend on the state is the same at all steps.
        if not change.parts:
            return change
        top = ranked[np.arange(len(ranked)), steps][:, None]
        with np.errstate(invalid="ignore"):
            near = np.isfinite(ranked) & (np.abs(ranked - top) <= TIED * np.abs(top))
        near &= top != 0.0
        return change + Differential(tied=near.sum(axis=1) > 1)

    def excess(self, worst: Array) -> Array:
        """Return how far values are beyond the bound, in units of `scale`; not above 0 is kept."""
        beyond = worst - self.bound if self.sense == "<=" else self.bound - worst
        # What does not exist, such as a strain without fibres, breaks nothing.
        return np.where(np.isnan(worst), -1.0, beyond / self.scale)

    def _at_loads(self, values: Array) -> Array:
        """Leave out the values (n, s) at loads where it does not have to hold, as NaN."""
        if not self.at_end:
            return values
        kept = np.full(values.shape, np.nan)
        kept[:, -1] = values[:, -1]
        return kept

    def place(self, path: Path, values: Array | None = None) -> str:
        """Return where along a path and on which body the worst value is, for display.

        Its observable's values along the path (s,) may be given if they are known.
        """
        found = self.observable(path.model)
        along = found.values(path.as_batch) if values is None else np.asarray(values)[None]
        values = self._at_loads(along)[0]
        if np.isnan(values).all():
            return ""
        step = int(np.nanargmax(values) if self.sense == "<=" else np.nanargmin(values))
        load = path.model.show_loads(path.loads[step])
        where = found.place(path[step]) if found.place is not None else ""
        return f"{where} at {load}" if where else f"at {load}"


def constraint(text: str, model: Structure, default: str = "") -> Constraint:
    """Read a constraint.

    Parameters
    ----------
    text
        Such as ``"overlap <= 0.5 mm"``, ``"min-stretch >= 0.2"`` or, at the last load only,
        ``"bending >= 60 deg at end"``.
    model
        The model.
    default
        What it is called among those that hold by default.

    Raises
    ------
    InputError
        If it cannot be read, the model has no such observable, or the bound has another unit.
    """
    match = _TEXT.fullmatch(text) if isinstance(text, str) else None
    if match is None:
        raise InputError(
            f'constraint "{text}": write an observable, <= or >=, and a bound, such as '
            '"overlap <= 0.5 mm".'
        )
    found, bound = observable(match["name"], model), match["bound"]
    place = f'constraint "{text}": the bound'
    value: object = bound
    if found.dimension is None:
        try:
            value = float(bound)
        except ValueError:
            value = bound
    number, _ = parse_quantity(value, found.dimension, place)
    scale = abs(number) or found.unit[0]
    sense: Literal["<=", ">="] = "<=" if match["sense"] == "<=" else ">="
    return Constraint(found.name, sense, number, scale, default, bool(match["end"]))
