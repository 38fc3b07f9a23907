"""Equilibrium paths of n designs over load steps, sliceable down to one path and one step."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field, fields
from typing import TYPE_CHECKING, Any, ClassVar, cast, overload

import numpy as np
from numpy.typing import NDArray

from flexor.arrays import Array
from flexor.display import Displayed
from flexor.errors import InputError, unknown
from flexor.model.contact_forces import ContactForces
from flexor.model.events import each_design, events, take_steps
from flexor.model.extremes import Extreme, contact_pressure, extremes
from flexor.model.followed import Followed
from flexor.model.friction import POINT, FrictionForces, described, friction_forces
from flexor.model.geometry import Geometry, GeometryJacobian
from flexor.model.hoop import hoop_strains
from flexor.model.limits import (
    ballooning_cavities,
    folded_rods,
    joints_exceeded,
    materials_exceeded,
    skins_exceeded,
    straps_exceeded,
    ties_redundant,
)
from flexor.model.structure import Structure

if TYPE_CHECKING:
    from xarray import Dataset

_Several = slice | list[int] | NDArray[Any]


# An array by its leading axes, n for designs and s for steps, and whether a study records it.
_NONE: Any = None
_MODEL = {"axes": "", "recorded": False}
_DESIGN = {"axes": "n", "recorded": False}
_STEP = {"axes": "s", "recorded": False}
_PATH = {"axes": "ns", "recorded": False}
_DESIGN_RECORDED = {"axes": "n", "recorded": True}
_PATH_RECORDED = {"axes": "ns", "recorded": True}


@dataclass(frozen=True, eq=False, repr=False)
class Results:
    """The arrays of `Paths`, `Path` and `State`.

    Shapes are those of `Paths`: n designs, s steps. A `Path` has no axis n, `States` have no axis
    s, a `State` has neither. An array that was not evaluated, or not recorded by a study, is None.
    A new array is one field here.

    Attributes
    ----------
    model : Model
        The model.
    followed : Followed
        How the engine followed the paths beside their loads.
    rod_length, radius, slope : (n,), (n, m) and (n, m) arrays
        Geometry of the designed rod, see `flexor.model.Geometry` [m]; None for the model as it is.
    slots : (n, P) array
        All of the engine's parameters, of designs that were not given by a geometry.
    loads : (s, inputs) array
        Loads of every input [N or Pa; m or m³ of one that is controlled by its length or volume].
    own_loads : (n, s, inputs) array
        Loads of designs that have their own; ``loads`` are then those of the first.
    applied : (n, s, inputs) array
        The same, but of controlled inputs the force or pressure that was found [N or Pa].
    q : (n, s, dof) array
        Generalized coordinates.
    joint_angles : (n, s, joints) array
        Coordinates of the joints [rad; m for translations].
    status : (n, s) array of str
        Status of each step, ``"converged"`` or the reason of its failure; `flexor.model.MEANINGS`
        has the meaning of each and a remedy.
    converged, stable : (n, s) bool arrays
        Whether an equilibrium was found, and whether its stability is ``"stable"``.
    stability : (n, s) array of str
        Static stability, one of `flexor._engine.STABILITY`: ``"stable"``; ``"neutral"``, where some
        motion has no stiffness; ``"unstable"``; ``"flutter-undecided"``, where a complex pair of
        eigenvalues has a negative real part, so that masses decide; ``"unknown"``, where there is
        no equilibrium or the check failed.
    free : (n, s) array of tuples of str
        Coordinates of free motions: those that take part in motions without stiffness.
    iterations : (n, s) array
        Newton iterations.
    residual : (n, s) array
        Largest residual of a coordinate, as a fraction of the forces that act on it.
    tolerance : (n, s) array
        Its bound: the requested tolerance plus the rounding of the terms that balance.
    energy : (n, s) array
        Potential [J], without the work of controlled inputs.
    pairs, touching : (n, s) arrays
        Touching pairs of spheres, and n_c, the spheres of the contacts' first groups that touch.
    tip_force : (n, s) array
        F_t (14), the contact force on the tip [N].
    max_overlap : (n, s) array
        Largest overlap of bodies in contact [m]; zero where nothing touches.
    max_contact_pressure : (n, s) array
        Largest pressure of contact through skins [Pa], likewise.
    volume : (n, s, pressures) array
        Volume of each cavity under pressure, in the order of the model's pressures [m³].
    rod_bending : (n, s, rods) array
        Angle between both ends of each rod [rad]: in the plane with its sign, in space at most π.
    stretch : (n, s, materials, 2) array
        Least and greatest stretch of the fibres of each of the file's materials; NaN if no section
        has it.
    tie_loads : (n, s, ties, 7) array
        What each tie does to its second place: force [N], moment about that place [N·m], both in
        the world, and the force or moment that drives it, zero of a tie that is not driven.
    tie_gaps : (n, s, ties, 2) array
        How far each tie is from being closed: a distance [m] and an angle [rad].
    tie_redundancy : (n, s, ties) array
        Number of conditions of each tie that follow from others before them in the file.
    tie_singularity : (n, s, ties) array
        Where the status is ``"singular"``, the share of each tie in what becomes dependent there.
    friction : (n, s) array of structured arrays
        Points with friction of each state; see `flexor.model.friction`. None without friction.
    dissipated : (n, s) array
        Energy that friction dissipated along the path up to each step [J]; zero without friction.
    event_table : (n,) array of structured arrays
        Events along the path as arrays with the fields of `Event`; see `events`.
    event_count, total_iterations : (n,) arrays
        Events and Newton iterations along the whole path.
    gradient : (n, joints + 1, slots) array
        Total derivatives of the joints' coordinates and, last, of the tip force at the last step,
        with respect to the engine's parameters that `Model.geometry_slots` places; NaN where there
        is no equilibrium.
    derivatives : (n, joints + 1, p) array
        The same with respect to the p parameters of a set.
    value_gradient : (n, p) array
        Derivatives of the value of a study's objective with respect to the parameters of its set.
    constraint_gradients : (n, c, p) array
        The same of the values of its constraints, each at the place and the load where it is worst.
    constraint_regularity : (n, c) array of str
        Whether these hold, as `regularity`; ``"no-derivative"`` where an observable has none.
    regularity : (n,) array of str
        Whether derivatives hold, in a study those of the objective's value: ``"regular"``;
        ``"snapped"``, where they are those of the branch that a path was on and do not see the snap
        move or vanish; ``"contact-threshold"``, where a sphere just touches; ``"nearly-singular"``,
        where the stiffness all but vanishes;
        ``"tied"``, where it is that of the largest of several numbers and another one equals it;
        ``"no-equilibrium"``.
    value : (n,) array
        Value of the objective of a study; +inf where the design failed, never NaN.
    shown : (n,) array
        The objective's quantity for display; NaN where the design failed.
    objective_values : (n, m) array
        Value of each of several objectives of a study, to be minimised, SI; no columns with one.
    reason : (n,) array of str
        Empty, or why the design failed.
    constraint_values : (n, c) array
        Worst value along the path of what each constraint of a study bounds, SI.
    violation : (n,) array
        Sum of what constraints are exceeded by, each by its bound; 0 where all are kept, +inf where
        the design failed.
    """

    axes: ClassVar[str] = ""

    model: Structure = field(default=_NONE, metadata=_MODEL)
    followed: Followed = field(default=_NONE, metadata=_MODEL)
    rod_length: Array = field(default=_NONE, metadata=_DESIGN)
    radius: Array = field(default=_NONE, metadata=_DESIGN)
    slope: Array = field(default=_NONE, metadata=_DESIGN)
    loads: Array = field(default=_NONE, metadata=_STEP)
    own_loads: Array = field(default=_NONE, metadata=_PATH)
    q: Array = field(default=_NONE, metadata=_PATH)
    joint_angles: Array = field(default=_NONE, metadata=_PATH_RECORDED)
    status: NDArray[np.object_] = field(default=_NONE, metadata=_PATH)
    converged: NDArray[np.bool_] = field(default=_NONE, metadata=_PATH_RECORDED)
    stable: NDArray[np.bool_] = field(default=_NONE, metadata=_PATH_RECORDED)
    stability: NDArray[np.object_] = field(default=_NONE, metadata=_PATH)
    free: NDArray[np.object_] = field(default=_NONE, metadata=_PATH)
    iterations: NDArray[np.uint32] = field(default=_NONE, metadata=_PATH)
    residual: Array = field(default=_NONE, metadata=_PATH)
    tolerance: Array = field(default=_NONE, metadata=_PATH)
    energy: Array = field(default=_NONE, metadata=_PATH)
    pairs: NDArray[np.uint32] = field(default=_NONE, metadata=_PATH)
    touching: NDArray[np.integer] = field(default=_NONE, metadata=_PATH_RECORDED)
    tip_force: Array = field(default=_NONE, metadata=_PATH_RECORDED)
    applied: Array = field(default=_NONE, metadata=_PATH)
    max_overlap: Array = field(default=_NONE, metadata=_PATH)
    max_contact_pressure: Array = field(default=_NONE, metadata=_PATH)
    volume: Array = field(default=_NONE, metadata=_PATH)
    rod_bending: Array = field(default=_NONE, metadata=_PATH)
    stretch: Array = field(default=_NONE, metadata=_PATH)
    tie_loads: Array = field(default=_NONE, metadata=_PATH)
    tie_gaps: Array = field(default=_NONE, metadata=_PATH)
    tie_redundancy: Array = field(default=_NONE, metadata=_PATH)
    tie_singularity: Array = field(default=_NONE, metadata=_PATH)
    friction: NDArray[np.object_] = field(default=_NONE, metadata=_PATH)
    dissipated: Array = field(default=_NONE, metadata=_PATH)
    slots: Array = field(default=_NONE, metadata=_DESIGN)
    event_table: NDArray[np.object_] = field(default=_NONE, metadata=_DESIGN)
    event_count: NDArray[np.int64] = field(default=_NONE, metadata=_DESIGN_RECORDED)
    total_iterations: NDArray[np.int64] = field(default=_NONE, metadata=_DESIGN_RECORDED)
    gradient: Array = field(default=_NONE, metadata=_DESIGN)
    derivatives: Array = field(default=_NONE, metadata=_DESIGN_RECORDED)
    value_gradient: Array = field(default=_NONE, metadata=_DESIGN_RECORDED)
    constraint_gradients: Array = field(default=_NONE, metadata=_DESIGN_RECORDED)
    constraint_regularity: NDArray[np.object_] = field(default=_NONE, metadata=_DESIGN)
    regularity: NDArray[np.object_] = field(default=_NONE, metadata=_DESIGN_RECORDED)
    value: Array = field(default=_NONE, metadata=_DESIGN_RECORDED)
    shown: Array = field(default=_NONE, metadata=_DESIGN_RECORDED)
    objective_values: Array = field(default=_NONE, metadata=_DESIGN_RECORDED)
    reason: NDArray[np.object_] = field(default=_NONE, metadata=_DESIGN_RECORDED)
    constraint_values: Array = field(default=_NONE, metadata=_DESIGN_RECORDED)
    violation: Array = field(default=_NONE, metadata=_DESIGN_RECORDED)

    @property
    def force(self) -> Array:
        """Load of the first input, or zeros without one, (s,)."""
        if self.loads.shape[-1] == 0:
            return np.zeros(self.loads.shape[:-1])
        return self.loads[..., 0]

    def to_xarray(self) -> Dataset:
        """Return the arrays with names and units of their axes; needs the extra ``xarray``.

        Dimensions are ``design`` and ``step``, as far as there are several, and those of each
        array. ``to_netcdf(FILE, engine="h5netcdf")`` of the result writes a file.
        """
        from flexor.model.dataset import results_dataset

        return results_dataset(self)

    @property
    def max_strain(self) -> Array:
        """Largest strain |λ - 1| of a fibre, (n, s); NaN without fibres or equilibrium."""
        strain = np.abs(self.stretch - 1.0)
        return np.asarray(np.fmax.reduce(strain, axis=(-2, -1), initial=np.nan))

    @property
    def min_stretch(self) -> Array:
        """Smallest stretch of a fibre, (n, s); where it is not above 0, a section folds."""
        return np.asarray(np.fmin.reduce(self.stretch, axis=(-2, -1), initial=np.nan))

    @property
    def parameters(self) -> Array:
        """The engine's parameters, (n, P)."""
        if self.slots is not None:
            return self.slots
        every = np.broadcast_to(self.model.parameters, (*self._count, self.model.parameters.size))
        every = every.copy()
        if self.radius is not None:
            geometry = Geometry(self.rod_length, self.radius, self.slope)
            indices, values = self.model.geometry_slots(geometry)
            every[..., indices] = values if self._count else values[0]
        return every

    @property
    def events(self) -> Any:
        """Events along the path: a tuple of `Event`, or an (n,) array of these."""
        if self.event_table is None:
            return None
        one = "n" not in self.axes
        return events(self.event_table) if one else each_design(events, self.event_table)

    @property
    def _count(self) -> tuple[int, ...]:
        """Number of designs, for shapes: (n,), or () where there is one."""
        return self.joint_angles.shape[:1] if "n" in self.axes else ()

    @property
    def sphere_count(self) -> int:
        """Number of spheres of the contacts' first groups."""
        return self.model.first_spheres

    def _take(self, key: Any) -> Any:
        """Take designs and steps, each axis as NumPy does."""
        keys = key if isinstance(key, tuple) else (key,)
        if len(keys) > len(self.axes):
            raise IndexError(f"{type(self).__name__} has {len(self.axes)} axes, got {len(keys)}.")
        index = dict(zip(self.axes, keys, strict=False))
        left = "".join(axis for axis in self.axes if not _is_integer(index.get(axis)))
        taken: dict[str, Any] = {}
        for each in fields(self):
            value, place = getattr(self, each.name), 0
            for axis in each.metadata["axes"]:
                if value is not None and axis in self.axes:
                    value = value[(slice(None),) * place + (index.get(axis, slice(None)),)]
                    place += axis in left
            taken[each.name] = value
        if taken["own_loads"] is not None and "n" not in left:
            taken["loads"] = taken["own_loads"]
        if taken["event_table"] is not None and "s" in index:
            places = np.full(len(self.loads), -1)
            kept = np.atleast_1d(np.arange(len(self.loads))[index["s"]])
            places[kept] = np.arange(len(kept))
            taken["event_table"] = take_steps(taken["event_table"], places)
        return _LEVELS[left](**taken)


