"""Paths of equilibria of many designs."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from flexor._engine import STATUS
from flexor.errors import InputError

if TYPE_CHECKING:
    from flexor._engine import Events
    from flexor.model.geometry import GeometryJacobian, Rows
    from flexor.model.model import Model
    from flexor.model.path import Path

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False, repr=False)
class Batch:
    """Paths of n designs over the same load steps.

    Attributes
    ----------
    model : Model
        The model.
    loads : (steps, inputs) array
        Loads of every input [N].
    q : (n, steps, dof) array
        Generalized coordinates.
    status : (n, steps) array
        Codes of how each step ended, indices of `flexor._engine.STATUS`; `flexor.model.MEANINGS`
        says what each means and what to do.
    stable : (n, steps) bool array
        Whether the equilibrium is a minimum of the potential.
    iterations : (n, steps) array
        Newton iterations.
    residual : (n, steps) array
        Scaled, dimensionless residual.
    energy : (n, steps) array
        Potential [J].
    pairs, touching : (n, steps) arrays
        Touching pairs of spheres, and n_c, the spheres of the contacts' first groups that touch.
    tip_force : (n, steps) array
        F_t (14), the contact force on the tip spheres [N].
    events : dict of arrays
        Snaps of all designs: ``design``, ``step``, ``load``, ``kind``, and the joints' coordinates
        ``before`` and ``after``.
    geometry : Rows or None
        Geometry of the designs; None for the model as it is.
    gradient : (n, joints + 1, slots) array or None
        If it was asked for: total derivatives of the joints' coordinates and, last, of the tip
        force at the last step, with respect to the engine's parameters that
        `Model.geometry_slots` places; NaN where there is no equilibrium.
    regularity : (n,) array of str or None
        What these derivatives are worth: ``"regular"``; ``"snapped"``, where they are those of the
        branch the path ended on and do not see the snap move or vanish; ``"contact-threshold"``,
        where a sphere just touches; ``"nearly-singular"``, where the stiffness all but vanishes;
        ``"no-equilibrium"``.
    """

    model: Model
    loads: Array
    q: Array
    status: NDArray[np.uint8]
    stable: NDArray[np.bool_]
    iterations: NDArray[np.uint32]
    residual: Array
    energy: Array
    pairs: NDArray[np.uint32]
    touching: NDArray[np.uint32]
    tip_force: Array
    events: Events
    geometry: Rows | None
    gradient: Array | None = None
    regularity: NDArray[np.object_] | None = None

    @property
    def force(self) -> Array:
        """Force of the first input, or zeros without one, (steps,) [N]."""
        return self.loads[:, 0] if self.loads.shape[1] else np.zeros(len(self.loads))

    @property
    def joint_angles(self) -> Array:
        """Coordinates of the joints, (n, steps, joints) [rad; m for translations]."""
        return self.q[:, :, self.model.joint_columns]

    @property
    def converged(self) -> NDArray[np.bool_]:
        """Whether each step found an equilibrium, (n, steps)."""
        return np.asarray(self.status == STATUS.index("converged"))

    @property
    def spheres(self) -> int:
        """Number of spheres of the contacts' first groups."""
        return self.model.first_spheres

    def chained(self, jacobian: GeometryJacobian) -> Array:
        """Return derivatives with respect to the parameters from which the geometries were made.

        Parameters
        ----------
        jacobian
            Derivative of the geometries with respect to k parameters, at the points `Model.X`;
            `flexor.design.ParameterSet.jacobian` gives it. The base of a rod that is placed by its
            underside moves with S(0).

        Returns
        -------
        (n, joints + 1, k) array
            Of the joints' coordinates and, last, of the tip force at the last step.

        Raises
        ------
        InputError
            If the batch was evaluated without its gradient.
        """
        if self.gradient is None:
            raise InputError("the batch has no gradient: evaluate it with gradient=True.")
        return np.asarray(self.gradient @ self.model.geometry_slot_jacobian(jacobian))

    def parameters(self, index: int) -> Array:
        """Return the engine's parameters of one design, (P,).

        Parameters
        ----------
        index
            The design.
        """
        parameters = self.model.parameters.copy()
        if self.geometry is not None:
            indices, values = self.model.geometry_slots(self.geometry[index : index + 1])
            parameters[indices] = values[0]
        return parameters

    def __repr__(self) -> str:
        good = int((self.converged & self.stable).all(axis=1).sum())
        return (
            f"<Batch of {self.model.name!r}: {len(self)} designs, {len(self.loads)} steps, "
            f"{good} designs stable throughout>"
        )

    def __len__(self) -> int:
        return len(self.q)

    def __getitem__(self, index: int) -> Path:
        """Return the path of one design."""
        from flexor.model.path import Path

        return Path.of(self, range(len(self))[index])

    def __iter__(self) -> Iterator[Path]:
        return (self[index] for index in range(len(self)))
