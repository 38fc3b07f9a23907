"""Design variables that are loads: the largest load of an input, its others in proportion."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from flexor.arrays import Array
from flexor.errors import InputError, unknown
from flexor.model.units import LOAD_FACTOR

if TYPE_CHECKING:
    from flexor.model.schema import ModelFile
    from flexor.model.structure import Structure

# Fields of a single input, with the one that has its step; and of several, by their names.
_SINGLE = {"evaluation.pressure": "pressure_step", "evaluation.force": "step"}
_NAMED = "evaluation.loads."


@dataclass(frozen=True)
class LoadVariable:
    """The largest load of an input.

    Attributes
    ----------
    name : str
        The input.
    start : float
        Its largest load in the model file, with its sign, SI.
    unit : str
        Its SI unit.
    field : str
        The field of the model file.
    shape : tuple of float
        All its loads there, by the largest.
    """

    name: str
    start: float
    unit: str
    field: str
    shape: tuple[float, ...]

    def changes(self, value: float) -> dict[str, object]:
        """Return the changes of a model file that give it another value."""
        step = _SINGLE.get(self.field)
        if step is None:
            texts = (f"{load * value!r} {self.unit}".rstrip() for load in self.shape)
            return {self.field: ", ".join(texts)}
        sizes = {self.field: value, f"evaluation.{step}": value / (len(self.shape) - 1)}
        return {key: f"{size!r} {self.unit}" for key, size in sizes.items()}


def load_variable(label: str, model: Structure) -> LoadVariable | None:
    """Return the load that a field is; None if it is another field.

    InputError if there is no such input, or all its loads are zero.
    """
    field = label.strip()
    evaluation = model.file.evaluation
    if field.startswith(_NAMED):
        name = field.removeprefix(_NAMED)
        if name not in model.inputs:
            raise unknown("input", name, model.inputs)
        if not evaluation.loads and len(model.inputs) == 1:
            single = "pressure" if model.pressures else "force"
            raise InputError(f"{field}: its loads are those of evaluation.{single}: vary that.")
        if name not in evaluation.loads:
            raise unknown("input with evaluation.loads", name, evaluation.loads)
    elif field in _SINGLE and len(model.inputs) == 1 and not evaluation.loads:
        name = model.inputs[0]
        if (field == "evaluation.pressure") != bool(model.pressures):
            return None
    else:
        return None
    column = model.evaluation_loads[:, model.inputs.index(name)]
    largest = largest_of(column, name)
    unit = model.input_dimensions[name].unit
    return LoadVariable(name, largest, unit, field, tuple((column / largest).tolist()))


def largest_of(column: Array, name: str) -> float:
    """Return the largest load of an input, with its sign; InputError if all are zero."""
    largest = float(column[np.abs(column).argmax()])
    if largest == 0.0:
        raise InputError(f'the loads of "{name}" cannot be varied: all of them are zero.')
    return largest


def check_force(label: str, keys: tuple[str, ...], file: ModelFile, source: str) -> None:
    """Refuse components of a wrench that its load multiplies while its length makes that a force.

    InputError says so.
    """
    if keys[0] != "wrenches" or keys[2] not in ("force", "moment"):
        return
    wrench = file.wrenches[keys[1]]
    if wrench.input and wrench.load is not LOAD_FACTOR:
        raise InputError(
            f'{source}: "{label}" cannot be varied: the loads of "{keys[1]}" are in '
            f"{wrench.load.unit} because its {keys[2]} has length one; vary its loads, "
            f'"evaluation.loads.{keys[1]}".'
        )
