"""Frames of all bodies at every load step, and the strains between them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from flexor.arrays import Array

if TYPE_CHECKING:
    from flexor.model import Path


def frames_of(path: Path) -> dict[str, Array]:
    """Return the frames of each body at each of s steps.

    Parameters
    ----------
    path
        Equilibria of one design.

    Returns
    -------
    dict of (s, m, 4, 4) arrays
        By body. A step without equilibrium has the frames of the last one that has; before any,
        those of the reference state.
    """
    model, parameters = path.model, path.parameters
    found, last = [], model.engine.frames(parameters, np.zeros(model.dof))
    for q in path.q:
        if np.isfinite(q).all():
            last = model.engine.frames(parameters, q)
        found.append(last)
    every = np.stack(found)
    return {body: every[:, start:stop] for body, (start, stop) in model.body_frames.items()}


def reference_frames(path: Path) -> dict[str, Array]:
    """Return the frames of each body in the reference state, where nothing is strained.

    Parameters
    ----------
    path
        Equilibria of one design.

    Returns
    -------
    dict of (m, 4, 4) arrays
        By body.
    """
    every = path.model.engine.frames(path.parameters, np.zeros(path.model.dof))
    return {body: every[start:stop] for body, (start, stop) in path.model.body_frames.items()}


def twists(frames: Array, stations: Array) -> Array:
    """Return the twist per length of the reference between neighbouring frames of a rod.

    Parameters
    ----------
    frames : (..., m, 4, 4) array
        Homogeneous matrices.
    stations : (m,) array
        Where they are along the rod [m].

    Returns
    -------
    (..., m, 6) array
        Curvatures [1/m] and stretches at the stations, constant between neighbours and averaged
        where two intervals meet.
    """
    between = _between(frames) / np.diff(stations)[:, None]
    ends = between[..., :1, :], between[..., -1:, :]
    width = np.diff(stations)
    share = (width[:-1] / (width[:-1] + width[1:]))[:, None]
    # Linear interpolation between the middles of two intervals.
    inner = (1.0 - share) * between[..., :-1, :] + share * between[..., 1:, :]
    return np.concatenate([ends[0], inner, ends[1]], axis=-2)


def _between(frames: Array) -> Array:
    """Logarithm on SE(3) of what leads from each frame to the next, (..., m - 1, 6).

    Its translation is V⁻¹ p with V⁻¹ = I - ω̂/2 + (1/θ² - (1 + cos θ)/(2 θ sin θ)) ω̂².
    """
    first, second = frames[..., :-1, :, :], frames[..., 1:, :, :]
    turn = np.swapaxes(first[..., :3, :3], -1, -2)
    moved = np.einsum("...ij,...j->...i", turn, second[..., :3, 3] - first[..., :3, 3])
    omega = _rotation_vector(turn @ second[..., :3, :3])
    angle = np.linalg.norm(omega, axis=-1)
    with np.errstate(invalid="ignore", divide="ignore"):
        factor = 1.0 / angle**2 - (1.0 + np.cos(angle)) / (2.0 * angle * np.sin(angle))
    # The series from where rounding of the difference exceeds its error.
    factor = np.where(angle < 1e-2, 1.0 / 12.0 + angle**2 / 720.0, factor)[..., None]
    across = np.cross(omega, moved)
    moved = moved - 0.5 * across + factor * np.cross(omega, across)
    return np.concatenate([omega, moved], axis=-1)


def _rotation_vector(rotation: Array) -> Array:
    skew = 0.5 * np.stack(
        [
            rotation[..., 2, 1] - rotation[..., 1, 2],
            rotation[..., 0, 2] - rotation[..., 2, 0],
            rotation[..., 1, 0] - rotation[..., 0, 1],
        ],
        axis=-1,
    )
    sine = np.linalg.norm(skew, axis=-1)
    cosine = 0.5 * (np.trace(rotation, axis1=-2, axis2=-1) - 1.0)
    with np.errstate(invalid="ignore", divide="ignore"):
        factor = np.arctan2(sine, cosine) / sine
    return np.asarray(np.where(sine < 1e-8, 1.0, factor)[..., None] * skew)


def refined(frames: Array, between: int) -> Array:
    """Return frames with others between neighbours, where strains are constant.

    Parameters
    ----------
    frames : (s, m, 4, 4) array
        Homogeneous matrices of a rod at s steps.
    between : int
        Into how many parts each interval is cut.

    Returns
    -------
    (s, between (m - 1) + 1, 4, 4) array
    """
    if between == 1:
        return frames
    s, m = frames.shape[:2]
    twist = _between(frames)
    fraction = np.arange(between) / between
    moved = frames[:, :-1, None] @ _exponential(twist[:, :, None] * fraction[:, None])
    return np.concatenate([moved.reshape(s, between * (m - 1), 4, 4), frames[:, -1:]], axis=1)


def _exponential(twist: Array) -> Array:
    """Exponential on SE(3) of twists (..., 6), by Rodrigues' formula."""
    omega, moved = twist[..., :3], twist[..., 3:]
    angle = np.linalg.norm(omega, axis=-1)[..., None]
    small = angle < 1e-4
    safe = np.where(small, 1.0, angle)
    first = np.where(small, 1.0 - angle**2 / 6.0, np.sin(safe) / safe)
    second = np.where(small, 0.5 - angle**2 / 24.0, (1.0 - np.cos(safe)) / safe**2)
    third = np.where(small, 1.0 / 6.0, (safe - np.sin(safe)) / safe**3)
    skew = np.cross(np.eye(3), -omega[..., None, :])
    square = skew @ skew
    found = np.zeros((*twist.shape[:-1], 4, 4))
    found[..., :3, :3] = np.eye(3) + first[..., None] * skew + second[..., None] * square
    across = np.cross(omega, moved)
    found[..., :3, 3] = moved + second * across + third * np.cross(omega, across)
    found[..., 3, 3] = 1.0
    return found
