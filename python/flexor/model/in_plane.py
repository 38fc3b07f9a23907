"""Components of a model in space that cannot leave a plane, as models in this plane.

Where every joint turns about the normal of one plane or slides in it, and rods bend and stretch in
it only, a model in space and one in the plane have the same coordinates and the same potential, and
so the same equilibria and the same stability: there is no motion out of the plane that could be
unstable. In the plane less has to be computed, and mirror images of a fibre are one.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from flexor import _engine
from flexor.arrays import Array
from flexor.model.components import texts
from flexor.model.schema.obstacle import turning
from flexor.model.schema.strain import MODES, PLANAR_MODES

Json = Mapping[str, Any]
Indices = NDArray[np.intp]

# Lists of a description of which nothing leaves the plane, besides what is checked here. Others,
# such as obstacles, ties, tendons and wrenches, have places or directions in the world.
_SUPPORTED = {
    "planar", "gravity", "bodies", "spheres", "materials", "contacts", "fibres", "foundations",
    "loops", "springs", "pressures", "joint_torques", "joint_couplings", "shared_inputs",
    "controls",
}  # fmt: skip
_SAME = 1e-12  # of directions, and of places as a share of the largest [m]
_ALIKE = 1e-9  # of the numbers of fibres that are one in the plane
_NUMBERS, _AREA = 16, (4, 5, 6)  # of a fibre, and which of these are its area
_ACROSS = (0, 1, 12, 13)  # which are its place across the plane


@dataclass(frozen=True, eq=False)
class InPlane:
    """A component in its plane.

    Attributes
    ----------
    engine : flexor._engine.Model
        The model in the plane.
    """

    engine: _engine.Model
    _own: Array  # (P,), parameters of the component in space
    # Parameters in the plane are sums of these multiples of those in space.
    _rows: Indices
    _columns: Indices
    _weights: Array
    _free: NDArray[np.bool_]  # (P,), which do nothing in the plane, whatever their value
    _normal: Array  # (3,)
    _height: float  # of the plane along its normal [m]
    _roots: Indices  # (b, 3), parameters of the places of bodies in the world
    _gravity: Indices  # (3,), or (0,) without
    _alike: Indices  # (a, 2), parameters that are the same where fibres are one

    def parameters(self, which: Indices, values: Array) -> tuple[Indices, Array] | None:
        """Return the parameters in the plane that designs change, and to what.

        Parameters
        ----------
        which : (k,) array
            Which parameters of the component in space they change.
        values : (n, k) array
            To what.

        Returns
        -------
        indices, values : (m,) and (n, m) arrays
            None if they leave the plane.
        """
        placing = np.isin(which, self._roots)
        alike = np.isin(which, self._alike)
        falling = np.isin(which, self._gravity)
        used = np.isin(which, self._columns) | self._free[which] | placing | alike | falling
        if (values[:, ~used] != self._own[which[~used]]).any():
            return None
        whole = np.repeat(self._own[None], len(values), axis=0)
        whole[:, which] = values
        if placing.any():
            heights = whole[:, self._roots] @ self._normal
            if not (np.abs(heights - self._height) <= _SAME * _size(whole[:, self._roots])).all():
                return None
        if falling.any():
            weight = whole[:, self._gravity]
            if (np.abs(weight @ self._normal) > _SAME * np.abs(weight).max(axis=1)).any():
                return None
        if alike.any():
            first, second = whole[:, self._alike[:, 0]], whole[:, self._alike[:, 1]]
            if not (np.abs(first - second) <= _ALIKE * np.abs(first)).all():
                return None
        indices = np.unique(self._rows[np.isin(self._columns, which)])
        terms = np.isin(self._rows, indices)
        found = np.zeros((len(values), len(indices)))
        place = np.searchsorted(indices, self._rows[terms])
        for row, column, weight in zip(
            place.tolist(), self._columns[terms].tolist(), self._weights[terms], strict=True
        ):
            found[:, row] += weight * whole[:, column]
        return indices, found


def in_space(found: dict[str, Any]) -> dict[str, Any]:
    """Return results of a model in the plane as they are in space: rods' angles without sign."""
    angles = np.abs(found["rod_bending"])
    turned = np.remainder(angles, 2.0 * np.pi)
    return {**found, "rod_bending": np.minimum(turned, 2.0 * np.pi - turned)}


