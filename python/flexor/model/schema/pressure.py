"""Pressure in the cavity of a rod."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field, model_validator

from flexor.model import units
from flexor.model.schema.body import Rod
from flexor.model.schema.body_system import BodySystem
from flexor.model.schema.cavity import lower_cavity
from flexor.model.schema.checks import check_known, check_rod
from flexor.model.schema.force import Force
from flexor.model.schema.section import cavities_of
from flexor.model.schema.table import Choice, Name, Number, Text
from flexor.model.validation import field_error

Fraction = Annotated[Number, Field(ge=0.0, le=1.0)]


class Pressure(Force):
    """A pressure in a cavity of a rod, from ``span[0]`` to ``span[1]`` of its length.

    With ``control = "volume"`` its loads are changes of the volume of the cavity from the reference
    state.
    """

    description: ClassVar[str] = "pressures"

    kind: Literal["pressure"]
    rod: Name
    cavity: Text | None = None
    span: tuple[Fraction, Fraction] = (0.0, 1.0)
    control: Annotated[Literal["pressure", "volume"], Choice("pressure", "volume")] = "pressure"

    @property
    def loads(self) -> units.Dimension:
        """Dimension of its loads."""
        return self.applied if self.control == "pressure" else units.VOLUME

    @property
    def applied(self) -> units.Dimension:
        """Dimension of the pressure with which it acts."""
        return units.PRESSURE

    @model_validator(mode="after")
    def _check(self) -> Pressure:
        if not self.span[0] < self.span[1]:
            raise field_error(f"is {list(self.span)}: it must end after its begin", path="span")
        return self

    def check(self, path: str, system: BodySystem) -> None:
        """Check that the rod has the cavity."""
        check_rod(self.rod, system.bodies, f"{path}.rod")
        found = _cavities(system.rod(self.rod))
        if not found:
            tail = f'is "{self.rod}", whose section has no cavity: give it one, such as a tube'
            raise field_error(tail, path=f"{path}.rod")
        if self.cavity is not None:
            check_known(self.cavity, "cavity", dict.fromkeys(found), f"{path}.cavity")
        elif len(found) > 1:
            raise field_error(f"is missing: expected one of {', '.join(found)}", f"{path}.cavity")

    def lower(self, name: str, system: BodySystem) -> dict[str, Any]:
        """Describe the pressure to the engine."""
        rod = system.rod(self.rod)
        cavity = self.cavity or _cavities(rod)[0]
        lowered = lower_cavity(rod, cavity, self.span, system.materials)
        return {"name": name, "rod": self.rod, **lowered}


def _cavities(rod: Rod) -> list[str]:
    """List the names of the cavities of all sections of a rod."""
    return list(dict.fromkeys(name for piece in rod.pieces for name in cavities_of(piece)))
