"""How exactly a path is known: what the solver's tolerance leaves open of places and forces."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from flexor.arrays import Array
from flexor.model.schema import Link, Rod

if TYPE_CHECKING:
    from flexor.model.path_quantities import PathQuantities
    from flexor.model.results import Path
    from flexor.model.structure import Structure


# Patterns of signs of the errors of all coordinates that are tried.
PATTERNS = 8


@dataclass(frozen=True)
class Accuracy:
    """What is less than these is not known from 0, at each of s steps; made by `accuracy`.

    An elastic coordinate is known within the tolerance of its unit: one radian, a strain of one
    (docs/method.md, Convergence). All places are then known within that share of the size of the
    model, and forces and moments within that share of those that hold a coordinate moved by one
    unit.

    Attributes
    ----------
    strain : (s,) array
        The tolerance of the solution.
    place : (s,) array
        [m].
    force : (s,) array
        [N].
    moment : (s,) array
        [N m].
    """

    strain: Array
    place: Array
    force: Array
    moment: Array


def accuracy(path: PathQuantities) -> Accuracy:
    """Return how exactly a path is known.

    Parameters
    ----------
    path
        Equilibria of one design.
    """
    model, size = path.model, _size(path.model)
    units = _units(model, size)
    energy = np.zeros(len(path))
    for step in np.flatnonzero(np.isfinite(path.q).all(axis=1)):
        tangent = model.engine.tangent(path.parameters, path.q[step], path.applied[step])
        energy[step] = np.abs(np.diag(tangent) * units**2).max(initial=0.0)
    tolerance = np.nan_to_num(path.tolerance, nan=0.0)
    return Accuracy(tolerance, tolerance * size, tolerance * energy / size, tolerance * energy)


def force_accuracy(path: Path, forces: Callable[[Path], dict[str, Array]]) -> dict[str, Array]:
    """Return how exactly forces are known that follow from where bodies are, each (s,) [N].

    That is how much they change where every coordinate is moved by as much as it is not known, one
    way or the other. A soft spring is known better than a stiff one.

    Parameters
    ----------
    path
        Equilibria of one design.
    forces
        Returns the forces of a path by name, each (s,).
    """
    error = np.nan_to_num(path.tolerance, nan=0.0)[:, None] * _units(path.model, _size(path.model))
    here = forces(path)
    found = {name: np.zeros(len(path)) for name in here}
    for signs in np.random.default_rng(0).choice([-1.0, 1.0], (PATTERNS, error.shape[1])):
        for name, moved in forces(_moved(path, path.q + error * signs)).items():
            found[name] = np.fmax(found[name], np.abs(moved - here[name]))
    return found


def _moved(path: Path, q: Array) -> Path:
    """Return a path with its forces at other coordinates (s, dof)."""
    names = ("spring_tension", "loop_tension", "obstacle_force")
    forces = {name: np.full_like(getattr(path, name), np.nan) for name in names}
    for step in np.flatnonzero(np.isfinite(q).all(axis=1)):
        found = path.model.engine.element_forces(path.parameters, q[step])
        for name, values in forces.items():
            values[step] = found[name]  # type: ignore[literal-required]
    return replace(path, q=q, **forces)


def _size(model: Structure) -> float:
    """Return the length of all bodies [m]."""
    bodies = model.file.bodies.values()
    total = sum(float(each.length) for each in bodies if isinstance(each, (Link, Rod)))
    return total or 1.0


def _units(model: Structure, size: float) -> Array:
    """Return one radian, or what is a strain of one, of each coordinate."""
    found = np.ones(model.engine.dof)
    for i, name in enumerate(model.engine.coordinates):
        body, _, strain = name.rpartition(".")
        if isinstance(rod := model.file.bodies.get(body), Rod) and strain[:4] in ("bend", "twis"):
            found[i] = 1.0 / float(rod.length)
    for joint in model.engine.joints:
        if joint["unit"] == "m":
            found[joint["coordinate"]] = size
    return found
