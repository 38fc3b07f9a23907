"""Equilibrium paths of n designs over load steps, sliceable down to one path and one step."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, fields
from typing import Any, ClassVar, cast, overload

import numpy as np
from numpy.typing import NDArray

from flexor.arrays import Array
from flexor.display import Displayed
from flexor.errors import InputError
from flexor.model.contact_forces import ContactForces
from flexor.model.extremes import Extreme, contact_pressure, extremes
from flexor.model.friction import POINT, FrictionForces, friction_forces
from flexor.model.geometry import GeometryJacobian
from flexor.model.path_document import path_document
from flexor.model.path_quantities import PathQuantities
from flexor.model.result_arrays import Results

_Several = slice | list[int] | NDArray[Any]


@dataclass(frozen=True, eq=False, repr=False)
class State(Results):
    """One equilibrium of one design, ``path[step]``; path-level fields are those of its path."""

    axes: ClassVar[str] = ""

    def __repr__(self) -> str:
        ends = str(self.stability)
        load = self.model.show_loads(self.loads)
        return f"<State of {self.model.name!r}: {load}, {self.status}, {ends}>"

    def frames(self) -> dict[str, Array]:
        """Return the frames along each body, base to tip.

        Returns
        -------
        dict of (m, 4, 4) arrays
            By body: homogeneous matrices (1) in the world [m], of a rod at its sample points, of a
            link at its joint and its tip.
        """
        found = self.model.engine.frames(self.parameters, self.q)
        return {body: found[start:stop] for body, (start, stop) in self.model.body_frames.items()}

    def spheres(self) -> dict[str, Array]:
        """Return the contact spheres.

        Returns
        -------
        dict of (m, 4) arrays
            By group: centre x, y, z and radius [m].
        """
        engine = self.model.engine
        found = engine.spheres(self.parameters, self.q)
        return {group: found[start:stop] for group, (start, stop) in engine.sphere_groups.items()}

    def contact_forces(self) -> ContactForces:
        """Return the contact forces (8)."""
        return ContactForces(**self.model.engine.contacts(self.parameters, self.q))

    def friction_forces(self) -> FrictionForces:
        """Return the friction at the points that touch, as of the path that led there."""
        points: Any = self.friction
        none = np.zeros(0, dtype=POINT)
        return friction_forces(self.model, none if points is None else points)

    def contact_pressure(self) -> dict[str, Array]:
        """Return X and contact pressure along bodies; see `flexor.model.extremes`."""
        return contact_pressure(self)

    def extremes(self) -> dict[str, Extreme]:
        """Return the largest overlap, pressure and strain with their places, likewise."""
        return extremes(self)


@dataclass(frozen=True, eq=False, repr=False)
class States(Results):
    """One step of n designs, ``paths[:, step]``; ``states[i]`` is a `State`."""

    axes: ClassVar[str] = "n"

    @property
    def length(self) -> Array:
        """Lengths of the designed rod, for use as a geometry, (n,) [m]."""
        return self.rod_length

    def __len__(self) -> int:
        return len(self.joint_angles)

    @overload
    def __getitem__(self, design: int | np.integer) -> State: ...
    @overload
    def __getitem__(self, design: _Several) -> States: ...
    def __getitem__(self, design: Any) -> State | States:
        return cast("State | States", self._take(design))

    def __iter__(self) -> Iterator[State]:
        return (self[index] for index in range(len(self)))


@dataclass(frozen=True, eq=False, repr=False)
class Path(Displayed, PathQuantities):
    """Equilibria of one design over load steps, each followed from the one before.

    ``path[step]`` is a `State`, ``path[start:stop]`` a part of the path.
    """

    axes: ClassVar[str] = "s"

    def __repr__(self) -> str:
        failed = self.status[~self.converged]
        worst = failed[0] if len(failed) else ""
        ends = worst or next((str(s) for s in self.stability if s != "stable"), "stable")
        snaps = f", {len(self.events)} events" if self.events else ""
        steps = f"{len(self)} steps to {self.model.show_loads(self.loads[-1])}"
        return f"<Path of {self.model.name!r}: {steps}, {ends}{snaps}>"

    @overload
    def __getitem__(self, step: int | np.integer) -> State: ...
    @overload
    def __getitem__(self, step: _Several) -> Path: ...
    def __getitem__(self, step: Any) -> State | Path:
        return cast("State | Path", self._take(step))

    def __iter__(self) -> Iterator[State]:
        return (self[step] for step in range(len(self)))

    @property
    def as_batch(self) -> Paths:
        """The same as paths of one design."""
        arrays: dict[str, Any] = {}
        for each in fields(self):
            value = getattr(self, each.name)
            if value is not None and each.metadata["axes"].startswith("n"):
                table = each.name == "event_table"
                one = np.fromiter([value], dtype=object, count=1) if table else None
                value = np.asarray(value)[None] if one is None else one
            arrays[each.name] = value
        return Paths(**arrays)

    def frames(self, step: int = -1) -> dict[str, Array]:
        """Return the frames along each body in one step; see `State.frames`."""
        return self[step].frames()

    def spheres(self, step: int = -1) -> dict[str, Array]:
        """Return the contact spheres in one step; see `State.spheres`."""
        return self[step].spheres()

    def contact_forces(self, step: int = -1) -> ContactForces:
        """Return the contact forces (8) in one step."""
        return self[step].contact_forces()

    def friction_forces(self, step: int = -1) -> FrictionForces:
        """Return the friction at the points that touch in one step."""
        return self[step].friction_forces()

    def to_dict(self) -> dict[str, Any]:
        """Return what ``flexor simulate --json`` prints: plain lists with one entry per step.

        Returns
        -------
        dict
            ``force`` (of the first input; with several, ``loads`` has all by name) [N],
            ``joint_angles`` [rad], ``converged``, ``stable``, ``contacts`` (n_c),
            ``tip_force`` [N], with pressures ``volume`` [m³] by their names, with chambers and
            cables ``length`` [m] likewise, of controlled inputs what was found as ``pressure``
            [Pa] or ``tension`` [N], with ``ties`` what each does to its second place, as ``force``
            [N] and ``moment`` [N·m] in the world and, if it is driven, ``drive`` [N or N·m], with
            straps ``strap_force`` [N], with tendons ``tendon_length`` [m] and ``tendon_force`` [N],
            and with obstacles
            ``obstacle_force`` [N] likewise, with friction ``friction``, for each point that touches
            what has friction, ``place`` [m], ``force`` on the first body and its ``limit`` [N],
            elastic ``slip`` [m] and whether it ``slides``, and the energy ``dissipated`` so far
            [J], with contacts ``max_overlap`` [m], with skins
            ``max_contact_pressure`` [Pa], with materials ``max_strain`` and ``min_stretch`` of a
            fibre, with an unwound cavity ``hoop_strain``, an estimate; ``places`` of the largest
            of these (``body``, ``X`` and the body that it is ``on``), and `warnings`;
            ``events`` (those on the way to the step), and
            ``q``, the generalized coordinates by which another path can start there, with their
            names ``coordinates``; a number that does not exist is None.
        """
        return path_document(self)


@dataclass(frozen=True, eq=False, repr=False)
class Paths(Results):
    """Paths of n designs over the same load steps.

    ``paths[i]`` is a `Path`, ``paths[i, step]`` a `State`, ``paths[:, step]`` are `States`; slices,
    masks and lists of indices give `Paths` again.
    """

    axes: ClassVar[str] = "ns"

    @classmethod
    def failed(
        cls,
        count: int,
        steps: int,
        joints: int,
        reason: str,
        parameters: int | None = None,
        constraints: int = 0,
        objectives: int = 0,
    ) -> Paths:
        """Paths of ``count`` designs that could not be evaluated, for this reason.

        With the number of ``parameters`` of their set they have `derivatives`, of NaN.
        """
        derived: dict[str, Any] = {}
        if parameters is not None:
            derived["derivatives"] = np.full((count, joints + 1, parameters), np.nan)
            derived["value_gradient"] = np.full((count, parameters), np.nan)
            derived["constraint_gradients"] = np.full((count, constraints, parameters), np.nan)
            derived["regularity"] = np.full(count, "no-equilibrium", dtype=object)
            absent = np.full((count, constraints), "no-equilibrium", dtype=object)
            derived["constraint_regularity"] = absent
        return cls(
            value=np.full(count, np.inf),
            shown=np.full(count, np.nan),
            objective_values=np.full((count, objectives), np.nan),
            reason=np.full(count, reason, dtype=object),
            constraint_values=np.full((count, constraints), np.nan),
            violation=np.full(count, np.inf),
            joint_angles=np.full((count, steps, joints), np.nan),
            tip_force=np.full((count, steps), np.nan),
            touching=np.zeros((count, steps), dtype=np.int32),
            converged=np.zeros((count, steps), dtype=np.bool_),
            stable=np.zeros((count, steps), dtype=np.bool_),
            event_count=np.zeros(count, dtype=np.int64),
            total_iterations=np.zeros(count, dtype=np.int64),
            **derived,
        )

    @classmethod
    def concatenate(cls, parts: Sequence[Paths]) -> Paths:
        """Join paths of one model over the same loads; arrays that a part lacks are left out."""
        if len(parts) == 1:
            return parts[0]
        first, joined = parts[0], dict[str, Any]()
        for each in fields(cls):
            column = [getattr(part, each.name) for part in parts]
            if "n" not in each.metadata["axes"]:
                joined[each.name] = getattr(first, each.name)
            elif all(array is not None for array in column):
                joined[each.name] = np.concatenate(column)
        return cls(**joined)

    def recorded(self, without: Sequence[str] = ()) -> Paths:
        """Return the same paths with those arrays only that a study records."""
        recorded = [each.name for each in fields(self) if each.metadata["recorded"]]
        return Paths(**{name: getattr(self, name) for name in recorded if name not in without})

    def scatter(self, into: Paths, rows: NDArray[np.intp]) -> None:
        """Write these paths into rows of others, as far as both have the same arrays."""
        for each in fields(self):
            mine, target = getattr(self, each.name), getattr(into, each.name)
            if mine is not None and target is not None and "n" in each.metadata["axes"]:
                target[rows] = mine

    def chained(self, jacobian: GeometryJacobian) -> Array:
        """Return derivatives with respect to the parameters from which the geometries were made.

        Parameters
        ----------
        jacobian
            Derivative of the geometries with respect to p parameters, at the points `Model.X`;
            `flexor.design.ParameterSet.jacobian` gives it. The base of a rod that is placed by its
            underside moves with S(0).

        Returns
        -------
        (n, joints + 1, p) array
            Of the joints' coordinates and, last, of the tip force at the last step.

        Raises
        ------
        InputError
            If they were evaluated without gradient.
        """
        if self.gradient is None:
            raise InputError("the paths have no gradient: evaluate them with gradient=True.")
        return np.asarray(self.gradient @ self.model.geometry_slot_jacobian(jacobian))

    @property
    def length(self) -> Array:
        """Lengths of the designed rod, for use as a geometry, (n,) [m]."""
        return self.rod_length

    def __repr__(self) -> str:
        good = int((self.converged & self.stable).all(axis=1).sum())
        count, steps = self.converged.shape
        name = "recorded designs" if self.model is None else repr(self.model.name)
        return f"<Paths of {name}: {count} designs, {steps} steps, {good} stable throughout>"

    def __len__(self) -> int:
        return len(self.joint_angles)

    @overload
    def __getitem__(self, key: int | np.integer) -> Path: ...
    @overload
    def __getitem__(self, key: tuple[int, int]) -> State: ...
    @overload
    def __getitem__(self, key: tuple[int, slice]) -> Path: ...
    @overload
    def __getitem__(self, key: tuple[slice, int]) -> States: ...
    @overload
    def __getitem__(self, key: slice | list[int] | NDArray[Any] | tuple[slice, slice]) -> Paths: ...
    def __getitem__(self, key: Any) -> State | States | Path | Paths:
        return cast("State | States | Path | Paths", self._take(key))

    def __iter__(self) -> Iterator[Path]:
        return (self[index] for index in range(len(self)))
