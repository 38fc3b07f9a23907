"""Sizes that vary along a rod, as splines whose control values are design variables."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from flexor.arrays import Array
from flexor.errors import InputError, unknown_name
from flexor.model.changes import resolve
from flexor.model.schema import ModelFile, Rod
from flexor.model.schema.profile import Spline, Taper, interpolated, spline_basis, spline_points
from flexor.model.schema.profile import surface as surface_of
from flexor.model.validation import describe

if TYPE_CHECKING:
    from flexor.model import Model
    from flexor.model.structure import Structure

# Sizes that a rod may have as a spline.
SIZES = ("radius", "wall", "floor", "width", "height", "thickness")
SPLINE = "spline"
MOST = 40


def control_values(
    bounds: Mapping[str, Sequence[object]], model: Structure, source: str
) -> tuple[dict[str, Sequence[object]], dict[str, int]]:
    """Replace each size that varies along a rod by the control values of a spline.

    Parameters
    ----------
    bounds
        Of fields; with ``"spline 4"`` as a third entry those of a size along a rod, which becomes a
        spline of four control values.
    model
        The model.
    source
        Where the bounds come from, for messages.

    Returns
    -------
    bounds, counts : dict
        Bounds of fields, and the number of control values of each size.

    Raises
    ------
    InputError
        If there is no such kind of profile, too few or many values, or no such size of a rod.
    """
    made: dict[str, Sequence[object]] = {}
    counts: dict[str, int] = {}
    for label, ends in bounds.items():
        if isinstance(ends, str) or len(ends) != 3:
            made[label] = ends
            continue
        count = _count(ends[2], f"{source}: {label}")
        _size_at(label, model.file, source)
        counts[label] = count
        for i in range(count):
            made[f"{label}.{SPLINE}.{i}"] = ends[:2]
    return made, counts


def control_points(profile: str, label: str) -> Array:
    """Return the points X where the control values of a profile such as ``"spline 4"`` act."""
    return spline_points(_count(profile, label))


def with_splines(model: Model, counts: Mapping[str, int]) -> Model:
    """Return a model in which sizes are splines with so many control values.

    The same model if they are. Others become the spline through their values at the points where
    the control values act, which is the same size where it is constant or linear.
    """
    from flexor.model.loading import changed_model

    changes: dict[str, object] = {}
    for label, count in counts.items():
        size, rod = _size_at(label, model.file, "variables")
        if isinstance(size, Spline) and len(size.spline) == count:
            continue
        at = spline_points(count)
        values, _ = spline_basis(count, at)
        found = np.linalg.solve(values, _values(size, rod, at))
        # Of a linear size exactly, not to rounding.
        found = np.array([float(f"{value:.12g}") for value in found.tolist()])
        changes[label] = {SPLINE: [f"{value!r} m" for value in found.tolist()]}
    return changed_model(model, changes) if changes else model


def recorded_splines(labels: Sequence[str], file: ModelFile) -> dict[str, int]:
    """Return the sizes of which every control value is among the labels, with their number."""
    found: dict[str, int] = {}
    for label in labels:
        size, _, index = label.rpartition(f".{SPLINE}.")
        if size and index.isdigit():
            found[size] = found.get(size, 0) + 1
    sizes = {size: _size_at(size, file, "variables")[0] for size in found}
    return {
        size: count
        for size, count in found.items()
        if isinstance(sizes[size], Spline) and len(sizes[size].spline) == count
    }


def _count(kind: object, place: str) -> int:
    words = str(kind).split()
    if not words or words[0] != SPLINE:
        name = words[0] if words else ""
        raise InputError(
            f'{place}: {unknown_name("profile", name, (SPLINE,))}, such as "spline 4".'
        )
    number = words[1] if len(words) == 2 else ""
    if not number.isdigit() or not 2 <= int(number) <= MOST:
        raise InputError(
            f'{place} is {describe(kind)}: write "spline" and the number of control values, '
            f'2 to {MOST}, such as "spline 4".'
        )
    return int(number)


def _size_at(label: str, file: ModelFile, source: str) -> tuple[Any, Rod]:
    """Return a size of a rod, with the rod."""
    keys = resolve(file.to_document(), label.strip().split("."), f'field "{label}"')
    body = file.bodies.get(keys[1]) if keys[0] == "bodies" and len(keys) > 2 else None
    if not isinstance(body, Rod) or keys[-1] not in SIZES or "skin" in keys:
        raise InputError(
            f'{source}: "{label}" cannot vary along a rod: sizes that can are its radius, and '
            "wall, floor, width, height, radius and layer.thickness of its section."
        )
    node: Any = body
    for key in keys[2:]:
        if isinstance(node, tuple) and not key.isdigit() and len(node) == 1:
            node = node[0]
        if isinstance(node, tuple) and key.isdigit() and int(key) < len(node):
            node = node[int(key)]
        elif hasattr(node, key):
            node = getattr(node, key)
        else:
            names = getattr(type(node), "model_fields", {})
            raise InputError(f'field "{label}": {unknown_name("key", key, names)}.')
    if node is None:
        raise InputError(f'field "{label}" cannot be varied: it is not given in the file.')
    return node, body


def _values(size: Any, rod: Rod, at: Array) -> Array:
    if isinstance(size, Taper):
        return surface_of(size, at)[0]
    if isinstance(size, (tuple, Spline)):
        return interpolated(size, at)[0]
    plain = not hasattr(size, "text")
    return float(size) * (surface_of(rod.radius, at)[0] if plain else np.ones_like(at))
