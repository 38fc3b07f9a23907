"""The path of equilibria of one design."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from flexor._engine import EVENTS, STATUS
from flexor.model import state
from flexor.model.state import ContactForces

if TYPE_CHECKING:
    from flexor.model.batch import Batch
    from flexor.model.model import Model

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Event:
    """A branch of equilibria that ended on the way, and where the model went.

    Attributes
    ----------
    kind : str
        What happened, one of `flexor._engine.EVENTS`.
    step : int
        The step of the path during which it happened, or 0 if before it.
    force : float
        The force of the first input at that moment [N].
    angles_before, angles_after : (joints,) arrays
        Coordinates of the joints on both sides [rad; m for translations].
    """

    kind: str
    step: int
    force: float
    angles_before: Array
    angles_after: Array


@dataclass(frozen=True, eq=False, repr=False)
class Path:
    """Equilibria of one design over load steps, each followed from the one before.

    Attributes
    ----------
    model : Model
        The model.
    parameters : (P,) array
        The engine's parameters of this design.
    loads : (steps, inputs) array
        Loads of every input [N].
    q : (steps, dof) array
        Generalized coordinates.
    status : tuple of str
        How each step ended, ``"converged"`` or what went wrong; `flexor.model.MEANINGS` says what
        each means and what to do.
    stable : (steps,) bool array
        Whether the equilibrium is a minimum of the potential.
    iterations, residual, energy : (steps,) arrays
        Newton iterations, scaled dimensionless residual, potential [J].
    pairs, touching : (steps,) arrays
        Touching pairs of spheres, and n_c, the spheres of the contacts' first groups that touch.
    tip_force : (steps,) array
        F_t (14), the contact force on the tip spheres [N].
    events : tuple of Event
        Snaps on the way.
    """

    model: Model
    parameters: Array
    loads: Array
    q: Array
    status: tuple[str, ...]
    stable: NDArray[np.bool_]
    iterations: NDArray[np.uint32]
    residual: Array
    energy: Array
    pairs: NDArray[np.uint32]
    touching: NDArray[np.uint32]
    tip_force: Array
    events: tuple[Event, ...]

    @classmethod
    def of(cls, batch: Batch, index: int) -> Path:
        """Take the path of one design out of a batch."""
        model, events = batch.model, batch.events
        return cls(
            model=model,
            parameters=batch.parameters(index),
            loads=batch.loads,
            q=batch.q[index],
            status=tuple(STATUS[code] for code in batch.status[index]),
            stable=batch.stable[index],
            iterations=batch.iterations[index],
            residual=batch.residual[index],
            energy=batch.energy[index],
            pairs=batch.pairs[index],
            touching=batch.touching[index],
            tip_force=batch.tip_force[index],
            events=tuple(
                Event(
                    kind=EVENTS[events["kind"][row]],
                    step=int(events["step"][row]),
                    force=float(events["load"][row][0]) if batch.loads.shape[1] else 0.0,
                    angles_before=events["before"][row],
                    angles_after=events["after"][row],
                )
                for row in np.flatnonzero(events["design"] == index)
            ),
        )

    def __repr__(self) -> str:
        worst = next((word for word in self.status if word != "converged"), "")
        state = worst or ("stable" if self.stable.all() else "unstable")
        snaps = f", {len(self.events)} events" if self.events else ""
        steps = f"{len(self)} steps to {self.force[-1]:g} N"
        return f"<Path of {self.model.name!r}: {steps}, {state}{snaps}>"

    def __len__(self) -> int:
        return len(self.loads)

    @property
    def force(self) -> Array:
        """Force of the first input, or zeros without one, (steps,) [N]."""
        return self.loads[:, 0] if self.loads.shape[1] else np.zeros(len(self.loads))

    @property
    def joint_angles(self) -> Array:
        """Coordinates of the joints, (steps, joints) [rad; m for translations]."""
        return self.q[:, self.model.joint_columns]

    @property
    def converged(self) -> NDArray[np.bool_]:
        """Whether each step found an equilibrium, (steps,)."""
        return np.array([status == "converged" for status in self.status])

    def frames(self, step: int = -1) -> dict[str, Array]:
        """Return the frames along each body, base to tip.

        Parameters
        ----------
        step
            A step of the path.

        Returns
        -------
        dict of (m, 4, 4) arrays
            By body: homogeneous matrices (1) in the world [m], of a rod at its sample points, of a
            link at its joint and its tip.
        """
        ranges = self.model.body_frames
        return state.frames(self.model.engine, self.parameters, self.q[step], ranges)

    def spheres(self, step: int = -1) -> dict[str, Array]:
        """Return the contact spheres.

        Parameters
        ----------
        step
            A step of the path.

        Returns
        -------
        dict of (m, 4) arrays
            By group: centre x, y, z and radius [m].
        """
        return state.spheres(self.model.engine, self.parameters, self.q[step])

    def contact_forces(self, step: int = -1) -> ContactForces:
        """Return the contact forces (8).

        Parameters
        ----------
        step
            A step of the path.
        """
        return state.contact_forces(self.model.engine, self.parameters, self.q[step])

    def to_dict(self) -> dict[str, Any]:
        """Return what ``flexor simulate --json`` prints: plain lists with one entry per step.

        Returns
        -------
        dict
            ``force`` (of the first input; with several, ``loads`` has all by name) [N],
            ``joint_angles`` [rad], ``converged``, ``stable``, ``contacts`` (n_c),
            ``tip_force`` [N] and ``events`` (those on the way to the step); a number that does not
            exist is None.
        """
        events: list[list[dict[str, Any]]] = [[] for _ in range(len(self))]
        for event in self.events:
            events[event.step].append(
                {
                    "kind": event.kind,
                    "force": event.force,
                    "angles_before": _plain(event.angles_before),
                    "angles_after": _plain(event.angles_after),
                }
            )
        inputs = self.model.inputs
        several = {name: _plain(self.loads[:, i]) for i, name in enumerate(inputs)}
        return {
            "force": _plain(self.force),
            **({"loads": several} if len(inputs) > 1 else {}),
            "joint_angles": _plain(self.joint_angles),
            "converged": self.converged.tolist(),
            "stable": self.stable.tolist(),
            "contacts": self.touching.tolist(),
            "tip_force": _plain(self.tip_force),
            "events": events,
        }


def _plain(values: Array) -> list[Any]:
    if values.ndim > 1:
        return [_plain(row) for row in values]
    return [value if math.isfinite(value) else None for value in values.tolist()]
