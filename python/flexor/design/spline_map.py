"""The engine's parameters where sizes vary along a rod as splines.

What the engine takes at a point of a rod depends on the sizes there only. The dependence is found
for a rod whose sizes are the same everywhere, as a `SlotMap`, which takes a few files with one
section; each of the engine's parameters follows from it at the values of the splines where it
belongs. These are linear in the control values, so that all is exact, and it is checked at points
of the box.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from flexor.arrays import Array
from flexor.design.box_points import points_of_box
from flexor.design.fields import replaced, spline_of, value_of
from flexor.design.fitting import TOLERANCE
from flexor.design.lowered import Lowered
from flexor.design.refitting import refitted
from flexor.design.slot_map import SlotMap
from flexor.design.slot_search import slot_map
from flexor.errors import InputError
from flexor.model import units
from flexor.model.changes import with_whole_name
from flexor.model.schema import ModelFile, Rod
from flexor.model.schema.profile import Spline, Taper, spline_basis, surface
from flexor.model.schema.section_geometry import gauss_points, geometries, is_made_of_fibres
from flexor.model.structure import Structure

Keys = tuple[str, ...]
_CHECKS = 3  # points inside the box at which the map is compared with the model file
_ROWS = 4096  # evaluations of the map of equal sizes at a time
_NUMBERED = re.compile(r"(?P<name>.+)\.(?P<part>\w+)\[(?P<index>\d+)\]")


@dataclass(frozen=True, eq=False)
class SplineMap:
    """Parameters of the engine as functions of k fields in a box; made by `spline_map`.

    Attributes
    ----------
    indices : (m,) array
        Which of the engine's parameters vary.
    """

    indices: NDArray[np.intp]
    _equal: SlotMap  # for sizes that are the same all along, of e variables
    _weights: Array  # (g, e, k), its variables at each place
    _offsets: Array  # (g, e)
    _places: NDArray[np.intp]  # (m,), at which of them a parameter is
    _columns: NDArray[np.intp]  # (m,), which parameter of the map of equal sizes it is
    _like: _Reduced  # to find the same for a model with other values

    def values(self, x: Array) -> Array:
        """Return the parameters (n, m) of designs (n, k), SI."""
        found = np.zeros((len(x), len(self.indices)))
        for rows in self._parts(len(x)):
            # What is not picked may be beyond the bounds.
            with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
                equal = self._equal.values(self._at(x[rows]))
            found[rows] = self._gathered(equal.reshape(-1, len(self._weights), equal.shape[-1]))
        return found

    def valid(self, x: Array) -> NDArray[np.bool_]:
        """Return which designs (n, k) can be, (n,): all."""
        return np.ones(len(x), dtype=bool)

    def jacobian(self, x: Array) -> Array:
        """Return the derivatives (n, m, k) of the parameters of designs (n, k)."""
        g, e, k = self._weights.shape
        found = np.zeros((len(x), len(self.indices), k))
        for rows in self._parts(len(x), e):
            with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
                equal = self._equal.jacobian(self._at(x[rows])).reshape(-1, g, self._width, e)
            for j in range(k):
                slopes = np.zeros(equal.shape[:3])
                for i in np.flatnonzero(self._weights[:, :, j].any(axis=0)):
                    with np.errstate(invalid="ignore"):
                        slopes += equal[..., i] * self._weights[None, :, i, j, None]
                found[rows, :, j] = self._gathered(slopes)
        return found

    @property
    def _width(self) -> int:
        return len(self._equal.indices)

    def _parts(self, n: int, each: int = 1) -> list[slice]:
        size = max(_ROWS // (len(self._weights) * each), 1)
        return [slice(i, i + size) for i in range(0, n, size)]

    def _at(self, x: Array) -> Array:
        """Return the variables of the map of equal sizes at every place, (n g, e)."""
        e, k = self._weights.shape[1:]
        found = np.repeat(self._offsets[None], len(x), axis=0)
        # One after the other: a design must not depend on its neighbours in the batch.
        for j in range(k):
            found += x[:, j, None, None] * self._weights[None, :, :, j]
        return found.reshape(-1, e)

    def _gathered(self, equal: Array) -> Array:
        """Pick the parameters (n, m) among those at every place, (n, g, w)."""
        return equal[:, self._places, self._columns]


def spline_map(
    model: Structure,
    fields: Sequence[Keys],
    names: Sequence[str],
    lower_bounds: Array,
    upper_bounds: Array,
) -> SplineMap:
    """Find how the engine's parameters depend on fields, some of them control values of splines.

    Parameters
    ----------
    model, fields, names, lower_bounds, upper_bounds
        As for `slot_map`.

    Raises
    ------
    InputError
        As `slot_map`, or if a parameter depends on sizes at several places.
    """
    reduced = _Reduced.of(model, tuple(fields), tuple(names))
    low, high = reduced.bounds(lower_bounds, upper_bounds)
    equal = slot_map(reduced.model, reduced.keys, reduced.names, low, high)
    made = _assembled(model, reduced, equal)
    lowered = Lowered(model, tuple(fields), names)
    middle, half = 0.5 * (lower_bounds + upper_bounds), 0.5 * (upper_bounds - lower_bounds)
    for u in points_of_box(_CHECKS, len(fields)):
        _check(made, model, lowered, middle + half * u, names)
    return made


def refitted_spline_map(
    like: SplineMap, model: Structure, fields: Sequence[Keys]
) -> SplineMap | None:
    """Return the same map for another model that differs in values; see `refitted`."""
    known = like._like
    reduced = _Reduced.of(model, tuple(fields), known.field_names)
    equal = refitted(like._equal, known.model, reduced.model, reduced.keys)
    return None if equal is None else _assembled(model, reduced, equal)


@dataclass(frozen=True, eq=False)
class _Size:
    """A size along a rod, linear in values of the file, its control values."""

    keys: Keys
    controls: tuple[Keys, ...]  # c
    own: Array  # (c,)
    node: Spline | Taper | tuple[float, ...]

    @classmethod
    def of(cls, keys: Keys, file: ModelFile) -> _Size:
        node: Any = value_of(keys, file)
        controls: tuple[Keys, ...] = ()
        if isinstance(node, Spline):
            controls = tuple((*keys, "spline", str(i)) for i in range(len(node.spline)))
        elif isinstance(node, Taper):
            controls = ((*keys, "base"), (*keys, "tip"))
        own = np.array([float(value_of(each, file)) for each in controls])
        return cls(keys, controls, own, node)

    def at(self, x: float) -> tuple[Array, Array, float, float]:
        """Return value and slope at X by the control values, each (c,), and without these."""
        points = np.array([x])
        if not self.controls:
            value, slope = surface(self.node, points)
            return np.zeros(0), np.zeros(0), float(value[0]), float(slope[0])
        # A taper is a spline of two control values.
        values, slopes = spline_basis(len(self.controls), points)
        return values[0], slopes[0], 0.0, 0.0


@dataclass(frozen=True, eq=False)
class _Reduced:
    """The model with sizes that are the same all along a rod, and its variables.

    A radius becomes linear, with two variables, so that its slope, and its value at two places, are
    those of a radius that varies.
    """

    model: Structure
    fields: tuple[Keys, ...]  # k, of the model itself
    field_names: tuple[str, ...]
    keys: tuple[Keys, ...]  # e, of the model of equal sizes
    names: tuple[str, ...]
    sizes: dict[int, _Size]  # by their first variable

    @classmethod
    def of(cls, model: Structure, fields: tuple[Keys, ...], names: tuple[str, ...]) -> _Reduced:
        file = model.file
        places: dict[Keys, _Size] = {}
        for each in fields:
            if (varied := spline_of(each, file)) is not None:
                # What is at a place also depends on the radius there.
                for one in (varied, (*varied[:2], "radius")):
                    places.setdefault(one, _Size.of(one, file))
        within = {control for size in places.values() for control in size.controls}
        keys = [each for each in fields if each not in within]
        called = [name for each, name in zip(fields, names, strict=True) if each not in within]
        sizes = dict[int, _Size]()
        for place, size in places.items():
            sizes[len(keys)] = size
            count = 2 if place[-1] == "radius" and len(place) == 3 else 1
            keys += [(*place, "spline", str(i)) for i in range(count)]
            called += [".".join(place[1:])] * count
            values = tuple(units.LENGTH.si(size.at(0.5)[2] or size.own[0]) for _ in range(count))
            file = replaced(file, {place: Spline.model_construct(spline=values)})
        return cls(Structure(file), fields, names, tuple(keys), tuple(called), sizes)

    def bounds(self, lower: Array, upper: Array) -> tuple[Array, Array]:
        """Return those of its variables, given those of the fields."""
        ends = []
        for values, extreme in ((lower, np.min), (upper, np.max)):
            given = dict(zip(self.fields, map(float, values), strict=True))
            found = np.array([given.get(each, np.nan) for each in self.keys])
            for first, size in self.sizes.items():
                known = zip(size.controls, size.own.tolist(), strict=True)
                mine = np.array([given.get(each, own) for each, own in known])
                if not len(mine):
                    mine = surface(size.node, np.linspace(0.0, 1.0, 101))[0]
                found[first : self._end(first)] = extreme(mine)
            ends.append(found)
        # Of a radius that does not vary and is the same everywhere.
        ends[1] = np.where(ends[0] < ends[1], ends[1], 1.01 * ends[0])
        return ends[0], ends[1]

    def _end(self, first: int) -> int:
        place = self.sizes[first].keys
        return first + (2 if place[-1] == "radius" and len(place) == 3 else 1)

    def place(self, ends: tuple[float, float], slope: bool) -> tuple[Array, Array]:
        """Return its variables at a place as linear functions of the fields, (e, k) and (e,).

        A radius has its values there and, of two places, at both; or its value and slope there.
        """
        weights, offset = np.zeros((len(self.keys), len(self.fields))), np.zeros(len(self.keys))
        column = {each: j for j, each in enumerate(self.fields)}
        for i, each in enumerate(self.keys):
            if each in column and not any(f <= i < self._end(f) for f in self.sizes):
                weights[i, column[each]] = 1.0
        for first, size in self.sizes.items():
            value, rise, constant, constant_rise = size.at(ends[0])
            if not slope:
                other, _, other_constant, _ = size.at(ends[1])
                span = (ends[1] - ends[0]) or 1.0
                rise, constant_rise = (other - value) / span, (other_constant - constant) / span
            # Of a radius the values at base and tip of the line through both places.
            radius = self._end(first) - first == 2
            before = 0.0 if slope or not radius else ends[0]
            at = (-before, 1.0 - before) if radius else (0.0,)
            for i, distance in enumerate(at):
                offset[first + i] += constant + distance * constant_rise
                for share, own, keys in zip(
                    value + distance * rise, size.own, size.controls, strict=True
                ):
                    if keys in column:
                        weights[first + i, column[keys]] += share
                    else:
                        offset[first + i] += share * own
        return weights, offset


def _assembled(model: Structure, reduced: _Reduced, equal: SlotMap) -> SplineMap:
    """Say for each of the engine's parameters where it belongs."""
    file = model.file
    own, other = model.engine.slots, reduced.model.engine.slots
    position = {int(column): i for i, column in enumerate(equal.indices)}
    found: dict[tuple[tuple[float, float], bool], int] = {}
    indices, places, columns = [], [], []

    def at(x: float, end: float | None = None, slope: bool = False) -> int:
        return found.setdefault(((x, x if end is None else end), slope), len(found))

    where = _places_of_sections(model, reduced.model)
    entries = (*file.bodies, *file.actuators, *file.straps)
    for name, (start, stop) in own.items():
        source, x = where.get(name, (name, None))
        first = other[source][0]
        body, *rest = with_whole_name(name.split("."), entries)
        part = ".".join(rest)
        rod = file.bodies.get(body)
        strap = file.straps.get(body)
        points = _gauss_points(model, body) if part == "enclosed" else ()
        for i in range(stop - start):
            column = position.get(first + i)
            if column is None:
                continue
            if len(points):
                place = at(points[i])
            elif x is not None:
                place = at(x)
            elif isinstance(rod, Rod) and stop - start == rod.sample_count:
                place = at(float(rod.sample_points[i]), slope=part == "slope")
            elif strap is not None:
                place = at(0.0, float(strap.at))
            else:
                place = at(0.5 if part.endswith("foundation") else 0.0)
            indices.append(start + i)
            places.append(place)
            columns.append(column)
    weights, offsets = zip(*(reduced.place(ends, slope) for ends, slope in found), strict=True)
    order = np.argsort(indices, kind="stable")
    return SplineMap(
        np.array(indices, dtype=np.intp)[order],
        equal,
        np.stack(weights),
        np.stack(offsets),
        np.array(places, dtype=np.intp)[order],
        np.array(columns, dtype=np.intp)[order],
        reduced,
    )


