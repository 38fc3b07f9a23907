"""What is to be made of a design: a straight rod with its sections."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from flexor.arrays import Array
from flexor.errors import InputError, unknown_name
from flexor.model.schema import ModelFile, Rod
from flexor.model.schema.pressure import Pressure
from flexor.model.schema.profile import Spline, Taper, surface
from flexor.model.schema.section import Composite, Hollow, Stiffness, cavities_of

if TYPE_CHECKING:
    from flexor.model import Model
    from flexor.study import Design

MM = 1e3


@dataclass(frozen=True, eq=False)
class Device:
    """A straight rod that is to be made.

    Attributes
    ----------
    file : ModelFile
        The model.
    name : str
        Of the rod.
    length : float
        [m].
    profile : function
        From X in [0, 1] to S(X) [m], arrays.
    linear : bool
        Whether S is linear in X.
    source : str
        Where the design is from.
    """

    file: ModelFile
    name: str
    length: float
    profile: Callable[[Array], Array]
    linear: bool
    source: str

    @property
    def rod(self) -> Rod:
        """The rod in the model file."""
        return self.file.rod(self.name)

    def surface(self, x: float) -> float:
        """S at X [m]."""
        return float(self.profile(np.array([x]))[0])

    def pressures(self) -> dict[str, tuple[str, tuple[float, float]]]:
        """Cavity and span of each pressure in the rod, by its name."""
        found = {}
        for name, each in self.file.actuators.items():
            if isinstance(each, Pressure) and each.rod == self.name:
                cavities = [key for piece in self.rod.pieces for key in cavities_of(piece)]
                found[name] = (each.cavity or cavities[0], each.span)
        return found

    def density(self, material: str) -> float:
        """Density of a material [kg/m³]; of the rod itself where the name is empty."""
        return float(self.file.materials[material].density if material else self.rod.density)


def device_of(model: Model, rod: str | None = None, source: str = "") -> Device:
    """Return the device of a model as it is in its file.

    Parameters
    ----------
    model
        The model.
    rod
        Name of the rod; of the designed one, or the only one, unless given.
    source
        Where the model is from.

    Raises
    ------
    InputError
        If it is not clear which rod, or it cannot be made.
    """
    name = _which(model.file, rod)
    own = model.file.rod(name)
    return _checked(
        Device(
            model.file,
            name,
            float(own.length),
            lambda x: surface(own.radius, x)[0],
            _is_linear(own.radius),
            source or model.name,
        )
    )


def _is_linear(radius: Taper | Spline | tuple[float, ...]) -> bool:
    if isinstance(radius, Taper):
        return True
    return len(radius.spline if isinstance(radius, Spline) else radius) <= 2


def device_of_design(design: Design, rod: str | None = None, source: str = "") -> Device:
    """Return the device of a design of a study; see `device_of`."""
    from flexor.design import Variables

    problem, model = design.problem, model_of_design(design)
    if isinstance(problem.parameters, Variables):
        return device_of(model, rod, source)
    space = model.design
    if rod not in (None, space.rod):
        return device_of(model, rod, source)
    geometry = problem.geometry(design.vector[None, :])
    points, radius = space.points, geometry.radius[0]
    straight = np.interp(points, points[[0, -1]], radius[[0, -1]])
    linear = bool(np.abs(radius - straight).max() < 1e-9 * radius.max())
    return _checked(
        Device(
            problem.model.file,
            space.rod,
            float(geometry.length[0]),
            lambda x: np.asarray(np.interp(x, points, radius)),
            linear,
            source,
        )
    )


def model_of_design(design: Design) -> Model:
    """Return the model of a design, with the values of the fields that vary."""
    from flexor.design import Variables
    from flexor.model import load

    problem = design.problem
    if not isinstance(problem.parameters, Variables):
        return problem.model
    return load(problem.model.file, changes=problem.parameters.changes(design.vector))


def recorded(folder: Path, number: int | None) -> Design:
    """Return a design of a study folder: its optimum, or one by its number from 1.

    Raises
    ------
    InputError
        If the folder is no study, or has no such design.
    """
    from flexor.study import Study
    from flexor.study.design import Design

    study = Study.open(folder)
    try:
        if number is None:
            return study.best
        vectors = study.record.designs()
        if not 1 <= number <= len(vectors):
            raise InputError(
                f'"{folder}" has no design {number}: it has {len(vectors):,}, numbered from 1.'
            )
        vector = vectors[number - 1]
        return Design.of(study.problem, vector, study.record.outcomes(vector))
    finally:
        study.close()


def _which(file: ModelFile, rod: str | None) -> str:
    rods = [name for name, body in file.bodies.items() if isinstance(body, Rod)]
    if rod is not None:
        if rod not in rods:
            raise InputError(f"--rod is the {unknown_name('rod', rod, rods)}.")
        return rod
    if len(rods) == 1:
        return rods[0]
    if file.design is not None and file.design.rod is not None:
        return file.design.rod
    if not rods:
        raise InputError(f'the model "{file.name}" has no rod that could be made.')
    raise InputError(
        f'the model "{file.name}" has several rods: give one of {", ".join(rods)} by --rod.'
    )


def _checked(device: Device) -> Device:
    """Refuse rods whose shape is not known, or that are curved or stretched at rest."""
    rod, name = device.rod, device.name
    strain = rod.reference_strain
    curved = ("twist_x", "bend_y", "bend_z", "shear_y", "shear_z")
    if any(float(getattr(strain, key)) for key in curved) or float(strain.extend_x) != 1.0:
        raise InputError(
            f'"{name}" is curved or stretched in its reference state (reference_strain): only '
            "straight rods can be exported."
        )
    for index, piece in enumerate(rod.pieces):
        place = f"{name}.section" + (f"[{index}]" if len(rod.pieces) > 1 else "")
        if isinstance(piece, Stiffness):
            raise InputError(f"{place} is given by its stiffness and has no shape to be made.")
        stretches = [piece.stretch] if isinstance(piece, Hollow) else []
        if isinstance(piece, Composite):
            stretches = [part.stretch for part in piece.parts if part.cavity is None]
        if stretches and min(stretches) != max(stretches):
            raise InputError(
                f"{place} has parts of different stretch, which cannot be cast at once."
            )
        if any(stretch != 1.0 for stretch in stretches):
            raise InputError(
                f"{place} has material that is stretched at rest ({stretches[0]:g}), which a "
                "mould does not give: only layers may be stretched."
            )
    return device
