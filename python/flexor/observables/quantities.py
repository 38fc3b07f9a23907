"""Quantities of paths that are computed from their states, (n, s) or (n, s, members)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from flexor._engine import EVENTS
from flexor.arrays import Array
from flexor.materials.laws import fibre_energy
from flexor.model.results import Paths
from flexor.model.schema.section_geometry import is_made_of_fibres
from flexor.model.structure import Structure


def bending(paths: Paths) -> Array:
    """Return the sum of the angles of the joints [rad]."""
    return np.asarray(paths.joint_angles[:, :, is_angular(paths.model)].sum(axis=2))


def is_angular(model: Structure) -> NDArray[np.bool_]:
    """Return which coordinates of joints are angles, (joints,)."""
    return np.array([name in model.angular_joints for name in model.joints], dtype=bool)


def snaps(paths: Paths) -> Array:
    """Return the number of snaps along the whole path, without bifurcations."""
    kind = EVENTS.index("snap")
    counts = np.array([float((events["kind"] == kind).sum()) for events in paths.event_table])
    return np.broadcast_to(counts[:, None], paths.joint_angles.shape[:2]).copy()


def strain_use(paths: Paths) -> Array:
    """Return the largest strain as a share of the strain limit of its material."""
    uses = strain_uses(paths.model, paths.stretch)
    return np.asarray(np.fmax.reduce(uses, axis=(2, 3), initial=np.nan))


def strain_uses(model: Structure, stretch: Array) -> Array:
    """Return the strain of fibres (..., materials, 2) as a share of the material's limit."""
    return np.asarray(np.abs(stretch - 1.0) / limits(model, "strain_limit")[:, None])


def limits(model: Structure, key: str) -> Array:
    """Return the limit of each material, SI; infinite without one."""
    values = (getattr(table, key) for table in model.file.materials.values())
    return np.array([np.inf if value is None else float(value) for value in values])


def stress_use(paths: Paths) -> Array:
    """Return the largest nominal stress as a share of the stress limit of its material."""
    # Of each design, as the constants of materials may be varied.
    uses = [
        stress_uses(paths.model, stretch, parameters)
        for stretch, parameters in zip(paths.stretch, paths.parameters, strict=True)
    ]
    found = np.array(uses).reshape(paths.stretch.shape)
    return np.asarray(np.fmax.reduce(found, axis=(2, 3), initial=np.nan))


def stress_uses(model: Structure, stretch: Array, parameters: Array) -> Array:
    """Return the stress of fibres (..., materials, 2) of a design as a share of its limit."""
    found = np.full(stretch.shape, np.nan)
    for index, (name, table) in enumerate(model.file.materials.items()):
        if table.stress_limit is None:
            continue
        start, stop = model.engine.slots[f"{name}.constants"]
        constants, wound = parameters[start:stop].tolist(), table.winding == "hoop"
        energy = fibre_energy(table.kind, constants, stretch[..., index, :], wound)
        found[..., index, :] = np.abs(energy.first) / float(table.stress_limit)
    return found


def strap_outputs(model: Structure) -> dict[str, int]:
    """Return which of the engine's outputs is the tension of each strap."""
    outputs = model.engine.outputs
    return {name: outputs[of][0] + i for name, (of, i) in model.strap_places.items()}


def mass(paths: Paths) -> Array:
    """Return the mass of all rods [kg], the same at every load.

    Of a section that is given by its mass per length, and of others that of their parts.
    """
    total = np.zeros(len(paths))
    for rod in paths.model.rods:
        length, density, _ = _density(paths, rod)
        total += length * _integral(density, paths.model.file.rod(rod).gauss_rule[1])
    return np.broadcast_to(total[:, None], paths.joint_angles.shape[:2]).copy()


def mass_slopes(paths: Paths) -> Array:
    """Return the derivatives of `mass` by the engine's parameters, (n, P)."""
    model, parameters = paths.model, paths.parameters
    found = np.zeros(parameters.shape)
    for name in model.rods:
        rod = model.file.rod(name)
        points, shares = rod.gauss_rule
        length, density, (slope, powers, columns) = _density(paths, name)
        found[:, model.engine.slots[f"{name}.length"][0]] += _integral(density, shares)
        start = model.engine.slots[f"{name}.radius"][0]
        found[:, start + points] += length[:, None] * slope * shares
        for g, share in enumerate(shares):
            found[:, columns[g]] += (length * share)[:, None] * powers[:, g]
    return found


def _integral(density: Array, shares: Array) -> Array:
    """Add mass per length (n, G) point by point, (n,).

    A matrix product may round differently with the size of the batch.
    """
    whole = np.zeros(len(density))
    for point, share in enumerate(shares):
        whole += density[:, point] * share
    return whole


def _density(
    paths: Paths, name: str
) -> tuple[Array, Array, tuple[Array, Array, list[NDArray[np.intp]]]]:
    """Return the length (n,) of a rod and its mass per length at G Gauss points, (n, G).

    Also the slope of the latter by S, (n, G), and those by some of the engine's parameters,
    (n, G, c), with their indices at each point.
    """
    model, parameters = paths.model, paths.parameters
    rod, slots = model.file.rod(name), model.engine.slots
    points, _ = rod.gauss_rule
    length = model.slot(f"{name}.length", parameters.T)[0]
    s = model.slot(f"{name}.radius", parameters.T)[points].T
    if is_made_of_fibres(rod):
        sections = [slots[f"{name}.mass[{section}]"][0] for section in model.fibre_sections(name)]
        columns = [start + np.arange(3) for start in sections]
        powers = np.stack((np.ones_like(s), s, s * s), axis=2)
        c = np.stack([parameters[:, each] for each in columns], axis=1)
        density = c[..., 0] + s * (c[..., 1] + s * c[..., 2])
        return length, density, (c[..., 1] + 2.0 * s * c[..., 2], powers, columns)
    # The last of the factors is the area by S².
    both = np.array([slots[f"{name}.density"][0], slots[f"{name}.section_factors"][1] - 1])
    own, factor = (parameters[:, start, None] for start in both)
    slopes = np.stack((factor * s * s, own * s * s), axis=2)
    return length, own * factor * s * s, (2.0 * own * factor * s, slopes, [both] * len(points))
