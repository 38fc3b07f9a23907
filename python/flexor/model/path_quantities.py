"""Quantities of one path that follow from its coordinates: lengths, tensions, strains, warnings."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np

from flexor.arrays import Array
from flexor.errors import unknown
from flexor.model.extremes import extremes
from flexor.model.hoop import hoop_strains
from flexor.model.limits import (
    ballooning_cavities,
    cables_pushed,
    folded_rods,
    joints_exceeded,
    materials_exceeded,
    skins_exceeded,
    straps_exceeded,
    ties_redundant,
)
from flexor.model.result_arrays import Results


@dataclass(frozen=True, eq=False, repr=False)
class PathQuantities(Results):
    """Quantities of `Path`, with one entry per step."""

    def __len__(self) -> int:
        return len(self.loads)

    def length(self, actuator: str) -> Array:
        """Return the length of a chamber's or cable's path [m], (s,).

        NaN where there is no equilibrium.
        """
        threads = self.model.threads
        if actuator not in threads:
            raise unknown("chamber or cable", actuator, threads)
        return self.lengths()[actuator]

    def lengths(self) -> dict[str, Array]:
        """Return those of all chambers and cables, by name."""
        return self._each(self.model.threads, self.model.engine.actuator_lengths)

    def found_loads(self) -> dict[str, Array]:
        """Return the force or pressure of each controlled input [N or Pa], (s,)."""
        inputs = self.model.inputs
        return {name: self.applied[:, inputs.index(name)] for name in self.model.controlled}

    def strap_forces(self) -> dict[str, Array]:
        """Return the tension of each strap [N], (s,); NaN where there is no equilibrium."""
        return dict(zip(self.model.file.straps, self.strap_tension.T, strict=True))

    def tendon_lengths(self) -> dict[str, Array]:
        """Return the length of each tendon [m], (s,); NaN where there is no equilibrium."""
        return self._each(self.model.tendons, self.model.engine.tendon_lengths)

    def tendon_forces(self) -> dict[str, Array]:
        """Return the tension of each tendon [N], likewise."""
        engine, tendons = self.model.engine, self.model.tendons
        values = np.full((len(self), len(tendons)), np.nan)
        for step in np.flatnonzero(np.isfinite(self.q).all(axis=1)) if tendons else ():
            values[step] = engine.tendon_tensions(self.parameters, self.q[step], self.applied[step])
        return dict(zip(tendons, values.T, strict=True))

    def moment_arms(self) -> dict[str, dict[str, Array]]:
        """Return -∂ℓ/∂q of each tendon by each joint's coordinate [m; 1 for translations], (s,).

        Of an angle it is the moment arm, positive where the tendon's tension increases the angle.
        """
        tendons, joints = self.model.tendons, self.model.joints
        values = np.full((len(self), len(tendons), len(joints)), np.nan)
        for step in np.flatnonzero(np.isfinite(self.q).all(axis=1)) if tendons else ():
            arms = self.model.engine.tendon_arms(self.parameters, self.q[step])
            values[step] = arms[:, self.model.joint_columns]
        return {
            tendon: {joint: values[:, i, j] for j, joint in enumerate(joints)}
            for i, tendon in enumerate(tendons)
        }

    def tie_forces(self) -> dict[str, Array]:
        """Return the magnitude of the force that each tie transmits [N], (s,)."""
        return dict(
            zip(self.model.ties, np.linalg.norm(self.tie_loads[..., :3], axis=2).T, strict=True)
        )

    def tie_moments(self) -> dict[str, Array]:
        """Return that of the moment about the second place of each tie [N·m], (s,)."""
        sizes = np.linalg.norm(self.tie_loads[..., 3:6], axis=2).T
        return dict(zip(self.model.ties, sizes, strict=True))

    def tie_drives(self) -> dict[str, Array]:
        """Return the force [N] or moment [N·m] that drives each driven tie, (s,)."""
        driven = {name: i for i, name in enumerate(self.model.ties) if name in self.model.inputs}
        return {name: self.tie_loads[:, i, 6] for name, i in driven.items()}

    def obstacle_forces(self) -> dict[str, Array]:
        """Return the sum of the normal forces on each obstacle [N], likewise."""
        return dict(zip(self.model.file.obstacles, self.obstacle_force.T, strict=True))

    def _each(
        self, names: Iterable[str], evaluate: Callable[[Array, Array], Array]
    ) -> dict[str, Array]:
        """Evaluate a function of parameters and coordinates at each equilibrium, by names."""
        named = tuple(names)
        values = np.full((len(self), len(named)), np.nan)
        for step in np.flatnonzero(np.isfinite(self.q).all(axis=1)) if named else ():
            values[step] = evaluate(self.parameters, self.q[step])
        return dict(zip(named, values.T, strict=True))

    @property
    def warnings(self) -> list[str]:
        """Materials, skins, straps, cables, joints, cavities, rods and ties, a sentence each."""
        checks = (
            materials_exceeded,
            skins_exceeded,
            straps_exceeded,
            cables_pushed,
            joints_exceeded,
            ballooning_cavities,
            folded_rods,
            ties_redundant,
        )
        return [sentence for check in checks for sentence in check(self)]

    def hoop_strain(self) -> dict[str, Array]:
        """Return the estimated hoop strain of cavities without winding, (s,), by pressure.

        See `flexor.model.hoop`.
        """
        return {
            name: self.applied[:, self.model.input_of(name)] * strain.max()
            for name, _, strain in hoop_strains(self)
        }

    @property
    def contact_quantities(self) -> tuple[str, ...]:
        """Names of the contact quantities that the model has."""
        if self.max_overlap is None:
            return ()
        overlap = ("max_overlap",) if self.model.first_spheres else ()
        skins = ("max_contact_pressure",) if self.model.has_skins else ()
        return (*overlap, *skins)

    def places(self) -> dict[str, list[dict[str, Any] | None]]:
        """Return where `State.extremes` are, a list over the steps for each quantity."""
        found: dict[str, list[dict[str, Any] | None]] = {}
        for step in np.flatnonzero(np.isfinite(self.q).all(axis=1)):
            for key, each in extremes(self._take(int(step))).items():
                row = found.setdefault(key, [None] * len(self))
                row[step] = {"body": each.body, "X": each.X, "on": each.on}
        return found
