"""Inputs that drive several forces, such as one source of pressure for all fingers of a glove."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from flexor.model.schema.checks import check_known
from flexor.model.units import Dimension
from flexor.model.validation import field_error, first_repeated

if TYPE_CHECKING:
    from flexor.model.schema.model_file import ModelFile


def own_inputs(file: ModelFile) -> dict[str, Dimension]:
    """Return the dimension of the load of each force that has one, by its name."""
    found = {name: each.loads for name, each in file.actuators.items()}
    found |= {name: each.load for name, each in file.tendons.items() if each.load is not None}
    found |= {name: each.load for name, each in file.wrenches.items() if each.input}
    return found | {name: each.load for name, each in file.ties.items() if each.drive is not None}


def check_inputs(file: ModelFile) -> None:
    """Check that shared inputs drive forces with loads of one kind, each force by one input."""
    own = own_inputs(file)
    driven_by: dict[str, str] = {}
    for name, drives in file.inputs.items():
        path = f"inputs.{name}"
        if (twice := first_repeated(drives)) is not None:
            raise field_error(f'contains "{twice}" twice', path)
        for force in drives:
            check_known(force, "input", own, path)
            if force in driven_by:
                tail = f'contains "{force}", which inputs.{driven_by[force]} drives: a force has '
                raise field_error(f"{tail}one input", path)
            driven_by[force] = name
            each = file.actuators.get(force)
            if each is not None and each.loads is not each.applied:
                tail = f'contains "{force}", whose {each.loads.noun} is controlled: a shared input '
                raise field_error(f"{tail}is a {each.applied.noun}", path)
            if own[force] != own[drives[0]]:
                kinds = f"{own[drives[0]].name} and {own[force].name}"
                tail = f'drives "{drives[0]}" and "{force}", whose loads are {kinds}'
                raise field_error(tail, path)


def inputs_of(file: ModelFile) -> dict[str, str]:
    """Return the name of the input of each force that has a load."""
    shared = {force: name for name, drives in file.inputs.items() for force in drives}
    return {force: shared.get(force, force) for force in own_inputs(file)}


def dimensions(file: ModelFile) -> Mapping[str, Dimension]:
    """Return the dimension of the load of each input, by its name."""
    of, own = inputs_of(file), own_inputs(file)
    return {name: own[force] for force, name in of.items()}
