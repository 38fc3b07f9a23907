"""The engine's parameters by lowering the model file with other values of some fields."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from flexor import _engine
from flexor.arrays import Array
from flexor.design.fields import replaced, value_of
from flexor.errors import InputError
from flexor.model.lowering import lower
from flexor.model.schema import ModelFile
from flexor.model.schema.friction import coefficient
from flexor.model.schema.strap import Loop
from flexor.model.structure import Structure

Keys = tuple[str, ...]


class Lowered:
    """The engine's parameters as columns, and beyond them what rest lengths of straps follow from.

    A rest length itself may have kinks, as where a loop reaches the end of its link, and is no
    polynomial even where its ends are.

    Attributes
    ----------
    straps : list of (int, slice, int)
        For each strap the column of its rest length, those of its ends and that of the offset which
        is to be added to their distance.
    ranges : list of (int, int)
        Columns that belong together: those of each parameter, and of places and sizes of each end.
    """

    def __init__(
        self, model: Structure, fields: tuple[Keys, ...], names: Sequence[str] = ()
    ) -> None:
        self._model, self._fields, self._names = model, fields, tuple(names)
        self._slots = model.engine.slots
        self.ranges = [*self._slots.values()]
        self.straps: list[tuple[int, slice, int]] = []
        self.size = column = model.parameters.size
        for name, strap in model.file.straps.items():
            # The place of an end, then sizes and the offset.
            sizes = 4 if isinstance(strap.to, Loop) else 1
            self.ranges.append((column, column + 3))
            self.ranges += [(column + 3 + i, column + 4 + i) for i in range(sizes)]
            stop = column + 2 + sizes
            self.straps.append((self._slots[f"{name}.rest_length"][0], slice(column, stop), stop))
            column = stop + 1

    @property
    def own(self) -> Array:
        """The engine's parameters of the model itself."""
        return self._model.parameters

    def parameters(self, x: Array, name: str = "") -> Array:
        """Return the engine's parameters for values (k,) of the fields, those of `name` varied."""
        return self._lowered(x, name)

    def at(self, x: Array, name: str = "") -> Array:
        """Return all columns, with zero in place of rest lengths."""
        found = self._lowered(x, name)
        found[[rest for rest, _, _ in self.straps]] = 0.0
        return np.concatenate([found, self.of_straps(x)])

    def of_straps(self, x: Array) -> Array:
        """Return the columns of straps, which takes much less than all that a file lowers to."""
        return self._of_straps(self._file(x))

    def name(self, column: int) -> str:
        """Return which parameter a column is."""
        for name, (start, stop) in self._slots.items():
            if start <= column < stop:
                return name
        for rest, ends, offset in self.straps:
            if ends.start <= column <= offset:
                return self.name(rest)
        raise IndexError(column)

    def _of_straps(self, file: ModelFile) -> Array:
        found: list[float] = []
        for strap in file.straps.values():
            offset = float(strap.slack) - float(strap.pretension) / strap.constant
            if isinstance(strap.to, Loop):
                offset -= strap.thickness(file)
            found += [*strap.ends(file).tolist(), offset]
        return np.array(found)

    def _file(self, x: Array) -> ModelFile:
        return replaced(self._model.file, dict(zip(self._fields, x.tolist(), strict=True)))

    def _lowered(self, x: Array, name: str) -> Array:
        file = self._file(x)
        try:
            engine = _engine_of(file, self._model)
        except InputError:
            raise
        except ValueError as error:
            said = _quoted(self._impossible(x, name))
            raise InputError(
                f"{said} cannot have all values between the bounds: {error}."
            ) from None
        if not engine.has_structure_of(self._model.engine):
            raise InputError(self._why_other(x, name))
        return engine.parameters.copy()

    def _impossible(self, x: Array, name: str) -> Sequence[str]:
        """Return the fields whose value, of (k,), makes no model by itself; all if none does."""
        alone = [i for i, label in enumerate(self._names) if name in ("", label)]
        guilty = [self._names[i] for i in alone if not self._makes_model(i, x[i])]
        return guilty or [self._names[i] for i in alone]

    def _makes_model(self, i: int, value: float) -> bool:
        try:
            _engine_of(replaced(self._model.file, {self._fields[i]: value}), self._model)
        except ValueError:
            return False
        return True

    def _why_other(self, x: Array, name: str) -> str:
        """Return why values (k,) of the fields make another model, naming those that do."""
        own = np.array([float(value_of(keys, self._model.file)) for keys in self._fields])
        alone = [i for i, label in enumerate(self._names) if name in ("", label)]
        guilty = [i for i in alone if self._is_other(i, own[i], x[i])]
        # What the least change is too much for is no parameter of the engine.
        fixed = [i for i in guilty if self._is_other(i, own[i], own[i] + 1e-6 * (x[i] - own[i]))]
        absent = [i for i in fixed if own[i] == 0.0 and self._is_made(i, x[i])]
        said = _quoted([self._names[i] for i in absent or fixed or guilty or alone])
        if absent:
            are = "they are" if len(absent) > 1 else "it is"
            return (
                f"{said} cannot be varied: {are} zero in the file, and the model is made without; "
                "give the file another value, such as by --set."
            )
        if fixed:
            least = (
                f"{'they are' if len(fixed) > 1 else 'it is'} fixed when the model is made; "
                "give values to choose from, such as by --choose"
            )
            return f"{said} cannot be varied: {least}."
        return (
            f"{said} cannot be varied: within the bounds that changes what the model is made of, "
            "such as a floor that is no thicker than its layer; narrow the bounds, or give values "
            "to choose from, such as by --choose."
        )

    def _is_made(self, i: int, value: float) -> bool:
        """Return whether the model that another value of one field makes can have others yet."""
        files = [
            replaced(self._model.file, {self._fields[i]: share * value}) for share in (1.0, 0.999)
        ]
        try:
            made, other = (_engine.Model(json.dumps(lower(file))) for file in files)
        except ValueError:
            return False
        return other.has_structure_of(made)

    def _is_other(self, i: int, own: float, value: float) -> bool:
        """Return whether another value of one field makes another model, or none."""
        return value != own and parameters_with(self._model, {self._fields[i]: value}) is None


