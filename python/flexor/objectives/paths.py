"""What objectives read: the paths of equilibria of a batch of designs."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from flexor.errors import InputError

FloatArray = NDArray[np.float64]
BoolArray = NDArray[np.bool_]


class Paths(Protocol):
    """Paths of n designs over the same load steps, the last of which is judged.

    Attributes
    ----------
    force : (steps,) array
        Actuation force [N].
    joint_angles : (n, steps, j) array
        Angles of the finger's joints [rad], flexion positive.
    tip_force : (n, steps) array
        Force of the exosuit's tip on the finger [N].
    touching : (n, steps) array
        Number n_c of the exosuit's spheres that touch the finger.
    spheres : int
        Number of spheres the exosuit has.
    converged, stable : (n, steps) bool arrays
        Whether an equilibrium was found, and whether it is a minimum of the potential.
    """

    @property
    def force(self) -> FloatArray:
        """(steps,)."""
        ...

    @property
    def joint_angles(self) -> FloatArray:
        """(n, steps, j)."""
        ...

    @property
    def tip_force(self) -> FloatArray:
        """(n, steps)."""
        ...

    @property
    def touching(self) -> NDArray[np.integer]:
        """(n, steps)."""
        ...

    @property
    def spheres(self) -> int:
        """One number."""
        ...

    @property
    def converged(self) -> BoolArray:
        """(n, steps)."""
        ...

    @property
    def stable(self) -> BoolArray:
        """(n, steps)."""
        ...


@dataclass(frozen=True)
class OnePath:
    """Path of one design as plain arrays over its load steps; see `Paths` for meaning and units."""

    force: FloatArray
    joint_angles: FloatArray
    tip_force: FloatArray
    touching: NDArray[np.integer]
    converged: BoolArray
    stable: BoolArray


@dataclass(frozen=True)
class PathArrays:
    """`Paths` as plain arrays, of which some designs can be taken.

    Attributes
    ----------
    source : object or None
        What the arrays came from, if it can be asked for the path of one design by index.
    rows : (n,) array or None
        Which of the source's designs these are; all by default.
    """

    force: FloatArray
    joint_angles: FloatArray
    tip_force: FloatArray
    touching: NDArray[np.integer]
    spheres: int
    converged: BoolArray
    stable: BoolArray
    source: Any = None
    rows: NDArray[np.intp] | None = None

    @classmethod
    def of(cls, paths: Paths) -> PathArrays:
        """Read the arrays of any `Paths`."""
        if isinstance(paths, PathArrays):
            return paths
        return cls(
            force=np.asarray(paths.force, dtype=np.float64),
            joint_angles=np.asarray(paths.joint_angles, dtype=np.float64),
            tip_force=np.asarray(paths.tip_force, dtype=np.float64),
            touching=np.asarray(paths.touching),
            spheres=paths.spheres,
            converged=np.asarray(paths.converged, dtype=np.bool_),
            stable=np.asarray(paths.stable, dtype=np.bool_),
            source=paths if hasattr(paths, "__getitem__") else None,
        )

    def __len__(self) -> int:
        return int(self.joint_angles.shape[0])

    def __getitem__(self, index: int) -> Any:
        """Return the path of one design: the source's own, or a `OnePath`."""
        if self.source is not None:
            return self.source[index if self.rows is None else int(self.rows[index])]
        return OnePath(
            self.force,
            self.joint_angles[index],
            self.tip_force[index],
            self.touching[index],
            self.converged[index],
            self.stable[index],
        )

    def take(self, which: BoolArray) -> PathArrays:
        """Return the paths of the designs where ``which`` (n,) is true."""
        rows = np.arange(len(self)) if self.rows is None else self.rows
        return replace(
            self,
            joint_angles=self.joint_angles[which],
            tip_force=self.tip_force[which],
            touching=self.touching[which],
            converged=self.converged[which],
            stable=self.stable[which],
            rows=rows[which],
        )


@dataclass(frozen=True)
class PathGradient:
    """Derivative of values with respect to the state of the paths they came from.

    `chained` takes it to the design parameters, with the engine's derivatives of the state. What is
    not listed (the number of touching spheres) is constant between its jumps.

    Attributes
    ----------
    joint_angles : (n, ..., steps, j) array
        [1/rad].
    tip_force : (n, ..., steps) array
        [1/N].
    """

    joint_angles: FloatArray
    tip_force: FloatArray

    def chained(self, derivatives: FloatArray) -> FloatArray:
        """Return the derivative of the values with respect to k parameters.

        Parameters
        ----------
        derivatives : (n, j + 1, k) array
            Of the joint angles and, last, of the tip force at the last load, as
            `flexor.model.Batch.chained` gives them.

        Returns
        -------
        (n, ..., k) array
            NaN where the derivatives are.

        Raises
        ------
        InputError
            If the values depend on loads before the last.
        """
        if self.joint_angles[..., :-1, :].any() or self.tip_force[..., :-1].any():
            raise InputError(
                "the objective has a gradient at loads before the last, where the engine gives no "
                "derivatives."
            )
        weights = np.concatenate(
            (self.joint_angles[..., -1, :], self.tip_force[..., -1][..., None]), axis=-1
        )
        return np.asarray(np.einsum("n...o,nok->n...k", weights, derivatives))
