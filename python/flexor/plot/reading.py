"""From the engine's description and state of a model to a scene."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from flexor.plot.scene import Line, Link, Push, Rod, Scene

Array = NDArray[np.float64]


class Engine(Protocol):
    """What a drawing asks of the compiled engine; see `flexor._engine.Model`."""

    @property
    def slots(self) -> dict[str, tuple[int, int]]:
        """Where each quantity is in the parameters."""
        ...

    def frame_names(self) -> list[str]:
        """Return the names of the frames."""
        ...

    def frames(self, parameters: Array, q: Array) -> Array:
        """Return the frames, (F, 4, 4)."""
        ...

    def spheres(self, parameters: Array, q: Array) -> Array:
        """Return centres and radii of the contact spheres, (n, 4)."""
        ...

    def contacts(self, parameters: Array, q: Array) -> Any:
        """Return the touching pairs and their forces."""
        ...


def read_scene(
    engine: Engine, description: Mapping[str, Any], parameters: Array, q: Array
) -> Scene:
    """Place every body, line and contact force of a model.

    Parameters
    ----------
    engine : Engine
        The compiled model.
    description : mapping
        What it was made from.
    parameters : ndarray, shape (P,)
        Its numbers, of the design to be drawn (SI).
    q : ndarray, shape (D,)
        The state (SI).

    Returns
    -------
    Scene
        In the world's frame, SI.
    """
    frames = dict(zip(engine.frame_names(), engine.frames(parameters, q), strict=True))
    rods: dict[str, Rod] = {}
    links: list[Link] = []
    for body in description["bodies"]:
        name, shape = body["name"], body["shape"]
        if "rod" in shape:
            height = _slot(engine, parameters, f"{name}.radius")
            placed = np.array([frames[f"{name}[{i}]"] for i in range(len(height))])
            # A circular section has no ratio: it is as wide as it is high.
            width = float(shape["rod"]["section"].get("ratio", 1.0)) * height
            rods[name] = Rod(name, placed, height, width)
        else:
            links.append(
                Link(
                    name,
                    frames[f"{name}.joint"][:3, 3],
                    frames[f"{name}.tip"][:3, 3],
                    float(_slot(engine, parameters, f"{name}.radius_base")[0]),
                    float(_slot(engine, parameters, f"{name}.radius_tip")[0]),
                )
            )
    lines = [
        _line(engine, parameters, actuator, rods[actuator["rod"]])
        for actuator in description["actuators"]
    ]
    return Scene(list(rods.values()), links, lines, _pushes(engine, parameters, q))


def _line(engine: Engine, parameters: Array, actuator: Mapping[str, Any], rod: Rod) -> Line:
    lever = _slot(engine, parameters, f"{actuator['name']}.lever")
    offset = np.asarray(actuator["path"]) + rod.half_height[:, None] * lever
    # A lever beyond the surface is the arm at which the force acts; the line is drawn where it can
    # be, on the surface, and the legend tells.
    outside = np.hypot(offset[:, 0] / rod.half_width, offset[:, 1] / rod.half_height)
    beyond = float(np.max(outside))
    offset = offset / np.maximum(outside, 1.0)[:, None]
    points = rod.frames[:, :3, 3] + np.einsum("mij,mj->mi", rod.frames[:, :3, 1:3], offset)
    label = str(actuator["kind"])
    if beyond > 1.0 + 1e-9:
        label += f" (acts at {beyond:.3g} S)"
    return Line(actuator["name"], points, label)


def _pushes(engine: Engine, parameters: Array, q: Array) -> list[Push]:
    found = engine.contacts(parameters, q)
    first, second = (np.asarray(found[key], dtype=np.intp) for key in ("first", "second"))
    if len(first) == 0:
        return []
    spheres = np.asarray(engine.spheres(parameters, q))
    force = -np.asarray(found["force"])
    depth = np.asarray(found["depth"])
    apart = spheres[first, :3] - spheres[second, :3]
    towards = apart / np.linalg.norm(apart, axis=1)[:, None]
    touching = spheres[second, :3] + (spheres[second, 3] - 0.5 * depth)[:, None] * towards
    pushes = []
    # One arrow for each sphere of the limb: what all that touches it does to it together.
    for sphere in np.unique(second):
        mine = second == sphere
        strength = np.linalg.norm(force[mine], axis=1)
        point = np.average(touching[mine], axis=0, weights=np.maximum(strength, 1e-300))
        pushes.append(Push(point, force[mine].sum(axis=0)))
    return pushes


def _slot(engine: Engine, parameters: Array, name: str) -> Array:
    start, stop = engine.slots[name]
    return np.asarray(parameters[start:stop], dtype=np.float64)