def _quoted(names: Sequence[str]) -> str:
    return ", ".join(f'"{name}"' for name in names)


def parameters_with(model: Structure, changes: Mapping[Keys, float]) -> Array | None:
    """Return the engine's parameters (P,) of a model with other values of some fields, SI.

    None if it is then no model, or one that is made of other things.

    Parameters
    ----------
    model
        The model.
    changes
        By the keys of a field; see `flexor.design.fields`.
    """
    try:
        engine = _engine_of(replaced(model.file, changes), model)
    except ValueError:  # of the file, too: an `InputError` is one
        return None
    return engine.parameters.copy() if engine.has_structure_of(model.engine) else None


def _engine_of(file: ModelFile, model: Structure) -> _engine.Model:
    """Return the engine of a changed file, with what is made once for the model itself.

    ValueError if there is no such model, InputError if the file says so.
    """
    try:
        described = lower(file)
    except ArithmeticError:
        raise ValueError("a number is too large or too small to compute with") from None
    _keep(described, model.description, file)
    return _engine.Model(json.dumps(described))


def _keep(described: dict[str, Any], own: Mapping[str, Any], file: ModelFile) -> None:
    """Keep what is made once for the model.

    Shares of the tip, which rods touch themselves, and that there is gravity, friction or a moment,
    also where a design has none.
    """
    for key, stated in (("spheres", file.spheres), ("contacts", file.contacts)):
        mine, new = own.get(key, []), {each["name"]: each for each in described.get(key, [])}
        if key in described or mine:
            described[key] = [
                new[each["name"]] if each["name"] in stated else each for each in mine
            ]
    rubbing = {each["name"]: each for each in described.get("frictions", [])}
    if frictions := own.get("frictions"):
        mine = {each["name"]: each for each in frictions}
        kept = {
            name: {**each, "coefficient": coefficient(name, file)} for name, each in mine.items()
        }
        rubs = ("contacts", "foundations", "obstacles")
        present = {each["name"] for key in rubs for each in described.get(key, [])}
        new = {name: each for name, each in rubbing.items() if name in mine or name in present}
        described["frictions"] = list({**kept, **new}.values())
    if own.get("weighs") or any(own["gravity"]):
        described["weighs"] = True
    for new, old in _pairs("wrenches", described, own):
        new["turns"] = bool(old.get("turns")) or any(old["moment"])
    for new, old in _pairs("tendons", described, own):
        if "friction" in old:
            new.setdefault("friction", {**old["friction"], "coefficient": 0.0})
    for new, old in _pairs("foundations", described, own):
        new["tip"], new["alignment"] = old["tip"], old["alignment"]


def _pairs(
    key: str, described: Mapping[str, Any], own: Mapping[str, Any]
) -> Iterator[tuple[dict[str, Any], Mapping[str, Any]]]:
    """Yield the entries of a list with those of the model itself."""
    return zip(described.get(key, ()), own.get(key, ()), strict=False)
