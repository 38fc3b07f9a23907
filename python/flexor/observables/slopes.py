"""First-order changes of observables, at one step of each of n paths."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from flexor import _engine
from flexor.arrays import Array
from flexor.materials.laws import engine_name
from flexor.model.derivatives import TIED, Differential, weights
from flexor.model.results import Paths
from flexor.model.structure import Structure
from flexor.observables import quantities

Steps = NDArray[np.intp]
Slope = Callable[[Paths, Steps], Differential]


def output(name: str, weight: Array | float = 1.0) -> Slope:
    """Return the change of a sum of the engine's outputs of one name."""
    return lambda paths, steps: _at(paths, steps, **{name: weight})


def member(name: str, index: int) -> Slope:
    """Return the change of one of the engine's outputs of a name."""

    def slope(paths: Paths, steps: Steps) -> Differential:
        start, stop = paths.model.engine.outputs[name]
        return _at(paths, steps, **{name: np.eye(stop - start)[index]})

    return slope


def bending(paths: Paths, steps: Steps) -> Differential:
    """Return the change of the sum of the angles of the joints."""
    return _at(paths, steps, joints=quantities.is_angular(paths.model).astype(float))


def range_of_motion(paths: Paths, steps: Steps) -> Differential:
    """Return the change of the bending beyond that at the first step."""
    return bending(paths, steps) + bending(paths, np.zeros_like(steps)) * -1.0


def constant(paths: Paths, steps: Steps) -> Differential:
    """Return the change of a count, which is zero between its jumps."""
    return Differential()


def strap_force(paths: Paths, steps: Steps) -> Differential:
    """Return the change of the largest tension of a strap."""
    forces = paths.strap_tension[np.arange(len(paths)), steps]
    which, tied = _largest(forces)
    columns = quantities.strap_outputs(paths.model)
    chosen = np.zeros((len(paths), max(stop for _, stop in paths.model.engine.outputs.values())))
    chosen[np.arange(len(paths)), np.array(list(columns.values()))[which]] = 1.0
    return Differential(((steps, chosen),), tied=tied)


def strap_members(model: Structure) -> dict[str, Slope]:
    """Return the change of the tension of each strap."""
    return {name: member(of, i) for name, (of, i) in model.strap_places.items()}


def strain(paths: Paths, steps: Steps) -> Differential:
    """Return the change of the largest |λ - 1|."""
    stretch = _stretch(paths, steps)
    return _of_stretch(paths, steps, np.abs(stretch - 1.0), np.sign(stretch - 1.0))


def min_stretch(paths: Paths, steps: Steps) -> Differential:
    """Return the change of the smallest λ."""
    stretch = _stretch(paths, steps)
    return _of_stretch(paths, steps, -stretch, np.ones_like(stretch))


def strain_use(paths: Paths, steps: Steps) -> Differential:
    """Return the change of the largest strain as a share of its material's limit."""
    stretch = _stretch(paths, steps)
    limits = quantities.limits(paths.model, "strain_limit")[:, None]
    return _of_stretch(
        paths, steps, np.abs(stretch - 1.0) / limits, np.sign(stretch - 1.0) / limits
    )


def stress_use(paths: Paths, steps: Steps) -> Differential:
    """Return the change of the largest nominal stress as a share of its material's limit."""
    stretch = _stretch(paths, steps)
    n = len(paths)
    use, slope = np.full_like(stretch, np.nan), np.zeros_like(stretch)
    explicit = np.zeros((n, *stretch.shape[1:], paths.model.parameters.size))
    limits = quantities.limits(paths.model, "stress_limit")
    for index, (name, table) in enumerate(paths.model.file.materials.items()):
        if not np.isfinite(limits[index]):
            continue
        start, stop = paths.model.engine.slots[f"{name}.constants"]
        law, wound = engine_name(table.kind), table.winding == "hoop"
        for i, constants in enumerate(paths.parameters[:, start:stop]):
            at = stretch[i, index]
            _, stress, modulus = _engine.fibre_energy(law, constants.tolist(), wound, at)
            sign = np.sign(stress) / limits[index]
            use[i, index], slope[i, index] = sign * stress, sign * modulus
            by_constants = _engine.fibre_stress_slopes(law, constants.tolist(), wound, at)
            explicit[i, index, :, start:stop] = sign[:, None] * by_constants
    return _of_stretch(paths, steps, use, slope, explicit)


def mass(paths: Paths, steps: Steps) -> Differential:
    """Return the change of the mass of all rods."""
    return Differential(explicit=quantities.mass_slopes(paths))


def _at(paths: Paths, steps: Steps, **groups: Array | float) -> Differential:
    return Differential(((steps, weights(paths.model, len(paths), groups)),))


def _stretch(paths: Paths, steps: Steps) -> Array:
    """Return least and greatest stretch of each material, (n, materials, 2)."""
    return np.asarray(paths.stretch[np.arange(len(paths)), steps])


def _of_stretch(
    paths: Paths, steps: Steps, ranked: Array, slope: Array, explicit: Array | None = None
) -> Differential:
    """Return the change of the largest of numbers that depend on stretches each."""
    n = len(paths)
    which, tied = _largest(ranked.reshape(n, -1))
    rows = np.arange(n)
    chosen = np.zeros((n, ranked[0].size))
    chosen[rows, which] = np.nan_to_num(slope.reshape(n, -1)[rows, which])
    own = None
    if explicit is not None:
        own = np.nan_to_num(explicit.reshape(n, chosen.shape[1], -1)[rows, which])
    made = weights(paths.model, n, {"stretch": chosen})
    return Differential(((steps, made),), own, tied)


def _largest(values: Array) -> tuple[Steps, NDArray[np.bool_]]:
    """Return which of each row's numbers is largest, and whether another one equals it."""
    ranked = np.where(np.isnan(values), -np.inf, values)
    which = ranked.argmax(axis=1)
    top = ranked[np.arange(len(ranked)), which][:, None]
    with np.errstate(invalid="ignore"):
        near = np.isfinite(ranked) & (np.abs(ranked - top) <= TIED * np.abs(top))
    return which, np.asarray(near.sum(axis=1) > 1)
