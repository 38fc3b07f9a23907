"""A model: a checked file and the engine built from it."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Mapping
from functools import cached_property
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from flexor import _engine
from flexor.design.geometry import Geometry, GeometryJacobian
from flexor.errors import InputError
from flexor.model.follow import follow as follow_loads
from flexor.model.follow import follow_branch
from flexor.model.geometry import DesignSpace, checked_geometry, slot_jacobian, slot_values
from flexor.model.loads import Forces, loads
from flexor.model.lowering import lower
from flexor.model.reading import parse
from flexor.model.results import Path, Paths
from flexor.model.schema import ModelFile, Rod
from flexor.model.start import Start, coordinates, read_start
from flexor.model.units import FORCE, PRESSURE, Dimension
from flexor.model.validation import describe

Array = NDArray[np.float64]
Force = Forces | Mapping[str, Forces]


class Model:
    """A system of rods, links, contacts and actuators, built once and never changed.

    Parameters
    ----------
    file
        The checked model file.
    source
        Where it came from, for messages.

    Raises
    ------
    InputError
        If the engine refuses the model.
    """

    def __init__(self, file: ModelFile, source: str | None = None) -> None:
        self.file = file
        self._description = json.dumps(lower(file), sort_keys=True, separators=(",", ":"))
        try:
            self.engine = _engine.Model(self._description)
        except ValueError as error:
            raise InputError(f"{source or file.name}: {str(error).rstrip('.')}.") from None
        try:
            self._start = Start(coordinates(file.start, self)) if file.start else None
        except InputError as error:
            raise InputError(f"{source or file.name}: {error}") from None

    def __reduce__(self) -> tuple[Callable[[str, str], Model], tuple[str, str]]:
        # A few kilobytes of text, from which another process builds its own engine.
        return rebuilt, (self.file.to_toml(), self.hash)

    def __repr__(self) -> str:
        return f"<Model {self.name!r}: {self.dof} degrees of freedom, {self.hash[:12]}>"

    @property
    def name(self) -> str:
        """Its name."""
        return self.file.name

    @property
    def title(self) -> str:
        """One line about it."""
        return self.file.title

    @property
    def planar(self) -> bool:
        """Whether it lies in the x-z plane."""
        return self.file.planar

    @property
    def dof(self) -> int:
        """Number of generalized coordinates."""
        return self.engine.dof

    @cached_property
    def hash(self) -> str:
        """SHA-256 of its description for the engine, the same for the same mechanics and start."""
        found = hashlib.sha256(self._description.encode())
        if self._start is not None:
            found.update(self._start.q.tobytes())
        return found.hexdigest()

    @cached_property
    def inputs(self) -> tuple[str, ...]:
        """Names of the load inputs."""
        return tuple(self.engine.inputs)

    @cached_property
    def input_dimensions(self) -> dict[str, Dimension]:
        """Dimension of each load input: a force or a pressure."""
        actuators = self.file.actuators
        pressures = {name for name in actuators if actuators[name].kind == "pressure"}
        return {name: PRESSURE if name in pressures else FORCE for name in self.inputs}

    def load_unit(self, index: int = 0) -> tuple[float, str]:
        """Return the unit in which loads of an input are shown, in SI and by name."""
        dimensions = list(self.input_dimensions.values())
        force = index >= len(dimensions) or dimensions[index] is FORCE
        return (1.0, "N") if force else (1e3, "kPa")

    @cached_property
    def pressures(self) -> tuple[str, ...]:
        """Names of the pressures."""
        return tuple(name for name, kind in self.input_dimensions.items() if kind is PRESSURE)

    @cached_property
    def rods(self) -> tuple[str, ...]:
        """Names of the rods."""
        return tuple(name for name, body in self.file.bodies.items() if isinstance(body, Rod))

    @cached_property
    def joint_columns(self) -> NDArray[np.intp]:
        """Which coordinates belong to joints, (joints,)."""
        return np.array([joint["coordinate"] for joint in self.engine.joints], dtype=np.intp)

    @cached_property
    def joints(self) -> tuple[str, ...]:
        """Names of the joints' coordinates."""
        return tuple(joint["name"] for joint in self.engine.joints)

    @cached_property
    def angular_joints(self) -> tuple[str, ...]:
        """Names of the joints' coordinates that are angles."""
        return tuple(joint["name"] for joint in self.engine.joints if joint["unit"] == "rad")

    @cached_property
    def body_frames(self) -> dict[str, tuple[int, int]]:
        """Range of each body's frames: the sample points of a rod, both ends of a link."""
        frames = self.engine.body_frames
        return {name: frames[name] for name in self.file.bodies}

    @cached_property
    def sphere_groups(self) -> dict[str, int]:
        """Number of spheres of each group."""
        groups = self.engine.sphere_groups
        return {name: stop - start for name, (start, stop) in groups.items()}

    @cached_property
    def first_spheres(self) -> int:
        """Number of spheres of the contacts' first groups."""
        groups = {contact.first for contact in self.file.contacts.values()}
        return sum(self.sphere_groups[name] for name in groups)

    @cached_property
    def design(self) -> DesignSpace:
        """The rod that is designed and the bounds of the search.

        Raises
        ------
        InputError
            If the file has no ``[design]``.
        """
        return DesignSpace.of(self.file)

    @property
    def X(self) -> Array:
        """Sample points of the designed rod, X in [0, 1], (P,)."""
        return self.design.points

    @cached_property
    def parameters(self) -> Array:
        """The engine's parameters, (P,)."""
        return self.engine.parameters

    @cached_property
    def evaluation_forces(self) -> Array:
        """Loads at which a design is evaluated, from zero in the file's steps [N or Pa]."""
        evaluation = self.file.evaluation
        last, step = float(evaluation.force), float(evaluation.step)
        if self.inputs and self.input_dimensions[self.inputs[0]] is PRESSURE:
            if evaluation.pressure is None:
                raise InputError(f'the model "{self.name}" has no evaluation.pressure: give it.')
            last = float(evaluation.pressure)
            step = float(evaluation.pressure_step or last / 5.0)
        steps = max(1, round(last / step))
        return np.linspace(0.0, last, steps + 1)

    def slot(self, name: str, parameters: Array | None = None) -> Array:
        """Return parameters of the engine by name.

        Parameters
        ----------
        name
            Such as ``"exosuit.radius"``.
        parameters : (P,) array
            Where to look; the model's own unless given.
        """
        start, stop = self.engine.slots[name]
        return (self.parameters if parameters is None else parameters)[start:stop]

    def geometry_slots(self, geometry: Geometry) -> tuple[NDArray[np.intp], Array]:
        """Place the geometry of the designed rod among the engine's parameters.

        Parameters
        ----------
        geometry
            Geometry of n designs at the points `X`.

        Returns
        -------
        indices, values : (k,) and (n, k) arrays
            Which parameters change, and to what.

        Raises
        ------
        InputError
            If it is not given at the rod's sample points.
        """
        return slot_values(self.file, self.design.rod, self.engine.slots, geometry)

    def geometry_slot_jacobian(self, jacobian: GeometryJacobian) -> Array:
        """Differentiate the values of `geometry_slots`, with the same linear map.

        Parameters
        ----------
        jacobian
            Derivative of the geometry of n designs with respect to k parameters.

        Returns
        -------
        (n, slots, k) array
            Rows in the order of the indices of `geometry_slots`.
        """
        return slot_jacobian(self.file, self.design.rod, jacobian)

    def evaluate(
        self,
        geometry: Geometry,
        force: Force | None = None,
        threads: int = 0,
        *,
        gradient: bool = False,
        start: Any = None,
        **options: float,
    ) -> Paths:
        """Follow the equilibria of many designs, in parallel.

        Memory is what the `Paths` hold: 8 bytes for each design, step and degree of freedom, and
        a little more.

        Parameters
        ----------
        geometry
            Geometry of n designs at the points `X`.
        force
            As for `equilibrium`.
        threads
            How many; 0 for one per core. Results do not depend on it.
        gradient
            Whether to differentiate the joints' coordinates and the tip force at the last step,
            exactly, with respect to the geometry: `Paths.gradient` and `Paths.regularity`, and
            `Paths.chained` with respect to the parameters of a set.
        start
            As for `equilibrium`.
        **options
            Settings of the engine's solver.

        Raises
        ------
        InputError
            If forces, geometry or options cannot be used.
        """
        batch = checked_geometry(self.file, self.design.rod, geometry)
        begin = self._begin(start)
        loads = self._loads(force)
        return follow_loads(self, batch, loads, threads, options, gradient, begin)

    def equilibrium(
        self,
        force: Force | None = None,
        design: Geometry | None = None,
        *,
        start: Any = None,
        follow: Literal["load", "arc-length"] = "load",
        **options: float,
    ) -> Path:
        """Follow the equilibrium (9) through the given loads.

        Parameters
        ----------
        force
            Forces in N, texts with a unit, ``"start:stop:step"``, or a table of these by the name
            of the input; the steps to the file's evaluation force unless given. They may rise,
            fall and be negative. The path starts without load even if its first force is not zero.
        design
            Geometry of the designed rod (n = 1); the file's own unless given.
        start
            Where the path begins: a `State` or a `Path` (its last step), under the loads of that
            state; the name of a file that ``flexor simulate --json`` printed, likewise; or, without
            load, coordinates by name such as ``{"ph_1": "20 deg", "exosuit.bend_y": "90 deg"}``.
            The file's ``[start]`` unless given, and otherwise the reference state. The path's first
            equilibrium is the one that the energy leads to from there.
        follow
            ``"load"`` follows stable equilibria from load to load and jumps where they end.
            ``"arc-length"`` follows one branch through its limit points, stable or not, until it
            reaches the last load: the steps of the path are the points it takes, limit points and
            all equilibria at the given loads among them, with the loads found there.
        **options
            Settings of the engine's solver.

        Raises
        ------
        InputError
            If forces, geometry or options cannot be used.
        """
        batch = None if design is None else checked_geometry(self.file, self.design.rod, design)
        if batch is not None and len(batch) != 1:
            raise InputError(f"design has {len(batch)} designs: give one, or use Model.evaluate.")
        begin, loads = self._begin(start), self._loads(force)
        if follow == "arc-length":
            return follow_branch(self, batch, loads, options, begin)[0]
        if follow != "load":
            raise InputError(f'follow is {describe(follow)}: expected "load" or "arc-length".')
        return follow_loads(self, batch, loads, 1, options, start=begin)[0]

    def _begin(self, start: Any) -> Start | None:
        return self._start if start is None else read_start(start, self)

    def _loads(self, force: Force | None) -> Array:
        if force is not None:
            return loads(force, self.input_dimensions)
        if not self.inputs:
            return np.zeros((1, 0))
        return loads(self.evaluation_forces, self.input_dimensions)


def rebuilt(text: str, hash: str) -> Model:
    """Build a model that was pickled, and see that it is the same.

    Parameters
    ----------
    text
        The model file.
    hash
        `Model.hash` of the model.

    Raises
    ------
    InputError
        If the text now describes other mechanics: this is another version of Flexor.
    """
    model = Model(parse(text))
    if model.hash != hash:
        raise InputError(
            f'the model "{model.name}" was made by another version of Flexor: its description has '
            f"the hash {hash[:12]} there and {model.hash[:12]} here."
        )
    return model