def _places_of_sections(model: Structure, equal: Structure) -> dict[str, tuple[str, float]]:
    """Return the name of each section's parameters where sizes are equal, and where they belong."""
    found = {}
    for name in model.rods:
        rod, same = model.file.rod(name), equal.file.rod(name)
        if not is_made_of_fibres(rod):
            continue
        points = rod.sample_points[gauss_points(rod)]
        _, of_gauss = geometries(rod, model.file.materials)
        _, of_equal = geometries(same, equal.file.materials)
        cavities = [
            key for key, each in model.file.actuators.items() if getattr(each, "rod", None) == name
        ]
        for slot in model.engine.slots:
            match = _NUMBERED.fullmatch(slot)
            if match and match["name"] in (name, *cavities):
                gauss = of_gauss.index(int(match["index"]))
                source = f"{match['name']}.{match['part']}[{of_equal[gauss]}]"
                found[slot] = (source, float(points[gauss]))
    return found


def _gauss_points(model: Structure, pressure: str) -> list[float]:
    """Return the Gauss points of the rod that a pressure acts on, X in [0, 1]."""
    rod = model.file.rod(model.file.actuators[pressure].rod)
    points: list[float] = rod.sample_points[gauss_points(rod)].tolist()
    return points


def _check(
    made: SplineMap, model: Structure, lowered: Lowered, x: Array, names: Sequence[str]
) -> None:
    expected = lowered.parameters(x)
    scale = np.abs(expected).copy()
    for start, stop in lowered.ranges:
        scale[start:stop] = np.abs(expected[start:stop]).max(initial=0.0)
    # The slope of a constant radius is zero but for rounding of the radius.
    slots = model.engine.slots
    for rod in model.rods:
        radius, slope = (slice(*slots[f"{rod}.{each}"]) for each in ("radius", "slope"))
        scale[slope] = np.maximum(scale[slope], scale[radius])
    found = lowered.own.copy()
    found[made.indices] = made.values(x[None, :])[0]
    wrong = np.abs(found - expected) > 1e3 * TOLERANCE * scale[: len(found)]
    if wrong.any():
        which = lowered.name(int(np.flatnonzero(wrong)[0]))
        raise InputError(
            f'"{names[0]}" and others cannot be varied as splines: {which} depends on sizes at '
            "several places."
        )
