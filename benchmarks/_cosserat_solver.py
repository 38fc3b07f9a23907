"""Flexor as a solver of cosseratbench: scenarios in equilibrium, one rod without contact."""

from __future__ import annotations

import _cosserat_model as rods
import numpy as np
from cosseratbench import Capability, Diverged, Scenario, Trajectory

import flexor


class Flexor:
    """Equilibria along the motion of a scenario; its time has no other meaning.

    The first frame is the scenario's initial shape, from which the first equilibrium is found.
    """

    name = "flexor"
    backend_version = flexor.__version__
    capabilities = frozenset({Capability.STRETCH, Capability.SHEAR})

    def run(self, scenario: Scenario, *, n_elements: int, n_frames: int) -> Trajectory:
        """Return the equilibria.

        Raises NotImplementedError if a scenario needs inertia or contact, and Diverged where no
        equilibrium was found.
        """
        if not scenario.quasi_static:
            raise NotImplementedError("the motion is the result, which needs inertia")
        if len(scenario.rods) != 1 or scenario.self_contact:
            raise NotImplementedError("rods can touch each other or themselves")
        (rod,) = scenario.rods
        times = np.linspace(0.0, scenario.duration, n_frames)
        model, start = rods.build(rod, scenario.gravity, n_elements)
        loads = np.zeros((1, 0))
        if rod.end_motion is not None:
            loads = rods.driven(rod.end_motion, times)[1:, None]
        path = model.equilibrium(loads, start=start)
        if not path.converged.all():
            raise Diverged(f"no equilibrium: {path.status[~path.converged][0]}")
        shape = rods.shape(rod, n_elements)
        found = [(shape.nodes, shape.frames[:, :, 1]), *(rods.placed(state) for state in path)]
        found += found[-1:] * (n_frames - len(found))  # nothing changes any more
        nodes, across = (np.stack(each) for each in zip(*found, strict=True))
        return Trajectory(times, (nodes,), (across,))
