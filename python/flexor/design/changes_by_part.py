"""The engine's parameters for other values of a field, found on the component that has it."""

from __future__ import annotations

from flexor.arrays import Array
from flexor.design.lowered import parameters_with
from flexor.model.restricted import Entries, Restricted, entries_of_components, restricted
from flexor.model.structure import Structure

Keys = tuple[str, ...]


class ChangesByPart:
    """The parameters of a model with one field changed at a time.

    A field of one component is changed in the model of that alone, which is faster by the number of
    components.
    """

    def __init__(self, model: Structure) -> None:
        self._model = model
        self._entries = entries_of_components(model)
        self._parts: dict[int, Restricted | None] = {}

    def parameters_with(self, keys: Keys, value: float) -> Array | None:
        """Return the engine's parameters (P,); see `flexor.design.lowered.parameters_with`.

        Parameters
        ----------
        keys
            Of the field; see `flexor.design.fields`.
        value
            Its value, SI.
        """
        part = self._part_of(keys)
        if part is None:
            return parameters_with(self._model, {keys: value})
        found = parameters_with(part.model, {keys: value})
        if found is None:
            return None
        parameters = self._model.parameters.copy()
        parameters[part.slots] = found
        return parameters

    def _part_of(self, keys: Keys) -> Restricted | None:
        """Return the component that alone has a field; None if there is none."""
        table, name = keys[:2] if len(keys) > 1 else (keys[0], "")
        owners = [i for i, each in enumerate(self._entries) if _has(each, table, name)]
        if len(owners) != 1:
            return None
        (owner,) = owners
        if owner not in self._parts:
            self._parts[owner] = restricted(self._model, self._entries[owner])
        return self._parts[owner]


def _has(entries: Entries, table: str, name: str) -> bool:
    return name in entries.get(table, ())
