"""From a rod of cosseratbench to a model of Flexor and back.

A rod is read by its attributes and the values of its conditions, so that cosseratbench itself need
not be installed.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from _validation import systems
from numpy.typing import NDArray

from flexor.model import Model, State

Array = NDArray[np.float64]
Json = dict[str, Any]

GAUSS_POINTS = 3  # the second is the middle of an element
SAMPLES = GAUSS_POINTS + 1  # of an element, with one of its ends
MODES = ("twist_x", "bend_y", "bend_z", "extend_x", "shear_y", "shear_z")


@dataclass(frozen=True)
class Shape:
    """Initial shape of a rod.

    Attributes
    ----------
    length : float
        Length at rest [m].
    nodes : (n + 1, 3) array
        Positions [m] of material points that are equally spaced along the rod at rest.
    frames : (n, 3, 3) array
        Orientations of the elements between them: tangent, material direction, their product.
    base, tip : (3, 3) arrays
        Orientations of the ends.
    curvature : (n + 1, 3) array
        Twist and bending at the nodes [1/m].
    stretch : (n + 1,) array
        Stretch at the nodes.
    """

    length: float
    nodes: Array
    frames: Array
    base: Array
    tip: Array
    curvature: Array
    stretch: Array


def shape(rod: Any, n_elements: int) -> Shape:
    """Return the initial shape of a rod, whose material directions are parallel along it."""
    line = np.asarray(rod.centerline, dtype=float)
    gaps = np.linalg.norm(np.diff(line, axis=0), axis=1)
    rest = rod.rest_arc_length
    arc = np.concatenate([[0.0], np.cumsum(gaps)]) if rest is None else np.asarray(rest, float)
    places = np.linspace(0.0, arc[-1], n_elements + 1)
    step = arc[-1] / n_elements
    nodes = np.stack([np.interp(places, arc, line[:, axis]) for axis in range(3)], axis=1)
    chords = np.diff(nodes, axis=0)
    lengths = np.linalg.norm(chords, axis=1)
    tangents = chords / lengths[:, None]
    across = np.asarray(rod.normal, dtype=float)
    frames, turns = np.empty((n_elements, 3, 3)), np.zeros((n_elements + 1, 3))
    for i, tangent in enumerate(tangents):
        if i > 0:
            turn = _smallest_turn(tangents[i - 1], tangent)
            across = rotation(turn) @ across
            turns[i] = frames[i - 1].T @ turn
        across = across - (across @ tangent) * tangent
        across /= np.linalg.norm(across)
        frames[i] = np.stack([tangent, across, np.cross(tangent, across)], axis=1)
    turns[[0, -1]] = turns[[1, -2]]  # of one element: none
    return Shape(
        length=float(arc[-1]),
        nodes=nodes,
        frames=frames,
        base=frames[0] @ rotation(-0.5 * turns[0]),
        tip=frames[-1] @ rotation(0.5 * turns[-1]),
        curvature=turns / step,
        stretch=np.interp(places, places[:-1] + 0.5 * step, lengths / step),
    )


def rotation(vector: Array) -> Array:
    """Return the matrix of a rotation vector."""
    angle = float(np.linalg.norm(vector))
    x, y, z = vector
    skew = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    # sin(a) / a and (1 - cos(a)) / a^2, by NumPy's sinc, which includes pi.
    first, second = np.sinc(angle / np.pi), 0.5 * np.sinc(0.5 * angle / np.pi) ** 2
    return np.asarray(np.eye(3) + first * skew + second * skew @ skew)


def rotation_vector(matrix: Array) -> Array:
    """Return the rotation vector of a matrix, of at most half a turn."""
    values, vectors = np.linalg.eig(matrix)
    axis = np.real(vectors[:, np.argmin(np.abs(values - 1.0))])
    lever = np.cross(axis, np.eye(3)[np.argmin(np.abs(axis))])
    turned = matrix @ lever
    return np.asarray(axis * np.arctan2(axis @ np.cross(lever, turned), lever @ turned))


def _smallest_turn(before: Array, after: Array) -> Array:
    axis = np.cross(before, after)
    sine = float(np.linalg.norm(axis))
    return np.asarray(axis * (np.arctan2(sine, before @ after) / sine if sine > 1e-14 else 1.0))


def build(
    rod: Any, gravity: Sequence[float], n_elements: int, *, pushed: Sequence[float] | None = None
) -> tuple[Model, dict[str, float]]:
    """Return the model of a rod, and the coordinates of its initial shape.

    The driven end, if there is one, is the model's only input; or a force [N] in the direction
    `pushed`, on the middle of a rod of an odd number of elements.
    """
    own = shape(rod, n_elements)
    bodies, ties, wrenches = {"rod": _body(rod, own, n_elements)}, {}, {}
    if rod.end.value != "free":
        ties["end"] = _tie(rod, own)
        if rod.end_motion is not None:
            ties["end"] |= _drive(rod.end_motion)
            if rod.end_motion.slides_along is not None:
                # The end is welded, but for the rotation that drives it, to a carriage that slides.
                bodies["carriage"] = _carriage(rod, own)
                ties["end"]["first"] = {"body": "carriage", "at": "base"}
    for i, load in enumerate(rod.loads):
        at = {"start": "base", "end": "tip"}[load.at.value]
        force = systems.vector(load.force, "N")
        wrenches[f"load{i}"] = {"body": "rod", "at": at, "force": force}
    if pushed is not None:
        force = systems.vector(pushed, "N")
        wrenches["push"] = {
            "body": "rod",
            "point": _middle(n_elements),
            "force": force,
            "input": True,
        }
    parts = {name: part for name, part in (("ties", ties), ("wrenches", wrenches)) if part}
    model = systems.build("rod", bodies, planar=False, gravity=gravity, **parts)
    start = {f"rod.extend_x[{i}]": float(each) - 1.0 for i, each in enumerate(own.stretch)}
    for mode, values in zip(MODES, own.curvature.T * own.length, strict=False):
        start |= {f"rod.{mode}[{i}]": float(each) for i, each in enumerate(values)}
    return model, start


def _body(rod: Any, own: Shape, n_elements: int) -> Json:
    if rod.start_motion is not None:
        raise NotImplementedError("the start of a rod is driven: only its end can be")
    if rod.start.value == "free":
        raise NotImplementedError("the start of a rod is free: only its end can be")
    young, shear = rod.material.youngs_modulus, rod.material.shear_modulus
    return {
        **systems.rod(
            own.length,
            rod.radius,
            dict.fromkeys(MODES, "nodal_linear"),
            young_modulus=young,
            elements=n_elements,
            gauss_points=GAUSS_POINTS,
        ),
        "poisson_ratio": young / (2.0 * shear) - 1.0,
        "density": systems.si(rod.material.density, "kg/m^3"),
        "joint": {"kind": _joint(rod)},
        "placement": {
            **systems.vector(own.nodes[0], "m"),
            "rotation": systems.vector(rotation_vector(own.base), "rad"),
        },
    }


def _joint(rod: Any) -> str:
    if rod.start.value == "clamped":
        return "fixed"
    # Only a clamped end holds the spin of a pinned rod, which is the same all round.
    return "spherical" if rod.end.value == "clamped" else "universal"


def _tie(rod: Any, own: Shape) -> Json:
    kind = {"clamped": "weld", "pinned": "pin"}[rod.end.value]
    place = {"world": systems.vector(own.nodes[-1], "m")}
    tie: Json = {"kind": kind, "first": place, "second": {"body": "rod", "at": "tip"}}
    turned = rotation_vector(own.tip @ own.base.T)  # the reference state of the rod is straight
    if kind == "weld" and np.linalg.norm(turned) > 1e-9:
        tie["rotation"] = systems.vector(turned, "rad")
    return tie


def _carriage(rod: Any, own: Shape) -> Json:
    axis = np.asarray(rod.end_motion.slides_along, dtype=float).tolist()
    joint = {"kind": "prismatic", "axis": axis}
    place = systems.vector(own.nodes[-1], "m")
    return systems.link(rod.radius, rod.radius, joint=joint, placement=place)


def _drive(motion: Any) -> Json:
    kind, axis = _motion(motion)
    return {"drive": kind, "axis": axis.tolist()}


def driven(motion: Any, times: Array) -> Array:
    """Return the rotation [rad] or displacement [m] of a driven end at some times, (times,)."""
    kind, axis = _motion(motion)
    return np.interp(times, motion.times, np.asarray(getattr(motion, kind), dtype=float) @ axis)


def _motion(motion: Any) -> tuple[str, Array]:
    """Return what drives an end, and the axis about or along which it does."""
    kinds = [name for name in ("rotation", "displacement") if np.any(getattr(motion, name))]
    if len(kinds) != 1:
        raise NotImplementedError("an end is driven other than by one rotation or displacement")
    moved = np.asarray(getattr(motion, kinds[0]), dtype=float)
    axis = moved[np.argmax(np.linalg.norm(moved, axis=1))]
    axis = axis / np.linalg.norm(axis)
    if np.abs(moved - np.outer(moved @ axis, axis)).max() > 1e-9 * np.abs(moved).max():
        raise NotImplementedError("an end is driven about or along an axis that changes")
    return kinds[0], np.asarray(axis)


def _middle(n_elements: int) -> int:
    """Return the index of the sample point in the middle of a rod."""
    if n_elements % 2 == 0:
        raise NotImplementedError("the middle of a rod of an even number of elements is no sample")
    return SAMPLES * (n_elements // 2) + SAMPLES // 2


def middle(state: State) -> Array:
    """Return the place (3,) [m] of the middle of a rod of an odd number of elements."""
    frames = state.frames()["rod"]
    return np.asarray(frames[_middle(len(frames) // SAMPLES), :3, 3])


def in_plane(state: State) -> Array:
    """Return the nodes (n + 1, 3) [m] of a rod of a planar model."""
    frames = state.frames()["rod"]
    return np.asarray(frames[::SAMPLES, :3, 3])


def placed(state: State) -> tuple[Array, Array]:
    """Return the nodes (n + 1, 3) [m] and the material directions of the elements (n, 3)."""
    frames = state.frames()["rod"]
    nodes = frames[::SAMPLES, :3, 3]
    chords = np.diff(nodes, axis=0)
    chords /= np.linalg.norm(chords, axis=1, keepdims=True)
    across = frames[SAMPLES // 2 :: SAMPLES, :3, 1]
    across = across - np.sum(across * chords, axis=1, keepdims=True) * chords
    return nodes, across / np.linalg.norm(across, axis=1, keepdims=True)
