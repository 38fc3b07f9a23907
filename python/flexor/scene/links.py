"""Links: round cones with their skins, as contact sees them."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from flexor.arrays import Array
from flexor.model.schema import ModelFile
from flexor.scene.objects import Attached, grid_faces

# Fine enough for the colours of a contact's width.
AROUND, ALONG, CAP = 96, 40, 10


def link_objects(
    name: str, frames: Array, radii: tuple[float, float], file: ModelFile
) -> Iterator[Attached]:
    """Yield the surface of a link and, below its skin, the bone.

    Parameters
    ----------
    name
        The link.
    frames : (s, 2, 4, 4) array
        Its frames at joint and tip.
    radii
        Radii at joint and tip [m].
    file
        The model file.
    """
    skin = file.bodies[name].skin
    yield _cone(name, "" if skin is None else "skin", frames, radii)
    thickness = sum(float(layer.thickness) for layer in skin or ())
    if 0.0 < thickness < min(radii):
        yield _cone(name, "bone", frames, (radii[0] - thickness, radii[1] - thickness))


def _cone(name: str, part: str, frames: Array, radii: tuple[float, float]) -> Attached:
    length = float(np.linalg.norm(frames[0, 1, :3, 3] - frames[0, 0, :3, 3]))
    x, r = profile(length, *radii)
    angle = np.linspace(0.0, 2.0 * np.pi, AROUND, endpoint=False)
    rings = np.stack(
        [
            np.broadcast_to(x[1:-1, None], (len(x) - 2, AROUND)),
            r[1:-1, None] * np.cos(angle),
            r[1:-1, None] * np.sin(angle),
        ],
        axis=2,
    ).reshape(-1, 3)
    poles = np.array([[x[0], 0.0, 0.0], [x[-1], 0.0, 0.0]])
    count = len(rings)
    return Attached(
        name=name,
        kind="link",
        part=part,
        faces=np.concatenate([grid_faces(len(x) - 2, AROUND, closed=True), *_poles(count)]),
        local=np.concatenate([rings, poles]),
        frame=np.zeros(count + 2, dtype=np.intp),
        frames=frames[:, :1],
    )


def _poles(count: int) -> list[NDArray[np.intp]]:
    here = np.arange(AROUND)
    after = (here + 1) % AROUND
    last = count - AROUND
    base, tip = np.full(AROUND, count), np.full(AROUND, count + 1)
    return [np.stack([base, after, here], 1), np.stack([tip, last + here, last + after], 1)]


def profile(length: float, first: float, second: float) -> tuple[Array, Array]:
    """Return x and r of the convex hull of two spheres on an axis, from pole to pole.

    Parameters
    ----------
    length
        Distance of the centres [m].
    first, second
        Radii of the spheres at x = 0 and x = `length` [m].
    """
    if length <= abs(first - second):
        centre, radius = (0.0, first) if first > second else (length, second)
        angle = np.linspace(np.pi, 0.0, 2 * CAP + 1)
        return centre + radius * np.cos(angle), radius * np.sin(angle)
    # From the axis to the normal of the cone, which both spheres touch along circles.
    touch = np.arccos((first - second) / length)
    base, tip = np.linspace(np.pi, touch, CAP + 1), np.linspace(touch, 0.0, CAP + 1)
    share = np.linspace(0.0, 1.0, ALONG + 1)[1:-1]
    start = np.array([first * np.cos(touch), first * np.sin(touch)])
    end = np.array([length + second * np.cos(touch), second * np.sin(touch)])
    middle = start[:, None] + (end - start)[:, None] * share
    x = np.concatenate([first * np.cos(base), middle[0], length + second * np.cos(tip)])
    r = np.concatenate([first * np.sin(base), middle[1], second * np.sin(tip)])
    return x, r