@dataclass(frozen=True, eq=False, repr=False)
class State(Results):
    """One equilibrium of one design, ``path[step]``; path-level fields are those of its path."""

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
class Path(Displayed, Results):
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

    def __len__(self) -> int:
        return len(self.loads)

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
        inputs = self.model.inputs
        several = {name: _plain(self.loads[:, i]) for i, name in enumerate(inputs)}
        by_step: list[list[dict[str, Any]]] = [[] for _ in range(len(self))]
        for event in self.events:
            by_step[event.step].append(
                {
                    "kind": event.kind,
                    "force": event.force,
                    **(_loads(event.loads, inputs) if len(inputs) > 1 else {}),
                    "angles_before": _plain(event.angles_before),
                    "angles_after": _plain(event.angles_after),
                }
            )
        return {
            "force": _plain(self.force),
            **({"loads": several} if len(inputs) > 1 else {}),
            "joint_angles": _plain(self.joint_angles),
            "converged": self.converged.tolist(),
            "stable": self.stable.tolist(),
            "contacts": self.touching.tolist(),
            "tip_force": _plain(self.tip_force),
            **self._device_quantities(),
            "events": by_step,
            "coordinates": self.model.engine.coordinates,
            "q": _plain(self.q),
        }

    def length(self, actuator: str) -> Array:
        """Return the length of a chamber's or cable's path [m], (s,).

        NaN where there is no equilibrium.
        """
        threads = self.model.threads
        if actuator not in threads:
            raise unknown("chamber or cable", actuator, threads)
        return self._lengths()[actuator]

    def _lengths(self) -> dict[str, Array]:
        return self._each(self.model.threads, self.model.engine.actuator_lengths)

    def found_loads(self) -> dict[str, Array]:
        """Return the force or pressure of each controlled input [N or Pa], (s,)."""
        inputs = self.model.inputs
        return {name: self.applied[:, inputs.index(name)] for name in self.model.controlled}

    def strap_forces(self) -> dict[str, Array]:
        """Return the tension of each strap [N], (s,); NaN where there is no equilibrium."""
        engine, straps = self.model.engine, self.model.file.straps
        loops = [name for name, strap in straps.items() if strap.listed() == "loops"]
        springs = [*self.model.file.springs, *(name for name in straps if name not in loops)]
        tensions = self._each(loops, engine.loop_tensions)
        if len(loops) < len(straps):
            tensions |= self._each(springs, engine.spring_tensions)
        return {name: tensions[name] for name in straps}

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
        return self._each(self.model.file.obstacles, self.model.engine.obstacle_forces)

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
        """Materials, skins, straps, joints, cavities, rods and ties, a sentence each."""
        checks = (
            materials_exceeded,
            skins_exceeded,
            straps_exceeded,
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
        if self.max_overlap is None or not self.model.first_spheres:
            return ()
        skins = ("max_contact_pressure",) if self.model.foundations else ()
        return ("max_overlap", *skins)

    def places(self) -> dict[str, list[dict[str, Any] | None]]:
        """Return where `State.extremes` are, a list over the steps for each quantity."""
        found: dict[str, list[dict[str, Any] | None]] = {}
        for step in np.flatnonzero(np.isfinite(self.q).all(axis=1)):
            for key, each in self[int(step)].extremes().items():
                row = found.setdefault(key, [None] * len(self))
                row[step] = {"body": each.body, "X": each.X, "on": each.on}
        return found

    def _device_quantities(self) -> dict[str, Any]:
        shown: dict[str, Any] = {}
        pressures = self.model.pressures
        if pressures and self.volume is not None:
            shown["volume"] = {name: _plain(self.volume[:, i]) for i, name in enumerate(pressures)}
        if self.model.threads:
            shown["length"] = {name: _plain(found) for name, found in self._lengths().items()}
        for name, found in self.found_loads().items():
            kind = "pressure" if name in pressures else "tension"
            shown.setdefault(kind, {})[name] = _plain(found)
        if forces := self.strap_forces():
            shown["strap_force"] = {name: _plain(force) for name, force in forces.items()}
        if self.model.tendons:
            each = (
                ("tendon_length", self.tendon_lengths()),
                ("tendon_force", self.tendon_forces()),
            )
            shown |= {key: {n: _plain(v) for n, v in found.items()} for key, found in each}
        if forces := self.obstacle_forces():
            shown["obstacle_force"] = {name: _plain(force) for name, force in forces.items()}
        if self.friction is not None:
            shown["friction"] = [described(self.model, points) for points in self.friction]
            shown["dissipated"] = _plain(self.dissipated)
        if self.model.ties and self.tie_loads is not None:
            shown["ties"] = {
                name: {
                    "force": _plain(self.tie_loads[:, i, :3]),
                    "moment": _plain(self.tie_loads[:, i, 3:6]),
                    **(
                        {"drive": _plain(self.tie_loads[:, i, 6])}
                        if name in self.model.inputs
                        else {}
                    ),
                }
                for i, name in enumerate(self.model.ties)
            }
        if self.stretch is not None and self.stretch.size and not np.isnan(self.stretch).all():
            shown["max_strain"] = _plain(self.max_strain)
            shown["min_stretch"] = _plain(self.min_stretch)
        shown |= {key: _plain(getattr(self, key)) for key in self.contact_quantities}
        if hoop := self.hoop_strain():
            shown["hoop_strain"] = {name: _plain(strain) for name, strain in hoop.items()}
        if places := self.places():
            shown["places"] = places
        if self.model.file.materials or self.model.file.straps or self.model.ties:
            shown["warnings"] = self.warnings
        return shown


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


_LEVELS: dict[str, type[Results]] = {each.axes: each for each in (State, States, Path, Paths)}


def _loads(loads: Array, inputs: Sequence[str]) -> dict[str, dict[str, float]]:
    return {"loads": dict(zip(inputs, loads.tolist(), strict=True))}


def _is_integer(index: Any) -> bool:
    return isinstance(index, (int, np.integer))


def _plain(values: Array) -> list[Any]:
    if values.ndim > 1:
        return [_plain(row) for row in values]
    return [value if math.isfinite(value) else None for value in values.tolist()]
