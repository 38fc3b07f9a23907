"""The arrays of results, sliceable along designs and steps, and how those of components join."""

from __future__ import annotations

from dataclasses import dataclass, field, fields
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from flexor.arrays import Array
from flexor.model.events import each_design, events, take_steps
from flexor.model.geometry import Geometry
from flexor.model.joining import (
    DECIDING,
    EXTREMES,
    GREATEST,
    LARGEST,
    NAN,
    SUM,
    Joining,
    rows,
    shares,
    total,
)

if TYPE_CHECKING:
    from xarray import Dataset

    from flexor.model.followed import Followed
    from flexor.model.structure import Structure

# An array by its leading axes, n for designs and s for steps, and whether a study records it.
_NONE: Any = None
_MODEL = {"axes": "", "recorded": False}
_DESIGN = {"axes": "n", "recorded": False}
_STEP = {"axes": "s", "recorded": False}
_PATH = {"axes": "ns", "recorded": False}
_DESIGN_RECORDED = {"axes": "n", "recorded": True}
_PATH_RECORDED = {"axes": "ns", "recorded": True}


def _found(joining: Joining, recorded: bool = False) -> dict[str, Any]:
    """Return what an array is that the engine finds at each step of each design."""
    return {"axes": "ns", "recorded": recorded, "joining": joining}


@dataclass(frozen=True, eq=False, repr=False)
class Results:
    """The arrays of `Paths`, `Path` and `State`.

    Shapes are those of `Paths`: n designs, s steps. A `Path` has no axis n, `States` have no axis
    s, a `State` has neither. An array that was not evaluated, or not recorded by a study, is None.
    A new array is one field here; of one that the engine finds at each step the field says how it
    follows from those of a model's components.

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
    max_centreline_depth : (n, s) array
        How deep the centreline of a rod is at most in a body that it touches [m], negative outside;
        NaN where no rod touches one.
    max_contact_pressure : (n, s) array
        Largest pressure of contact through skins [Pa], likewise.
    volume : (n, s, pressures) array
        Volume of each cavity under pressure, in the order of the model's pressures [m³].
    rod_bending : (n, s, rods) array
        Angle between both ends of each rod [rad]: in the plane with its sign, in space at most π.
    spring_tension : (n, s, springs) array
        Tension of each of the engine's springs, those of the file before straps [N].
    loop_tension : (n, s, loops) array
        Tension of each strap around a link [N]; see `strap_tension`.
    obstacle_force : (n, s, obstacles) array
        Sum of the normal forces on each obstacle [N].
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

    def __init_subclass__(cls) -> None:
        """Let results with fewer axes be made of those with more."""
        if "axes" in vars(cls):
            _LEVELS[cls.axes] = cls

    model: Structure = field(default=_NONE, metadata=_MODEL)
    followed: Followed = field(default=_NONE, metadata=_MODEL)
    rod_length: Array = field(default=_NONE, metadata=_DESIGN)
    radius: Array = field(default=_NONE, metadata=_DESIGN)
    slope: Array = field(default=_NONE, metadata=_DESIGN)
    loads: Array = field(default=_NONE, metadata=_STEP)
    own_loads: Array = field(default=_NONE, metadata=_PATH)
    q: Array = field(default=_NONE, metadata=_found(rows("coordinates", NAN)))
    joint_angles: Array = field(default=_NONE, metadata=_PATH_RECORDED)
    status: NDArray[np.object_] = field(default=_NONE, metadata=_PATH)
    converged: NDArray[np.bool_] = field(default=_NONE, metadata=_PATH_RECORDED)
    stable: NDArray[np.bool_] = field(default=_NONE, metadata=_PATH_RECORDED)
    stability: NDArray[np.object_] = field(default=_NONE, metadata=_PATH)
    free: NDArray[np.object_] = field(default=_NONE, metadata=_PATH)
    iterations: NDArray[np.uint32] = field(default=_NONE, metadata=_found(SUM))
    residual: Array = field(default=_NONE, metadata=_found(DECIDING))
    tolerance: Array = field(default=_NONE, metadata=_found(DECIDING))
    energy: Array = field(default=_NONE, metadata=_found(total(NAN)))
    pairs: NDArray[np.uint32] = field(default=_NONE, metadata=_found(total(0.0)))
    touching: NDArray[np.integer] = field(default=_NONE, metadata=_found(total(0.0), recorded=True))
    tip_force: Array = field(default=_NONE, metadata=_found(total(0.0), recorded=True))
    applied: Array = field(default=_NONE, metadata=_found(rows("inputs")))
    max_overlap: Array = field(default=_NONE, metadata=_found(LARGEST))
    max_centreline_depth: Array = field(default=_NONE, metadata=_found(GREATEST))
    max_contact_pressure: Array = field(default=_NONE, metadata=_found(LARGEST))
    volume: Array = field(default=_NONE, metadata=_found(rows("pressures", NAN)))
    rod_bending: Array = field(default=_NONE, metadata=_found(rows("rods", NAN)))
    spring_tension: Array = field(default=_NONE, metadata=_found(rows("springs", NAN)))
    loop_tension: Array = field(default=_NONE, metadata=_found(rows("loops", NAN)))
    obstacle_force: Array = field(default=_NONE, metadata=_found(shares("obstacles", NAN)))
    stretch: Array = field(default=_NONE, metadata=_found(EXTREMES))
    tie_loads: Array = field(default=_NONE, metadata=_found(rows("ties", NAN)))
    tie_gaps: Array = field(default=_NONE, metadata=_found(rows("ties")))
    tie_redundancy: Array = field(default=_NONE, metadata=_found(rows("ties", NAN)))
    tie_singularity: Array = field(default=_NONE, metadata=_found(rows("ties")))
    friction: NDArray[np.object_] = field(default=_NONE, metadata=_PATH)
    dissipated: Array = field(default=_NONE, metadata=_found(total(0.0)))
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
    def strap_tension(self) -> Array:
        """Tension of each strap [N], (n, s, straps)."""
        first = {"loops": 0, "springs": self.loop_tension.shape[-1]}
        places = self.model.strap_places.values()
        columns = np.array([first[of] + i for of, i in places], dtype=np.intp)
        return np.concatenate([self.loop_tension, self.spring_tension], axis=-1)[..., columns]

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
        left = "".join(axis for axis in self.axes if not is_integer(index.get(axis)))
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


# By their axes.
_LEVELS: dict[str, type[Results]] = {}


def joinings() -> dict[str, Joining]:
    """Return how each array that the engine finds at each step follows from those of components."""
    found = {each.name: each.metadata.get("joining") for each in fields(Results)}
    return {name: joining for name, joining in found.items() if joining is not None}


def is_integer(index: Any) -> bool:
    """Whether an index takes one entry."""
    return isinstance(index, (int, np.integer))
