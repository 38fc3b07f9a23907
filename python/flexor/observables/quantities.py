"""Quantities of paths that are computed from their states, (n, s) or (n, s, members)."""

from __future__ import annotations

from collections.abc import Callable, Iterable

import numpy as np

from flexor.arrays import Array
from flexor.model.results import Paths
from flexor.model.schema import Rod
from flexor.model.schema.section_geometry import is_made_of_fibres


def bending(paths: Paths) -> Array:
    """Return the sum of the angles of the joints [rad]."""
    names = paths.model.angular_joints
    angular = np.array([name in names for name in paths.model.joints], dtype=bool)
    return np.asarray(paths.joint_angles[:, :, angular].sum(axis=2))


def snaps(paths: Paths) -> Array:
    """Return the number of snaps along the whole path."""
    counts = paths.event_count.astype(float)[:, None]
    return np.broadcast_to(counts, paths.joint_angles.shape[:2]).copy()


def strain_use(paths: Paths) -> Array:
    """Return the largest strain as a share of the strain limit of its material."""
    found = np.full(paths.stretch.shape[:2], -np.inf)
    for index, table in enumerate(paths.model.file.materials.values()):
        if table.strain_limit is not None:
            strain = np.abs(paths.stretch[:, :, index] - 1.0).max(axis=2)
            found = np.fmax(found, strain / float(table.strain_limit))
    return _existing(found)


def stress_use(paths: Paths) -> Array:
    """Return the largest nominal stress as a share of the stress limit of its material."""
    found = np.full(paths.stretch.shape[:2], -np.inf)
    for index, (name, table) in enumerate(paths.model.file.materials.items()):
        if table.stress_limit is not None:
            with np.errstate(invalid="ignore", divide="ignore"):
                stress = table.material(name).nominal_stress(paths.stretch[:, :, index])
            found = np.fmax(found, np.abs(stress).max(axis=2) / float(table.stress_limit))
    return _existing(found)


def strap_forces(paths: Paths) -> Array:
    """Return the tension of each strap [N], (n, s, straps)."""
    file, engine = paths.model.file, paths.model.engine
    loops = [name for name, strap in file.straps.items() if strap.listed() == "loops"]
    springs = [*file.springs, *(name for name in file.straps if name not in loops)]
    columns = {
        **_each(paths, loops, engine.loop_tensions),
        **_each(paths, springs, engine.spring_tensions),
    }
    return np.stack([columns[name] for name in file.straps], axis=2)


def obstacle_forces(paths: Paths) -> Array:
    """Return the force on each obstacle along its normal [N], (n, s, obstacles)."""
    engine, names = paths.model.engine, tuple(paths.model.file.obstacles)
    found = _each(paths, names, engine.half_space_forces)
    return np.stack([found[name] for name in names], axis=2)


def mass(paths: Paths) -> Array:
    """Return the mass of all rods [kg], the same at every load.

    Of a section that is given by its mass per length, and of others that of their parts.
    """
    model = paths.model
    parameters = paths.parameters
    total = np.zeros(len(parameters))
    for name in model.rods:
        rod = model.file.rod(name)
        points, shares = rod.gauss_rule
        length = model.slot(f"{name}.length", parameters.T)[0]
        s = model.slot(f"{name}.radius", parameters.T)[points].T  # (n, G)
        if is_made_of_fibres(rod):
            of_gauss = model.fibre_sections(name)
            density = np.stack(
                [
                    _polynomial(model.slot(f"{name}.mass[{section}]", parameters.T), s[:, g])
                    for g, section in enumerate(of_gauss)
                ],
                axis=1,
            )
        else:
            density = model.slot(f"{name}.density", parameters.T)[0][:, None] * _area(rod) * s**2
        total += length * (density @ shares)
    return np.broadcast_to(total[:, None], paths.joint_angles.shape[:2]).copy()


def _area(rod: Rod) -> float:
    """Return the area of a solid section by S²."""
    kind, ratio = rod.section.kind, rod.section.ratio or 1.0  # type: ignore[union-attr]
    return 4.0 * ratio if kind == "rectangular" else np.pi * ratio


def _polynomial(coefficients: Array, s: Array) -> Array:
    return np.asarray(coefficients[0] + s * (coefficients[1] + s * coefficients[2]))


def _existing(found: Array) -> Array:
    return np.where(np.isneginf(found), np.nan, found)


def _each(
    paths: Paths, names: Iterable[str], evaluate: Callable[[Array, Array], Array]
) -> dict[str, Array]:
    named = tuple(names)
    values = np.full((*paths.q.shape[:2], len(named)), np.nan)
    if named:
        parameters = paths.parameters
        for i, step in np.argwhere(np.isfinite(paths.q).all(axis=2)):
            values[i, step] = evaluate(parameters[i], paths.q[i, step])
    return {name: values[:, :, i] for i, name in enumerate(named)}
