"""Tendons across bodies: cables, springs and muscles."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Mapping
from typing import Annotated, Any, ClassVar, Literal

from pydantic import BeforeValidator, Discriminator, Field, Tag, model_validator

from flexor.model.schema.body_system import BodySystem
from flexor.model.schema.checks import check_known
from flexor.model.schema.force import Force
from flexor.model.schema.points import Anchor, Attachment, Ground
from flexor.model.schema.table import Name, NonNegativeNumber, PositiveNumber, Table, one_of
from flexor.model.schema.wrap import Wrap
from flexor.model.units import (
    ACTIVATION,
    FORCE,
    Dimension,
    Length,
    NonNegativeForce,
    PositiveLength,
    PositiveStiffness,
)
from flexor.model.validation import field_error


class Over(Table):
    """A wrap that a tendon may touch between the points before and after.

    ``side`` is a point on the side on which it passes; if it is in the wrap, the tendon passes
    inside.
    """

    wrap: Name
    side: Anchor | None = None


class Branch(Table):
    """The beginning of a further branch, whose length counts by one part in ``branch``."""

    branch: PositiveNumber


def _form(value: object) -> str:
    if isinstance(value, Mapping):
        return next((key for key in ("wrap", "branch", "world") if key in value), "body")
    forms = ((Over, "wrap"), (Branch, "branch"), (Ground, "world"))
    return next((name for form, name in forms if isinstance(value, form)), "body")


Stage = Annotated[
    Annotated[Attachment, Tag("body")]
    | Annotated[Ground, Tag("world")]
    | Annotated[Over, Tag("wrap")]
    | Annotated[Branch, Tag("branch")],
    Discriminator(_form),
]


class Thelen(Table):
    """Force and length of muscle fibres by Thelen (2003): a Gaussian, and his equation (3)."""

    kind: Literal["thelen"] = "thelen"
    width: PositiveNumber = 0.45
    passive_shape: PositiveNumber = 5.0
    passive_strain: PositiveNumber = 0.6

    def lower(self) -> dict[str, Any]:
        """Describe the curve to the engine."""
        return {"thelen": self.model_dump(exclude={"kind"})}


class Parabolic(Table):
    """Force and length of muscle fibres as in the muscle of the simulator MuJoCo."""

    kind: Literal["parabolic"]
    lower_length: PositiveNumber = 0.5
    upper_length: PositiveNumber = 1.6
    passive: NonNegativeNumber = 1.3

    @model_validator(mode="after")
    def _check(self) -> Parabolic:
        if not self.lower_length < 1.0:
            raise field_error(f"is {self.lower_length}: it must be below 1", path="lower_length")
        if not self.upper_length > 1.0:
            raise field_error(f"is {self.upper_length}: it must be above 1", path="upper_length")
        return self

    def lower(self) -> dict[str, Any]:
        """Describe the curve to the engine."""
        limits = {"lower": self.lower_length, "upper": self.upper_length}
        return {"parabolic": {**limits, "passive": self.passive}}


Curve = Annotated[
    Thelen | Parabolic, Field(discriminator="kind"), BeforeValidator(one_of("thelen", "parabolic"))
]


class Tendon(Force):
    """A tendon along the shortest path through points of bodies and around wraps."""

    description: ClassVar[str] = "tendons"

    kind: str
    path: Annotated[tuple[Stage, ...], Field(min_length=2, max_length=200)]

    @model_validator(mode="after")
    def _check_path(self) -> Tendon:
        """Check that each branch goes from a point to another one."""
        points, open_wrap = 0, False
        for index, stage in enumerate((*self.path, None)):
            path = f"path[{index}]" if stage is not None else "path"
            if isinstance(stage, Over):
                if points == 0 or open_wrap:
                    raise field_error("is a wrap: it needs a point before and after it", path)
                open_wrap = True
            elif stage is None or isinstance(stage, Branch):
                if points < 2 or open_wrap:
                    where = "ends" if stage is None else "begins a branch"
                    raise field_error(f"{where} before two points are joined", path)
                points = 0
            else:
                points, open_wrap = points + 1, False
        return self

    @property
    def load(self) -> Dimension | None:
        """Dimension of its load; None if it has none."""
        return None

    @property
    @abstractmethod
    def tension(self) -> dict[str, Any]:
        """What its tension is, as described to the engine."""

    @property
    def anchors(self) -> list[tuple[str, Attachment | Ground]]:
        """The points that the path names, with their keys."""
        found: list[tuple[str, Attachment | Ground]] = []
        for index, stage in enumerate(self.path):
            if isinstance(stage, (Attachment, Ground)):
                found.append((f"path[{index}]", stage))
            elif isinstance(stage, Over) and stage.side is not None:
                found.append((f"path[{index}].side", stage.side))
        return found

    def check(self, path: str, system: BodySystem) -> None:
        """Check that points and wraps exist."""
        for key, point in self.anchors:
            point.check_point(f"{path}.{key}", system.bodies)
        wraps = {name: wrap for _, name, wrap in system.entries(Wrap)}
        for index, stage in enumerate(self.path):
            if isinstance(stage, Over):
                check_known(stage.wrap, "wrap", wraps, f"{path}.path[{index}].wrap")

    def check_planar(self, path: str) -> None:
        """Reject points out of the plane."""
        for key, point in self.anchors:
            point.check_planar(f"{path}.{key}")

    def lower(self, name: str, system: BodySystem) -> dict[str, Any]:
        """Describe the tendon to the engine."""

        def stage(each: Attachment | Ground | Over | Branch) -> dict[str, Any]:
            if isinstance(each, Over):
                side = {} if each.side is None else {"side": each.side.lower_point(system.bodies)}
                return {"wrap": {"name": each.wrap, **side}}
            if isinstance(each, Branch):
                return {"branch": each.branch}
            return {"point": each.lower_point(system.bodies)}

        return {"name": name, "path": [stage(each) for each in self.path], "tension": self.tension}


class CableTendon(Tendon):
    """A tendon whose tension is a load, ``kind = "cable"``."""

    kind: Literal["cable"]

    @property
    def load(self) -> Dimension:
        """Its tension."""
        return FORCE

    @property
    def tension(self) -> dict[str, Any]:
        """That of the load."""
        return {"cable": {}}


class SpringTendon(Tendon):
    """An elastic tendon, ``kind = "spring"``, slack up to ``slack_length``.

    Its stiffness builds up linearly over the strain ``toe`` and is then constant.
    """

    kind: Literal["spring"]
    stiffness: PositiveStiffness
    slack_length: PositiveLength
    toe: PositiveNumber = 0.02

    @property
    def tension(self) -> dict[str, Any]:
        """That of a string."""
        keys = ("stiffness", "slack_length", "toe")
        return {"spring": {key: float(getattr(self, key)) for key in keys}}


class MuscleTendon(Tendon):
    """A Hill-type muscle, ``kind = "muscle"``, in series with a tendon of constant length.

    Its load is the activation, from 0 to 1.
    """

    kind: Literal["muscle"]
    max_force: NonNegativeForce
    optimal_length: PositiveLength
    tendon_slack_length: Length
    curve: Curve = Thelen()

    @property
    def load(self) -> Dimension:
        """Its activation."""
        return ACTIVATION

    @property
    def tension(self) -> dict[str, Any]:
        """Active and passive force of its fibres."""
        keys = ("max_force", "optimal_length", "tendon_slack_length")
        numbers = {key: float(getattr(self, key)) for key in keys}
        return {"muscle": {**numbers, "curve": self.curve.lower()}}


AnyTendon = Annotated[
    CableTendon | SpringTendon | MuscleTendon,
    Field(discriminator="kind"),
    BeforeValidator(one_of("cable", "spring", "muscle")),
]
