"""Types of the compiled engine.

Shapes: n designs, s load steps, D degrees of freedom, U load inputs, P parameters. SI units; angles
in rad. What each array means is written with the engine.
"""

from collections.abc import Sequence
from typing import TypedDict

import numpy as np
from numpy.typing import ArrayLike, NDArray

STATUS: list[str]
STABILITY: list[str]
EVENTS: list[str]
REGULARITY: list[str]
FUSED_MULTIPLY_ADD: bool

class SolverOption(TypedDict):
    default: float
    minimum: float
    exclusive: bool  # whether the minimum itself is left out
    maximum: float
    integer: bool
    doc: str

SOLVER_OPTIONS: dict[str, SolverOption]

class JointCoordinate(TypedDict):
    name: str
    body: str  # that the joint carries
    kind: str  # as in model files
    coordinate: int  # index among the coordinates
    axis: list[float]  # of its rotation or translation, in the joint's frame
    unit: str  # "rad" or "m"

class Events(TypedDict):
    design: NDArray[np.uint32]
    load: NDArray[np.float64]
    step: NDArray[np.uint32]
    kind: NDArray[np.uint8]
    before: NDArray[np.float64]
    after: NDArray[np.float64]

class Friction(TypedDict):
    """A row for each of m points with friction."""

    design: NDArray[np.uint64]
    step: NDArray[np.uint64]
    friction: NDArray[np.uint64]  # index in the description
    sphere: NDArray[np.uint64]
    other: NDArray[np.uint64]  # body, or surface of an obstacle
    place: NDArray[np.float64]  # (m, 3)
    force: NDArray[np.float64]  # (m, 3), on the first body
    slip: NDArray[np.float64]  # (m, 3)
    limit: NDArray[np.float64]
    slides: NDArray[np.bool_]

class Paths(TypedDict):
    """Arrays over n designs and s steps, (n, s) unless stated; a branch has one design."""

    q: NDArray[np.float64]
    status: NDArray[np.uint8]
    stability: NDArray[np.uint8]
    iterations: NDArray[np.uint32]
    residual: NDArray[np.float64]
    tolerance: NDArray[np.float64]
    energy: NDArray[np.float64]
    pairs: NDArray[np.uint32]
    touching: NDArray[np.uint32]
    tip_force: NDArray[np.float64]
    max_overlap: NDArray[np.float64]
    max_centreline_depth: NDArray[np.float64]
    max_contact_pressure: NDArray[np.float64]
    volume: NDArray[np.float64]  # (…, pressures)
    rod_bending: NDArray[np.float64]  # (…, rods)
    spring_tension: NDArray[np.float64]  # (…, springs)
    loop_tension: NDArray[np.float64]  # (…, loops)
    obstacle_force: NDArray[np.float64]  # (…, obstacles)
    stretch: NDArray[np.float64]  # (…, materials, 2): least and greatest
    tie_loads: NDArray[np.float64]  # (…, ties, 7): force, moment, drive
    tie_gaps: NDArray[np.float64]  # (…, ties, 2): distance, angle
    tie_redundancy: NDArray[np.float64]  # (…, ties): redundant conditions
    tie_singularity: NDArray[np.float64]  # (…, ties): shares in a singular configuration
    applied: NDArray[np.float64]  # (n, s, U), loads; of controlled inputs those found
    dissipated: NDArray[np.float64]
    friction: Friction
    free: NDArray[np.uint64]  # (m, 3): design, step, coordinate
    events: Events

class Branch(Paths):
    """Paths of one design, with the points of the branch as steps."""

    loads: NDArray[np.float64]  # (s, U), found along the branch

class Derivatives(TypedDict):
    by_parameters: NDArray[np.float64]  # (sums, wanted)
    by_loads: NDArray[np.float64]  # (sums, U), by the conjugate of controlled inputs
    regularity: NDArray[np.uint8]  # (sums,), codes of REGULARITY

class PathDerivatives(TypedDict):
    by_parameters: NDArray[np.float64]  # (n, numbers, wanted)
    by_loads: NDArray[np.float64]  # (n, numbers, s, U), by the conjugate of controlled inputs
    regularity: NDArray[np.uint8]  # (n, numbers), codes of REGULARITY

class ElementForces(TypedDict):
    spring_tension: NDArray[np.float64]
    loop_tension: NDArray[np.float64]
    obstacle_force: NDArray[np.float64]

class Contacts(TypedDict):
    first: NDArray[np.uint32]
    second: NDArray[np.int64]
    cone: NDArray[np.bool_]
    force: NDArray[np.float64]
    point: NDArray[np.float64]
    depth: NDArray[np.float64]
    pressure: NDArray[np.float64]

