"""The place of a part: its world becomes a frame of the model that it is a part of."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from flexor.arrays import Array
from flexor.model import units
from flexor.model.schema.body import Link, Placement, Rod
from flexor.model.schema.obstacle import HalfSpace, Obstacle, turning
from flexor.model.schema.points import Attachment, Ground
from flexor.model.schema.solid import Box, Capsule, Cylinder
from flexor.model.schema.spring import Spring
from flexor.model.schema.table import Table
from flexor.model.schema.tendon import Branch, Over, Tendon
from flexor.model.schema.tie import Tie
from flexor.model.schema.vector import ForceVector, MomentVector, Offset, Rotation, Triple
from flexor.model.schema.wrap import Wrap
from flexor.model.schema.wrench import Wrench
from flexor.model.validation import field_error


@dataclass(frozen=True)
class Frame:
    """A frame at the tip of a body, or in the world."""

    parent: str | None
    origin: Array  # (3,) [m]
    axes: Array  # (3, 3), columns

    @classmethod
    def of(cls, parent: str | None, placement: Placement) -> Frame:
        """Return the frame of a placement."""
        origin = np.array([placement.x, placement.y, placement.z], dtype=float)
        return cls(parent, origin, turning(placement.rotation.components))

    @property
    def is_world(self) -> bool:
        """Whether it is the world itself."""
        unmoved = not self.origin.any() and (self.axes == np.eye(3)).all()
        return self.parent is None and bool(unmoved)

    def placed(self, table: Table, path: str) -> Table:
        """Return an entry of a part, which is at this frame.

        Parameters
        ----------
        table
            The entry: a body, a force or an obstacle.
        path
            Its path in the part, for messages.
        """
        if self.is_world:
            return table
        fields = self._fields(table, path)
        return table.model_copy(update=dict(fields)) if fields else table

    def _fields(self, table: Table, path: str) -> Mapping[str, Any]:
        if isinstance(table, (Rod, Link)):
            return self._root(table) if table.parent is None else {}
        if isinstance(table, Obstacle):
            return self._obstacle(table) if isinstance(table.point, Offset) else {}
        if isinstance(table, Spring):
            return {"second": self._anchor(table.second)}
        if isinstance(table, Tie):
            return self._tie(table)
        if isinstance(table, Tendon):
            return {"path": tuple(self._stage(stage) for stage in table.path)}
        if isinstance(table, Wrap):
            return self._wrap(table) if isinstance(table.point, Offset) else {}
        if isinstance(table, Wrench) and table.frame == "world":
            if self.parent is not None:
                tail = f'acts in the world, and "{self.parent}" may turn: use frame = "body", or '
                raise field_error(f"{tail}a wrench of the model that has the part", path)
            return {
                "force": _vector(ForceVector, self.axes @ table.force.components, units.FORCE),
                "moment": _vector(MomentVector, self.axes @ table.moment.components, units.MOMENT),
            }
        return {}

    def _root(self, body: Rod | Link) -> dict[str, Any]:
        place = body.placement
        point = self._point(np.array([place.x, place.y, place.z], dtype=float))
        turned = self.axes @ turning(place.rotation.components)
        x, y, z = (units.LENGTH.si(value) for value in point)
        placement = {"x": x, "y": y, "z": z, "rotation": _rotation(turned)}
        return {"parent": self.parent, "placement": place.model_copy(update=placement)}

    def _obstacle(self, obstacle: Obstacle) -> dict[str, Any]:
        assert isinstance(obstacle.point, Offset)
        fields: dict[str, Any] = {"point": self._place(obstacle.point)}
        if isinstance(obstacle, HalfSpace):
            fields["normal"] = self._direction(obstacle.normal)
        elif isinstance(obstacle, (Capsule, Cylinder)):
            fields["axis"] = self._direction(obstacle.axis)
        elif isinstance(obstacle, Box):
            fields["rotation"] = _rotation(self.axes @ turning(obstacle.rotation.components))
        return fields

    def _wrap(self, wrap: Wrap) -> dict[str, Any]:
        assert isinstance(wrap.point, Offset)
        fields: dict[str, Any] = {"point": self._place(wrap.point)}
        if wrap.direction is not None:
            x, y, z = wrap.direction
            fields["axis"] = self._direction((x, y, z))
        return fields

    def _stage(self, stage: Attachment | Ground | Over | Branch) -> Any:
        if isinstance(stage, Over) and isinstance(stage.side, Ground):
            return stage.model_copy(update={"side": self._anchor(stage.side)})
        return self._anchor(stage) if isinstance(stage, Ground) else stage

    def _tie(self, tie: Tie) -> dict[str, Any]:
        fields: dict[str, Any] = {name: self._anchor(getattr(tie, name)) for name in ENDS}
        if isinstance(tie.first, Ground):
            turned = self.axes @ tie.rotation.components
            fields["rotation"] = _vector(Rotation, turned, units.ANGLE)
            if tie.kind in ("hinge", "slider") or tie.drive is not None:
                fields["axis"] = self._direction(tie.direction)
        return fields

    def _anchor(self, anchor: Attachment | Ground) -> Attachment | Ground:
        if not isinstance(anchor, Ground):
            return anchor
        place = self._place(anchor.world)
        return place if isinstance(place, Attachment) else Ground(world=place)

    def _place(self, point: Offset) -> Offset | Attachment:
        moved = self._point(np.array(point.components))
        offset: Offset = _vector(Offset, moved, units.LENGTH)
        if self.parent is None:
            return offset
        return Attachment(body=self.parent, at="tip", offset=offset)

    def _point(self, point: Array) -> list[float]:
        found: list[float] = _clean(self.origin + self.axes @ point)
        return found

    def _direction(self, axis: Any) -> Triple:
        x, y, z = _clean(self.axes @ np.array(axis, dtype=float))
        return (x, y, z)


ENDS = ("first", "second")


def _vector(kind: type[Any], components: Any, dimension: units.Dimension) -> Any:
    x, y, z = (dimension.si(value) for value in _clean(components))
    return kind(x=x, y=y, z=z)


def _rotation(axes: Array) -> Rotation:
    """Return the rotation vector of a matrix."""
    from scipy.spatial.transform import Rotation as Turn  # deferred: slow to import

    made: Rotation = _vector(Rotation, Turn.from_matrix(axes).as_rotvec(), units.ANGLE)
    return made


def _clean(values: Any) -> list[float]:
    """Return numbers with what is rounding beside the largest set to zero."""
    found = np.asarray(values, dtype=float)
    least = 4.0 * np.finfo(float).eps * np.abs(found).max()
    return [float(value) if abs(value) > least else 0.0 for value in found]
