"""Materials of sections."""

from __future__ import annotations

import math
from collections.abc import Mapping
from functools import cached_property
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field, model_validator

from flexor import materials
from flexor.errors import InputError
from flexor.materials.laws import engine_name
from flexor.model import units
from flexor.model.schema.table import Choice, Number, PositiveNumber, Table, Text
from flexor.model.units import Density, Modulus, PositiveModulus
from flexor.model.validation import describe, field_error


def _a_list(example: str) -> BeforeValidator:
    def check(value: object) -> object:
        if value is not None and not isinstance(value, (list, tuple)):
            raise field_error(f"is {describe(value)}: write a list, such as {example}")
        return value

    return BeforeValidator(check)


class Material(Table):
    """A constitutive law with its constants; see `flexor.materials.laws`.

    With ``library``, keys that are not given are those of that material of the library.
    """

    library: Text | None = None
    kind: Annotated[
        Literal["linear", "neo-hookean", "mooney-rivlin", "yeoh", "ogden"],
        Choice(*materials.KINDS),
    ]
    young_modulus: PositiveModulus | None = None
    poisson_ratio: Annotated[Number, Field(gt=-1.0, le=0.5)] | None = None
    shear_modulus: PositiveModulus | None = None
    c10: Modulus | None = None
    c01: Modulus | None = None
    c1: Modulus | None = None
    c2: Modulus | None = None
    c3: Modulus | None = None
    mu: Annotated[tuple[Modulus, ...], Field(min_length=1), _a_list('["0.2 MPa"]')] | None = None
    alpha: Annotated[tuple[Number, ...], Field(min_length=1), _a_list("[2.5]")] | None = None
    winding: Annotated[Literal["none", "hoop"], Choice("none", "hoop")] = "none"
    density: Density = units.DENSITY.si(0.0)
    strain_limit: PositiveNumber | None = None
    stress_limit: PositiveModulus | None = None

    @model_validator(mode="before")
    @classmethod
    def _complete(cls, data: object) -> object:
        """Take keys that are not given from the library."""
        if not isinstance(data, Mapping) or not isinstance(data.get("library"), str):
            return data
        try:
            found = materials.find(data["library"])
        except InputError as error:
            raise field_error(f"refers to the {str(error).rstrip('.')}", path="library") from None
        kind = data.get("kind", found.kind)
        if kind != found.kind:
            tail = f'is {describe(kind)}, but "{found.name}" of the library is {found.kind}'
            raise field_error(tail, path="kind")
        _check_constants(found.kind, data)
        return {**_table(found), **data}

    @model_validator(mode="before")
    @classmethod
    def _check_names(cls, data: object) -> object:
        """Check that constants are of the kind, before what they are, which may say less."""
        kind = data.get("kind") if isinstance(data, Mapping) else None
        if not (isinstance(data, Mapping) and isinstance(kind, str) and kind in materials.KINDS):
            return data
        _check_constants(kind, data)
        return data

    @model_validator(mode="after")
    def _check(self) -> Material:
        for key, default in materials.KINDS[self.kind].items():
            if default is None and getattr(self, key) is None:
                raise field_error(f"is missing: a {self.kind} material needs it", path=key)
        try:
            self.material("")
        except InputError as error:
            raise field_error(f"cannot be used: {str(error).rstrip('.')}") from None
        return self

    def _constants(self) -> dict[str, Any]:
        names = dict.fromkeys(key for kind in materials.KINDS.values() for key in kind)
        return {key: value for key in names if (value := getattr(self, key)) is not None}

    def material(self, name: str) -> materials.Material:
        """Return the material.

        Parameters
        ----------
        name
            Its name, for messages.
        """
        found = self._named.get(name)
        if found is None:
            found = materials.Material(
                name=name,
                kind=self.kind,
                constants=self._constants(),
                winding=self.winding,
                density=float(self.density),
            )
            self._named[name] = found
        return found

    @cached_property
    def _named(self) -> dict[str, materials.Material]:
        return {}

    def lower(self, name: str) -> dict[str, Any]:
        """Describe the material to the engine.

        Parameters
        ----------
        name
            Its name.
        """
        material = self.material(name)
        return {
            "name": name,
            "law": engine_name(self.kind),
            "constants": material.numbers,
            "wound": self.winding == "hoop",
        }


def _check_constants(kind: str, data: Mapping[str, Any]) -> None:
    own = materials.KINDS[kind]
    for key in dict.fromkeys(key for each in materials.KINDS.values() for key in each):
        if data.get(key) is not None and key not in own:
            tail = f"is not a constant of a {kind} material: it has {', '.join(own)}"
            raise field_error(tail, key)


def own_keys(table: Mapping[str, Any]) -> dict[str, Any]:
    """Return a table of a material without the keys that are as in its material of the library."""
    try:
        there = _table(materials.find(str(table.get("library"))))
    except InputError:
        return dict(table)

    def plain(value: Any) -> Any:
        return list(value) if isinstance(value, tuple) else value

    return {
        key: value
        for key, value in table.items()
        if key not in there or plain(value) != plain(there[key])
    }


def _table(material: materials.Material) -> dict[str, Any]:
    """Return a material of the library as written in a model file."""

    def text(key: str, value: Any) -> Any:
        if isinstance(value, tuple):
            return [text(key, each) for each in value]
        return float(value) if key in ("poisson_ratio", "alpha") else f"{float(value)!r} Pa"

    table = {key: text(key, value) for key, value in material.constants.items()}
    limit = material.strain_limit
    if material.stretch_range is not None:
        # Beyond what was measured the law is extrapolated.
        limit = min(limit, material.stretch_range[1] - 1.0)
    if math.isfinite(limit):
        table["strain_limit"] = limit
    if math.isfinite(material.stress_limit):
        table["stress_limit"] = f"{material.stress_limit!r} Pa"
    return {"kind": material.kind, "density": f"{material.density!r} kg/m^3", **table}