def cancel() -> None: ...  # ends all solves that are running, with KeyboardInterrupt
def cpu_runs() -> list[str]: ...
def fibre_energy(
    law: str, constants: Sequence[float], wound: bool, stretch: ArrayLike
) -> list[NDArray[np.float64]]: ...
def fibre_stress_slopes(
    law: str, constants: Sequence[float], wound: bool, stretch: ArrayLike
) -> NDArray[np.float64]: ...  # (stretches, constants)
def sample_points(
    elements: int, gauss_points: int, tip_intervals: int = 1
) -> NDArray[np.float64]: ...

class Model:
    def __init__(self, description_json: str) -> None: ...
    @property
    def planar(self) -> bool: ...
    @property
    def dof(self) -> int: ...
    @property
    def coordinates(self) -> list[str]: ...
    @property
    def inputs(self) -> list[str]: ...
    @property
    def parameters(self) -> NDArray[np.float64]: ...
    @property
    def slots(self) -> dict[str, tuple[int, int]]: ...
    @property
    def slot_units(self) -> dict[str, str | None]: ...
    @property
    def joints(self) -> list[JointCoordinate]: ...
    @property
    def body_frames(self) -> dict[str, tuple[int, int]]: ...
    @property
    def sphere_groups(self) -> dict[str, tuple[int, int]]: ...
    def path(
        self,
        slot_indices: ArrayLike,
        values: ArrayLike,
        loads: ArrayLike,
        threads: int = 0,
        *,
        steps: int | None = None,
        base: ArrayLike | None = None,
        start: ArrayLike | None = None,
        slips: ArrayLike | None = None,  # (m, 6): friction, sphere, other, slip
        **solver_options: float,
    ) -> Paths: ...
    @property
    def outputs(self) -> dict[str, tuple[int, int]]: ...
    def differentiate(
        self,
        slot_indices: ArrayLike,
        values: ArrayLike,
        designs: ArrayLike,  # of each equilibrium
        q: ArrayLike,
        applied: ArrayLike,
        sums: ArrayLike,  # the equilibrium of each, increasing
        weights: ArrayLike,  # (sums, outputs)
        wanted: ArrayLike,
        threads: int = 0,
    ) -> Derivatives: ...
    def differentiate_paths(
        self,
        slot_indices: ArrayLike,
        values: ArrayLike,
        loads: ArrayLike,
        parts: ArrayLike,  # (m, 3): design, in increasing order, number, step
        weights: ArrayLike,  # (m, outputs)
        numbers: int,
        wanted: ArrayLike,
        threads: int = 0,
        *,
        steps: int | None = None,
        base: ArrayLike | None = None,
        start: ArrayLike | None = None,
        slips: ArrayLike | None = None,
        **solver_options: float,
    ) -> PathDerivatives: ...
    def branch(
        self,
        parameters: ArrayLike,
        loads: ArrayLike,
        *,
        start: ArrayLike | None = None,
        **solver_options: float,
    ) -> Branch: ...
    def energy(self, parameters: ArrayLike, q: ArrayLike, u: ArrayLike) -> float: ...
    def residual(
        self, parameters: ArrayLike, q: ArrayLike, u: ArrayLike
    ) -> NDArray[np.float64]: ...
    def tangent(self, parameters: ArrayLike, q: ArrayLike, u: ArrayLike) -> NDArray[np.float64]: ...
    def actuator_lengths(self, parameters: ArrayLike, q: ArrayLike) -> NDArray[np.float64]: ...
    def volumes(self, parameters: ArrayLike, q: ArrayLike) -> NDArray[np.float64]: ...
    def element_forces(self, parameters: ArrayLike, q: ArrayLike) -> ElementForces: ...
    def tendon_lengths(self, parameters: ArrayLike, q: ArrayLike) -> NDArray[np.float64]: ...
    def tendon_tensions(
        self, parameters: ArrayLike, q: ArrayLike, u: ArrayLike
    ) -> NDArray[np.float64]: ...
    def tendon_arms(self, parameters: ArrayLike, q: ArrayLike) -> NDArray[np.float64]: ...
    def tendon_paths(
        self, parameters: ArrayLike, q: ArrayLike
    ) -> list[list[list[list[float]]]]: ...
    def stretch_frames(self, parameters: ArrayLike, q: ArrayLike) -> NDArray[np.int64]: ...
    def frames(self, parameters: ArrayLike, q: ArrayLike) -> NDArray[np.float64]: ...
    def has_structure_of(self, other: Model) -> bool: ...
    def frame_names(self) -> list[str]: ...
    def spheres(self, parameters: ArrayLike, q: ArrayLike) -> NDArray[np.float64]: ...
    def contacts(self, parameters: ArrayLike, q: ArrayLike) -> Contacts: ...