def in_plane(description: Json, space: _engine.Model) -> InPlane | None:
    """Return a component in its plane; None if it can leave it, or has what the plane has not.

    Parameters
    ----------
    description
        What it is to the engine; see `flexor.model.components`.
    space
        The component in space.
    """
    if description["planar"] or not {k for k, each in description.items() if each} <= _SUPPORTED:
        return None
    bodies = _needed(description)
    plane = _Plane.of(description["gravity"], bodies)
    if plane is None or not all(map(_stays, bodies)) or _leaves(description):
        return None
    folded = [_folded(each) for each in description.get("fibres", ())]
    made = {
        **description,
        "planar": True,
        "gravity": _in(plane.turned(description["gravity"])),
        "bodies": [plane.body(body) for body in bodies],
    }
    if folded:
        made["fibres"] = [each for each, _ in folded]
    try:
        engine = _engine.Model(json.dumps(made, sort_keys=True, separators=(",", ":")))
    except ValueError:
        return None
    same = ("coordinates", "inputs", "outputs")
    if any(getattr(engine, each) != getattr(space, each) for each in same):
        return None
    return _assembled(description, space, engine, plane, bodies, [each for _, each in folded])


@dataclass(frozen=True, eq=False)
class _Plane:
    """A plane in the world: axes of which y is its normal, and how far it is along that."""

    axes: Array  # (3, 3), columns
    height: float

    @classmethod
    def of(cls, gravity: Sequence[float], bodies: Sequence[Json]) -> _Plane | None:
        """Return the plane of bodies, or None if they have none or gravity is not in it."""
        roots = [body["placement"] for body in bodies if body["parent"] is None]
        axes = turning(tuple(roots[0]["rotation"]))
        places = np.array([root["translation"] for root in roots])
        heights = places @ axes[:, 1]
        normals = [turning(tuple(root["rotation"]))[:, 1] for root in roots]
        apart = [np.abs(normal - axes[:, 1]).max() for normal in normals]
        weight = np.array(gravity)
        if (
            max(apart) > _SAME
            or np.ptp(heights) > _SAME * _size(places)
            or abs(weight @ axes[:, 1]) > _SAME * np.abs(weight).max()
        ):
            return None
        return cls(axes, float(heights[0]))

    def turned(self, vector: Any) -> Array:
        """Return a vector of the world in these axes."""
        return np.asarray(self.axes.T @ np.array(vector))

    def body(self, body: Json) -> Json:
        """Describe a body in the plane."""
        place = body["placement"]
        if body["parent"] is not None:
            return body
        turn = self.axes.T @ turning(tuple(place["rotation"]))
        angle = float(np.arctan2(turn[0, 2], turn[0, 0]))
        angle = 0.0 if abs(angle) < _SAME else angle
        placement = {
            "translation": _in(self.turned(place["translation"])),
            "rotation": [0.0, angle, 0.0],
        }
        return {**body, "placement": placement}


def _size(places: Array) -> float:
    return max(float(np.abs(places).max()), 1.0)


def _in(vector: Array) -> list[float]:
    return [float(vector[0]), 0.0, float(vector[2])]


def _needed(description: Json) -> list[Json]:
    """Return the bodies without those fixed in the world that nothing refers to.

    With gravity their weight counts.
    """
    named = {
        text
        for key, entries in description.items()
        if key not in ("bodies", "planar", "gravity")
        for text in texts(entries)
    }
    above = {body["parent"] for body in description["bodies"]}
    weighs = any(description["gravity"])

    def is_needed(body: Json) -> bool:
        still = body["parent"] is None and body["joint"]["kind"] == "fixed"
        idle = still and "link" in body["shape"] and body["name"] not in named | above
        return weighs or not idle

    return [body for body in description["bodies"] if is_needed(body)]


def _stays(body: Json) -> bool:
    """Whether a body has no freedom out of the plane of what carries it."""
    place, joint = body["placement"], body["joint"]
    if body["parent"] is not None and (
        place["translation"][1] or place["rotation"][0] or place["rotation"][2]
    ):
        return False
    if joint["kind"] == "revolute":
        if joint["axis"][0] or joint["axis"][2]:
            return False
    elif joint["kind"] == "prismatic":
        if joint["axis"][1]:
            return False
    elif joint["kind"] != "fixed":
        return False
    if "rod" not in body["shape"]:
        return True
    rod = body["shape"]["rod"]
    reference = zip(MODES, rod["reference_strain"], strict=True)
    return all(each["mode"] in PLANAR_MODES for each in rod["strain"]) and not any(
        value for mode, value in reference if mode not in PLANAR_MODES
    )


