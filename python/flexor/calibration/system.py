"""A model as a function of its constants: by the engine's parameters if possible, else rebuilt."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from flexor.arrays import Array
from flexor.calibration.constants import Constant, full
from flexor.errors import InputError
from flexor.model import Model, ModelFile, load

_EXACT = 1e-9


@dataclass(frozen=True, eq=False)
class System:
    """A model as a function of all constants, of which some may set no field of it."""

    name: str
    file: ModelFile
    constants: tuple[Constant, ...]
    source: str  # the targets file, for messages

    def model(self, x: Sequence[float] | Array) -> Model:
        """Build the model with constants x (c,), SI."""
        changes: dict[str, object] = {}
        for constant, value in zip(self.constants, x, strict=True):
            for field in self._fields(constant):
                changes[field] = constant.unit.exact(float(value))
        try:
            return load(self.file, changes=changes)
        except InputError as error:
            raise InputError(f"{self.source}: {str(error).rstrip('.')}.") from None

    def check_ranges(self) -> None:
        """Demand that the model can be built at both ends of the ranges."""
        for end in ("low", "high"):
            self.model([getattr(constant, end) for constant in self.constants])

    def fields(self) -> dict[str, Constant]:
        """Fields of this model that constants set."""
        return {field: constant for constant in self.constants for field in self._fields(constant)}

    @cached_property
    def middle(self) -> Array:
        """Constants in the middle of their ranges, (c,)."""
        return np.array([float(c.value(np.array(0.5))) for c in self.constants])

    @cached_property
    def reference(self) -> Model:
        """The model with the constants of `middle`."""
        return self.model(self.middle)

    @cached_property
    def rates(self) -> Array | None:
        """Derivative of the engine's parameters by the constants, (P, c); None if not constant.

        It is None when a constant changes something that is not a parameter of the engine, or
        changes one in another way than proportionally; the model is then built for each value.
        """
        corner, columns = self.middle.copy(), []
        for i, moved in enumerate(self._moved):
            change = np.zeros_like(self.reference.parameters)
            if moved is not None:
                if not moved.engine.has_structure_of(self.reference.engine):
                    return None
                corner[i] = self.constants[i].high
                change = moved.parameters - self.reference.parameters
                change /= corner[i] - self.middle[i]
            columns.append(change)
        rates = np.stack(columns, axis=1)
        expected = self.reference.parameters + rates @ (corner - self.middle)
        exact = self.model(corner).parameters
        if np.any(np.abs(expected - exact) > _EXACT * np.abs(exact) + 1e-300):
            return None
        return rates

    def mover(self, slot: str) -> str | None:
        """Return the name of a constant that moves a parameter of the engine, if one does."""
        start, stop = self.reference.engine.slots[slot]
        for constant, moved in zip(self.constants, self._moved, strict=True):
            if moved is not None and np.any(
                moved.parameters[start:stop] != self.reference.parameters[start:stop]
            ):
                return constant.name
        return None

    @cached_property
    def _moved(self) -> tuple[Model | None, ...]:
        """For each constant the model with it at the end of its range; None if it has no effect."""
        moved: list[Model | None] = []
        for i, constant in enumerate(self.constants):
            other = self.middle.copy()
            other[i] = constant.high
            moved.append(self.model(other) if self._fields(constant) else None)
        return tuple(moved)

    def _fields(self, constant: Constant) -> list[str]:
        found = (full(field, self.file) for field in constant.fields)
        return [field for field in found if field is not None]
