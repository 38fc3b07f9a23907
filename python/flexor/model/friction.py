"""Friction at the points of a state, as of the path that led there."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from flexor.arrays import Array

if TYPE_CHECKING:
    from flexor.model.structure import Structure

POINT = np.dtype(
    [
        ("friction", np.int64),
        ("sphere", np.int64),
        ("other", np.int64),
        ("place", np.float64, 3),
        ("force", np.float64, 3),
        ("limit", np.float64),
        ("slip", np.float64, 3),
        ("slides", np.bool_),
    ]
)


@dataclass(frozen=True, eq=False)
class FrictionForces:
    """Friction in one state at m points that touch."""

    name: NDArray[np.object_]  # (m,), of the contact, obstacle or rod that has friction
    sphere: NDArray[np.int64]  # (m,), index of the sphere, counted through all groups
    place: Array  # (m, 3) [m]
    force: Array  # (m, 3), tangential force on the first body [N]
    limit: Array  # (m,), its largest size, the coefficient times the normal force [N]
    slip: Array  # (m, 3), elastic slip [m]
    slides: NDArray[np.bool_]  # (m,), whether it slid in the step that led there


def friction_forces(model: Structure, points: NDArray[Any]) -> FrictionForces:
    """Return the friction of a state from its row of `Results.friction`."""
    names = np.array([*model.frictions, ""], dtype=object)
    return FrictionForces(
        name=names[points["friction"]],
        **{key: points[key] for key in ("sphere", "place", "force", "limit", "slip", "slides")},
    )


def friction_table(
    found: Mapping[str, NDArray[Any]], shape: tuple[int, ...], lead: int
) -> NDArray[np.object_]:
    """Return the points (m,) of each of (n, s) states, as arrays of `POINT`."""
    rows = np.empty(len(found["step"]), dtype=POINT)
    for name in POINT.names or ():
        rows[name] = found[name]
    place = found["design"].astype(np.int64) * (shape[1] + lead) + found["step"].astype(np.int64)
    bounds = np.searchsorted(place, np.arange(shape[0] * (shape[1] + lead) + 1))
    table = np.empty((shape[0], shape[1] + lead), dtype=object)
    for index in range(table.size):
        table.flat[index] = rows[bounds[index] : bounds[index + 1]]
    return table[:, lead:]


def slips(points: NDArray[Any]) -> Array:
    """Return the slips (m, 6) with which the engine starts a path from a state."""
    columns = [points[name].astype(float) for name in ("friction", "sphere", "other")]
    return np.column_stack([*columns, points["slip"].reshape(-1, 3)])


def described(model: Structure, points: NDArray[Any]) -> list[dict[str, Any]]:
    """Return the points as plain tables, for JSON."""
    return [
        {
            "name": model.frictions[point["friction"]],
            **{name: point[name].tolist() for name in POINT.names or ()},
        }
        for point in points
    ]


def read(tables: list[dict[str, Any]]) -> NDArray[Any]:
    """Read points that were written by `described`."""
    points = np.zeros(len(tables), dtype=POINT)
    for point, table in zip(points, tables, strict=True):
        for name in POINT.names or ():
            point[name] = table[name]
    return points
