"""The structure of a model: its file, its engine, and the names and counts of its parts."""

from __future__ import annotations

import hashlib
import json
import math
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from flexor import _engine
from flexor.arrays import Array
from flexor.errors import InputError
from flexor.model.components import components
from flexor.model.geometry import DesignSpace, Geometry, GeometryJacobian
from flexor.model.loads import loads
from flexor.model.lowering import lower
from flexor.model.schema import ModelFile, Rod
from flexor.model.schema.friction import frictions, rough_tendons
from flexor.model.schema.shared_input import dimensions, inputs_of
from flexor.model.separate import Separate
from flexor.model.units import FORCE, Dimension
from flexor.model.variants import weights


class Structure:
    """A model without methods for equilibria, the base of `flexor.model.Model`."""

    def __init__(self, file: ModelFile, source: str | None = None) -> None:
        self.file = file
        self._description = json.dumps(lower(file), sort_keys=True, separators=(",", ":"))
        try:
            self.engine = _engine.Model(self._description)
        except ValueError as error:
            raise InputError(f"{source or file.name}: {str(error).rstrip('.')}.") from None

    @cached_property
    def followed(self) -> _engine.Model | Separate:
        """What follows its paths: the engine, or that of each of its independent components."""
        found = components(self._described)
        return Separate(self.engine, self._described, found) if found else self.engine

    @cached_property
    def digest(self) -> str:
        """SHA-256 of its description for the engine."""
        return hashlib.sha256(self._description.encode()).hexdigest()

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
    def inputs(self) -> tuple[str, ...]:
        """Names of the load inputs."""
        return tuple(self.engine.inputs)

    @cached_property
    def input_dimensions(self) -> dict[str, Dimension]:
        """Dimension of each load input: a force, moment or pressure, or the factor of a wrench.

        For a controlled input it is the change of a volume or a length, for a driven tie the
        displacement or rotation.
        """
        found = dimensions(self.file)
        return {name: found[name] for name in self.inputs}

    def input_of(self, force: str) -> int:
        """Return the index of the load input of a chamber, a cable, a pressure or another force."""
        return self.inputs.index(self.driven_by[force])

    @cached_property
    def driven_by(self) -> dict[str, str]:
        """The name of the input of each force that has a load: its own, or one that it shares."""
        return inputs_of(self.file)

    @property
    def variants(self) -> dict[str, float]:
        """Weights of the file's variants, by name; `flexor.load` applies one."""
        return weights({"variants": self.file.variants}, self.name)

    @cached_property
    def controlled(self) -> dict[str, Dimension]:
        """Controlled inputs, with the dimension of the load that is found."""
        found = self.file.actuators.items()
        return {name: each.applied for name, each in found if each.loads is not each.applied}

    @cached_property
    def pressures(self) -> tuple[str, ...]:
        """Names of the pressures."""
        actuators = self.file.actuators
        return tuple(name for name, each in actuators.items() if each.kind == "pressure")

    @cached_property
    def threads(self) -> tuple[str, ...]:
        """Names of the chambers and cables."""
        return tuple(name for name in self.file.actuators if name not in self.pressures)

    def load_unit(self, index: int = 0) -> tuple[float, str]:
        """Return the unit in which loads of an input are shown, in SI and by name."""
        return [*self.input_dimensions.values(), FORCE][index].shown

    def load_name(self, index: int = 0) -> str:
        """Return the kind of the loads of an input, such as ``"force"``."""
        return [*self.input_dimensions.values(), FORCE][index].noun

    def show_load(self, load: float, spec: str = "g", index: int = 0) -> str:
        """Format a load of an input with its unit, such as ``"60 kPa"``."""
        size, unit = self.load_unit(index)
        shown = f"{load / size:{spec}}"
        return f"{shown} {unit}" if unit else f"{self.load_name(index)} {shown}"

    def show_loads(self, loads: Array, spec: str = "g") -> str:
        """Show the loads of all inputs, such as ``"60 kPa"`` or ``"left 60 kPa, line 2 N"``."""
        shown = [self.show_load(load, spec, index) for index, load in enumerate(loads.tolist())]
        if len(shown) > 1:
            shown = [f"{name} {text}" for name, text in zip(self.inputs, shown, strict=True)]
        return ", ".join(shown) or self.show_load(0.0, spec)

    @cached_property
    def strap_places(self) -> dict[str, tuple[str, int]]:
        """For each strap which of the engine's ``"loops"`` or ``"springs"`` it is."""
        straps = self.file.straps
        loops = [name for name, strap in straps.items() if strap.listed() == "loops"]
        springs = [*self.file.springs, *(name for name in straps if name not in loops)]
        lists = {"loops": loops, "springs": springs}
        places = {name: (of, i) for of, each in lists.items() for i, name in enumerate(each)}
        return {name: places[name] for name in straps}

    @cached_property
    def ties(self) -> tuple[str, ...]:
        """Names of the ties."""
        return tuple(self.file.ties)

    @cached_property
    def tendons(self) -> tuple[str, ...]:
        """Names of the tendons."""
        return tuple(self.file.tendons)

    @cached_property
    def muscles(self) -> tuple[str, ...]:
        """Names of the tendons that are muscles."""
        return tuple(name for name, each in self.file.tendons.items() if each.kind == "muscle")

    @cached_property
    def frictions(self) -> tuple[str, ...]:
        """Names of what has friction: contacts, obstacles, rods with a skin, then tendons."""
        contacts = (each.entry for each in frictions(self.file))
        return (*contacts, *rough_tendons(self.file))

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
    def joint_labels(self) -> dict[str, str]:
        """Short names of the joints' coordinates: the body's, where its joint has one."""
        bodies = [joint["body"] for joint in self.engine.joints]
        return {
            joint["name"]: joint["body"] if bodies.count(joint["body"]) == 1 else joint["name"]
            for joint in self.engine.joints
        }

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
    def _described(self) -> dict[str, Any]:
        described: dict[str, Any] = json.loads(self._description)
        return described

    @property
    def foundations(self) -> list[dict[str, Any]]:
        """Contacts through skins, as described to the engine."""
        found: list[dict[str, Any]] = self._described.get("foundations", [])
        return found

    @property
    def has_skins(self) -> bool:
        """Whether bodies press on each other, or on obstacles, through skins."""
        return bool(self.foundations) or any(
            obstacle.get("skins") for obstacle in self._described.get("obstacles", ())
        )

    def fibre_sections(self, rod: str) -> list[int]:
        """Return which of its sections a rod of fibres has at each Gauss point."""
        described = {each["rod"]: each["of_gauss"] for each in self._described.get("fibres", ())}
        found: list[int] = described[rod]
        return found

    @property
    def description(self) -> dict[str, Any]:
        """What it is to the engine: SI numbers, every list explicit. Not to be changed."""
        return self._described

    @cached_property
    def sphere_places(self) -> tuple[tuple[str, float | None], ...]:
        """Body of each sphere, and X if it is a rod."""
        found: list[tuple[str, float | None]] = []
        for group in self._described.get("spheres", ()):
            for sphere in group["spheres"]:
                body, station = self.file.bodies[sphere["body"]], sphere["station"]
                point = station["point"] if isinstance(body, Rod) else None
                x = None if point is None else float(body.sample_points[point])  # type: ignore[union-attr]
                found.append((sphere["body"], x))
        return tuple(found)

    @cached_property
    def first_spheres(self) -> int:
        """Number of spheres of the contacts' first groups, and of points of rods with a skin."""
        groups = {contact.first for contact in self.file.contacts.values()}
        skins = sum(sum(w > 0.0 for w in each["weights"]) for each in self.foundations)
        return sum(self.sphere_groups[name] for name in groups) + skins

    @cached_property
    def least_touching_radius(self) -> float:
        """Least radius [m] of rods, in first groups of contacts or with a skin, that may touch.

        Infinite if there are none.
        """
        spheres = {group["name"]: group["spheres"] for group in self.description.get("spheres", ())}
        touching = (*self.foundations, *self.description.get("contacts", ()))
        names = {sphere["body"] for each in touching for sphere in spheres[each["first"]]}
        radii = [self.file.rod(name).surface.radius.min() for name in names & set(self.rods)]
        return float(min(radii, default=math.inf))

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
    def evaluation_loads(self) -> Array:
        """Loads at which a design is evaluated, (steps, inputs) [N or Pa].

        Those of the file's ``[evaluation]``: its ``loads``, or for one input from zero in steps.

        Raises
        ------
        InputError
            If these are not defined.
        """
        evaluation = self.file.evaluation
        if evaluation.loads:
            try:
                return loads(evaluation.loads, self.input_dimensions)
            except InputError as error:
                raise InputError(f"evaluation.loads: {error}") from None
        if len(self.inputs) > 1:
            raise InputError(
                f'the model "{self.name}" has {len(self.inputs)} inputs: give the load of each, as '
                f"evaluation.loads, or by name such as --load {self.inputs[0]}=..."
            )
        if self.inputs and self.inputs[0] in self.file.ties:
            raise InputError(
                f'the tie "{self.inputs[0]}" of the model "{self.name}" is driven by a '
                f"{self.load_name()}: give evaluation.loads or the loads themselves."
            )
        last, step = float(evaluation.force), float(evaluation.step)
        if self.inputs and self.inputs[0] in self.controlled:
            raise InputError(
                f'"{self.inputs[0]}" of the model "{self.name}" is controlled by its '
                f"{self.load_name()}: give evaluation.loads or the loads themselves."
            )
        if self.pressures:
            if evaluation.pressure is None:
                raise InputError(f'the model "{self.name}" has no evaluation.pressure: give it.')
            last = float(evaluation.pressure)
            step = float(evaluation.pressure_step or last / 5.0)
        column = np.linspace(0.0, last, max(1, round(last / step)) + 1)[:, None]
        return column if self.inputs else np.zeros((len(column), 0))

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

        The base of a rod that is placed by its underside moves with S(0).

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
        batch = self.design.checked(geometry)
        place = self.file.bodies[self.design.rod].placement
        columns = [batch.length[:, None], batch.radius, batch.slope]
        if place.reference == "underside":
            base = np.array([place.x, place.y, place.z], dtype=float)
            columns.append(base + batch.radius[:, :1] * place.dorsal)
        return self.geometry_indices, np.concatenate(columns, axis=1)

    @cached_property
    def geometry_indices(self) -> NDArray[np.intp]:
        """Which of the engine's parameters hold the geometry of the designed rod, (k,)."""
        name = self.design.rod
        parts = ["length", "radius", "slope"]
        if self.file.bodies[name].placement.reference == "underside":
            parts.append("translation")
        ranges = [self.engine.slots[f"{name}.{part}"] for part in parts]
        return np.concatenate([np.arange(start, stop) for start, stop in ranges])

    def geometry_slot_jacobian(self, jacobian: GeometryJacobian) -> Array:
        """Differentiate the values of `geometry_slots`, which are linear in the geometry.

        Parameters
        ----------
        jacobian
            Derivative of the geometry of n designs with respect to k parameters.

        Returns
        -------
        (n, slots, k) array
            Rows in the order of the indices of `geometry_slots`.
        """
        place = self.file.bodies[self.design.rod].placement
        rows = [jacobian.length[:, None, :], jacobian.radius, jacobian.slope]
        if place.reference == "underside":
            rows.append(jacobian.radius[:, :1, :] * place.dorsal[None, :, None])
        return np.concatenate(rows, axis=1)
