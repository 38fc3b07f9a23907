"""Places of the largest overlap, contact pressure and strain of a state."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from flexor.arrays import Array
from flexor.model.schema import Rod

if TYPE_CHECKING:
    from flexor.model.contact_forces import ContactForces
    from flexor.model.results import State
    from flexor.model.structure import Structure


@dataclass(frozen=True)
class Extreme:
    """The largest value of a quantity in a state, with its place."""

    value: float  # SI
    body: str
    X: float  # fraction of the body's length
    on: str | None = None  # the body or the obstacle that it touches


def contact_pressure(state: State) -> dict[str, Array]:
    """Return the pressure along each body that touches through a skin.

    Parameters
    ----------
    state
        An equilibrium.

    Returns
    -------
    dict of (k, 2) arrays
        By body: X and pressure [Pa], of a rod at all its sample points, of a link at the
        points that are touched, ordered by X.
    """
    model, contacts = state.model, state.contact_forces()
    found: dict[str, list[tuple[float, float]]] = {}
    for name in model.rods:
        rod = model.file.rod(name)
        if rod.skin is not None:
            found[name] = [(float(x), 0.0) for x in rod.sample_points]
    for index in np.flatnonzero(np.isfinite(contacts.pressure)):
        pressure = float(contacts.pressure[index])
        for sphere in (contacts.first[index], contacts.second[index]):
            if sphere < 0:
                continue  # an obstacle
            body, x = place(state, int(sphere), contacts.point[index])
            found.setdefault(body, []).append((x, pressure))
    # At a point that touches two links the larger pressure counts.
    merged = {body: dict(sorted(rows)) for body, rows in found.items()}
    return {body: np.array(list(rows.items())) for body, rows in merged.items() if rows}


def extremes(state: State) -> dict[str, Extreme]:
    """Return the largest overlap, contact pressure and strain of a state with their places.

    Parameters
    ----------
    state
        An equilibrium.

    Returns
    -------
    dict
        ``max_overlap`` [m], ``max_contact_pressure`` [Pa], ``max_strain`` and ``min_stretch``, as
        far as the model has them and something touches.
    """
    found: dict[str, Extreme] = {}
    contacts = state.contact_forces()
    overlap = np.where(contacts.second < 0, np.nan, contacts.depth)
    quantities = {"max_overlap": overlap, "max_contact_pressure": contacts.pressure}
    for key, values in quantities.items():
        largest = _largest_contact(state, contacts, values)
        if largest is not None:
            found[key] = largest
    if np.isfinite(state.stretch).any():
        frames = state.model.engine.stretch_frames(state.parameters, state.q)
        strain = np.abs(state.stretch - 1.0)
        for key, ranked, values in (
            ("max_strain", strain, strain),
            ("min_stretch", -state.stretch, state.stretch),
        ):
            at = np.unravel_index(int(np.nanargmax(ranked)), ranked.shape)
            found[key] = Extreme(float(values[at]), *_frame_place(state.model, int(frames[at])))
    return found


def centreline(state: State) -> Extreme | None:
    """Return where the centreline of a rod is deepest in a body that it touches, if it is any."""
    contacts, places = state.contact_forces(), state.model.sphere_places
    on_rod = np.array([places[sphere][1] is not None for sphere in contacts.first], dtype=bool)
    radius = state.model.engine.spheres(state.parameters, state.q)[:, 3]
    of_bodies = on_rod & (contacts.second >= 0)
    depth = np.where(of_bodies, contacts.depth - radius[contacts.first], np.nan)
    return _largest_contact(state, contacts, depth)


def _largest_contact(state: State, contacts: ContactForces, values: Array) -> Extreme | None:
    """Return the largest of numbers (m,) of contacts, some of which may be NaN."""
    if not np.isfinite(values).any():
        return None
    index = int(np.nanargmax(values))
    body, x = place(state, int(contacts.first[index]), contacts.point[index])
    second = int(contacts.second[index])
    names = list(state.model.file.obstacles)
    on = names[-1 - second] if second < 0 else state.model.sphere_places[second][0]
    return Extreme(float(values[index]), body, x, on)


def fibre(state: State, values: Array) -> tuple[str, Extreme]:
    """Return the material and the place of the largest value of a fibre.

    Parameters
    ----------
    state
        An equilibrium.
    values : array
        Of its fibres, as `State.stretch`; NaN where there is none.
    """
    frames = state.model.engine.stretch_frames(state.parameters, state.q)
    at = np.unravel_index(int(np.nanargmax(values)), values.shape)
    material = list(state.model.file.materials)[int(at[0])]
    return material, Extreme(float(values[at]), *_frame_place(state.model, int(frames[at])))


def place(state: State, sphere: int, point: Array) -> tuple[str, float]:
    """Return the body of a sphere, and X of the sphere on a rod, of the point on a link."""
    body, x = state.model.sphere_places[sphere]
    if x is not None:
        return body, x
    frames = state.model.engine.frames(state.parameters, state.q)
    start, stop = state.model.body_frames[body]
    base, tip = frames[start, :3, 3], frames[stop - 1, :3, 3]
    axis = tip - base
    return body, float(np.clip((point - base) @ axis / (axis @ axis), 0.0, 1.0))


def _frame_place(model: Structure, frame: int) -> tuple[str, float]:
    for name, (start, stop) in model.body_frames.items():
        body = model.file.bodies[name]
        if start <= frame < stop and isinstance(body, Rod):
            return name, float(body.sample_points[frame - start])
    raise ValueError(f"frame {frame} is not on a rod")
