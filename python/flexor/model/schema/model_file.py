"""The top level of a model file."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from functools import cached_property
from typing import Annotated, Any

from pydantic import BeforeValidator, Discriminator, Field, Tag, model_validator

from flexor.model.schema.actuator import Actuator
from flexor.model.schema.body import Rod
from flexor.model.schema.body_system import BodySystem
from flexor.model.schema.checks import check_known, check_names, check_rod, check_tree
from flexor.model.schema.contact import Contact
from flexor.model.schema.coupling import Coupling
from flexor.model.schema.design import Design, Evaluation
from flexor.model.schema.force import Force
from flexor.model.schema.foundation import skin_materials, touching
from flexor.model.schema.planar import check_planar_body, in_plane
from flexor.model.schema.population import Population
from flexor.model.schema.pressure import Pressure
from flexor.model.schema.section_geometry import check_section
from flexor.model.schema.shared_input import check_inputs
from flexor.model.schema.solid import AnyObstacle
from flexor.model.schema.spring import Spring
from flexor.model.schema.strap import Strap
from flexor.model.schema.table import Name, Number
from flexor.model.schema.tendon import AnyTendon
from flexor.model.schema.tie import Tie
from flexor.model.schema.torque import Torque
from flexor.model.schema.wrap import Wrap
from flexor.model.schema.wrench import Wrench
from flexor.model.validation import describe, field_error

# Limits of size, so that a short file cannot ask for unbounded time and memory.
MAX_BODIES = 2_000
MAX_POINTS = 200_000
MAX_PAIRS = 2_000_000
MAX_STRAINS = 10_000  # of which the tangent takes 0.8 GB

StartValue = str | float


def _value(value: object) -> object:
    if isinstance(value, bool) or not isinstance(value, (str, int, float)):
        raise field_error(f'is {describe(value)}: write a coordinate, such as "20 deg"')
    return value


def _entry(value: object) -> object:
    return value if isinstance(value, dict) else _value(value)


_Value = Annotated[StartValue, BeforeValidator(_value)]
StartTable = dict[Name, Annotated[StartValue | dict[Name, _Value], BeforeValidator(_entry)]]


def _kind(value: Any) -> str:
    kind = value.get("kind") if isinstance(value, Mapping) else getattr(value, "kind", None)
    return "pressure" if kind == "pressure" else "thread"


AnyActuator = Annotated[
    Annotated[Actuator, Tag("thread")] | Annotated[Pressure, Tag("pressure")],
    Discriminator(_kind),
]


class ModelFile(BodySystem):
    """A model file with one of its variants applied, or none.

    ``variants`` holds those that can be applied, ``use`` the name of the one whose values are in
    the other tables, ``constants`` sets of constants as written; see `flexor.model.variants`.
    """

    contacts: dict[Name, Contact] = Field(default_factory=dict)
    obstacles: dict[Name, AnyObstacle] = Field(default_factory=dict)
    actuators: dict[Name, AnyActuator] = Field(default_factory=dict)
    torques: dict[Name, Torque] = Field(default_factory=dict)
    couplings: dict[Name, Coupling] = Field(default_factory=dict)
    springs: dict[Name, Spring] = Field(default_factory=dict)
    straps: dict[Name, Strap] = Field(default_factory=dict)
    tendons: dict[Name, AnyTendon] = Field(default_factory=dict)
    wraps: dict[Name, Wrap] = Field(default_factory=dict)
    wrenches: dict[Name, Wrench] = Field(default_factory=dict)
    ties: dict[Name, Tie] = Field(default_factory=dict)
    inputs: dict[Name, Annotated[tuple[Name, ...], Field(min_length=1)]] = Field(
        default_factory=dict
    )
    design: Design | None = None
    population: Population | None = None
    evaluation: Evaluation = Evaluation()
    start: StartTable = Field(default_factory=dict)
    solver: dict[Name, Number] = Field(default_factory=dict)
    constants: dict[Name, dict[str, Any]] = Field(default_factory=dict)
    variants: dict[Name, dict[str, Any]] = Field(default_factory=dict)
    use: Name | None = None

    @cached_property
    def pressing(self) -> dict[str, float]:
        """Half of the width of the narrowest obstacle [m] on which each body's skin presses."""
        found: dict[str, float] = {}
        for name, obstacle in self.obstacles.items():
            for body in obstacle.skins(name, self):
                found[body] = min(found.get(body, math.inf), obstacle.half_width)
        return found

    @classmethod
    def known_keys(cls) -> tuple[str, ...]:
        """Return the keys of a file: also ``parts``, whose entries it has in their place."""
        return (*super().known_keys(), "parts")

    @model_validator(mode="after")
    def _check(self) -> ModelFile:
        """Check the consistency of the tables."""
        check_names({table: getattr(self, table) for table in self.named_tables()})
        check_tree(self.bodies)
        for name, group in self.spheres.items():
            group.check(f"spheres.{name}", self.bodies)
        for table, name, force in self.forces():
            force.check(f"{table}.{name}", self)
        check_inputs(self)
        if self.design is not None and self.design.rod is not None:
            check_rod(self.design.rod, self.bodies, "design.rod")
        known = skin_materials(self)
        for name, body in self.bodies.items():
            for index, layer in enumerate(body.skin or ()):
                if layer.material is not None:
                    place = f"[{index}]" if len(body.skin or ()) > 1 else ""
                    path = f"bodies.{name}.skin{place}.material"
                    check_known(layer.material, "material", known, path)
        self._check_size()
        for name, body in self.bodies.items():
            if isinstance(body, Rod):
                check_section(body, f"bodies.{name}", self.materials, self.planar)
        if self.planar:
            in_plane(self.gravity, "gravity")
            for name, body in self.bodies.items():
                check_planar_body(body, f"bodies.{name}")
            for table, name, force in self.forces():
                force.check_planar(f"{table}.{name}")
        return self

    def _check_size(self) -> None:
        """Check the numbers of bodies, sample points, strains and pairs of spheres."""
        if len(self.bodies) > MAX_BODIES:
            raise field_error(f"has {len(self.bodies):,} entries: at most {MAX_BODIES:,}", "bodies")
        rods = {name: body for name, body in self.bodies.items() if isinstance(body, Rod)}
        points = sum(rod.sample_count for rod in rods.values())
        points += sum(rods[each.rod].sample_count for each in self.actuators.values())
        if points > MAX_POINTS:
            tail = f"have {points:,} sample points, counted again for each actuator: at most"
            raise field_error(f"{tail} {MAX_POINTS:,}", "bodies")
        strains = sum(
            basis.size(rod.elements) for rod in rods.values() for basis in rod.strain.modes.values()
        )
        if strains > MAX_STRAINS:
            raise field_error(f"have {strains:,} strains: at most {MAX_STRAINS:,}", "bodies")
        counts = {
            name: len(group.points)
            + sum(rods[body].sample_count + 1 if body in rods else 2 for body in group.bodies)
            for name, group in self.spheres.items()
        }
        pairs = sum(
            rods[name].sample_count * len(links)
            for skinned, links in touching(self)
            for name in skinned
        )
        if pairs > MAX_PAIRS:
            tail = f"with a skin have {pairs:,} points that may touch: at most {MAX_PAIRS:,}"
            raise field_error(tail, path="bodies")
        for name, contact in self.contacts.items():
            pairs += counts[contact.first] * counts[contact.second]
            if pairs > MAX_PAIRS:
                tail = f"has too many pairs of spheres: all contacts together at most {MAX_PAIRS:,}"
                raise field_error(tail, path=f"contacts.{name}")

    def forces(self) -> Iterator[tuple[str, str, Force]]:
        """Yield table, name and description of each force, in the order of the fields."""
        return self.entries(Force)  # type: ignore[type-abstract]

    def to_document(self) -> dict[str, Any]:
        """Return the tables as TOML values, with quantities as originally written."""
        document = self.model_dump(exclude_none=True)
        return {key: value for key, value in document.items() if value != {}}

    def to_toml(self) -> str:
        """Serialise the file as TOML that parses to an equal `ModelFile`."""
        import tomli_w

        return tomli_w.dumps(self.to_document())