def _leaves(value: Any) -> bool:
    """Whether an entry has a place in the world, or an offset out of the plane."""
    if isinstance(value, Mapping):
        # The offset of a coupling is a number.
        vectors = (value[key] for key in ("offset", "surface") if key in value)
        across = any(each[1] for each in vectors if isinstance(each, (list, tuple)))
        return across or "world" in value or any(map(_leaves, value.values()))
    if isinstance(value, (list, tuple)) and value and isinstance(value[0], (Mapping, list)):
        return any(map(_leaves, value))
    return False


def _folded(fibres: Json) -> tuple[Json, list[list[list[int]]]]:
    """Return the sections of a rod with fibres of equal z as one, and which these are."""
    sections, members = [], []
    for section in fibres["sections"]:
        made: dict[Any, dict[str, Any]] = {}
        of: dict[Any, list[int]] = {}
        for i, fibre in enumerate(section["fibres"]):
            centre = fibre["centre"][2:]
            key = (fibre["material"], fibre["stretch"], *fibre["z"], *fibre["winding"], *centre)
            if key in made:
                sums = zip(made[key]["area"], fibre["area"], strict=True)
                made[key]["area"] = [one + other for one, other in sums]
            else:
                flat = {"y": [0.0, 0.0], "centre": [0.0, 0.0, *centre]}
                made[key] = {**fibre, **flat}
            of.setdefault(key, []).append(i)
        sections.append({**section, "fibres": list(made.values())})
        members.append(list(of.values()))
    return {**fibres, "sections": sections}, members


def _assembled(
    description: Json,
    space: _engine.Model,
    engine: _engine.Model,
    plane: _Plane,
    bodies: Sequence[Json],
    folded: Sequence[list[list[list[int]]]],
) -> InPlane | None:
    """Say which parameters in space each of those in the plane follows from."""
    groups = {
        f"{fibres['rod']}.fibres[{number}]": members
        for fibres, sections in zip(description.get("fibres", ()), folded, strict=True)
        for number, members in enumerate(sections)
    }
    roots = {body["name"] for body in bodies if body["parent"] is None}
    terms: list[tuple[int, int, float]] = []
    alike: list[tuple[int, int]] = []
    free = np.ones(len(space.parameters), dtype=bool)
    for name, (start, stop) in engine.slots.items():
        first, last = space.slots[name]
        free[first:last] = False
        body, _, part = name.rpartition(".")
        if name in groups:
            for i, members in enumerate(groups[name]):
                for k in range(_NUMBERS):
                    row = start + _NUMBERS * i + k
                    sources = [first + _NUMBERS * j + k for j in members]
                    if k in _ACROSS:
                        free[sources] = True
                    elif k in _AREA:
                        terms += [(row, source, 1.0) for source in sources]
                    else:
                        terms.append((row, sources[0], 1.0))
                        alike += [(sources[0], other) for other in sources[1:]]
            continue
        if last - first != stop - start:
            return None
        if name == "gravity" or (body in roots and part == "translation"):
            for axis in (0, 2):
                weights = enumerate(plane.axes[:, axis].tolist())
                terms += [(start + axis, first + k, weight) for k, weight in weights if weight]
        elif stop - start > 1 and part in _KEPT:
            kept = _KEPT[part]
            if not (body in roots and part == "rotation"):
                terms += [(start + k, first + k, 1.0) for k in kept]
        else:
            terms += [(start + k, first + k, 1.0) for k in range(stop - start)]
    rows, columns, multiples = zip(*terms, strict=True)
    return InPlane(
        engine=engine,
        _own=space.parameters.copy(),
        _rows=np.array(rows),
        _columns=np.array(columns),
        _weights=np.array(multiples),
        _free=free,
        _normal=plane.axes[:, 1],
        _height=plane.height,
        _roots=np.array([np.arange(*space.slots[f"{name}.translation"]) for name in roots]),
        _gravity=np.arange(*space.slots.get("gravity", (0, 0))),
        _alike=np.array(alike, dtype=np.intp).reshape(-1, 2),
    )


# Which entries of what has several count in the plane.
_KEPT = {
    "translation": (0, 2),
    "offset": (0, 2),
    "rotation": (1,),
    "reference_strain": tuple(i for i, mode in enumerate(MODES) if mode in PLANAR_MODES),
}
