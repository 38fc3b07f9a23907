"""The observables of a model, by name."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from flexor.arrays import Array
from flexor.errors import InputError, unknown_name
from flexor.model.extremes import Extreme, centreline, fibre
from flexor.model.results import Paths, State
from flexor.model.structure import Structure
from flexor.model.units import (
    ANGLE,
    FORCE,
    LENGTH,
    MOMENT,
    PRESSURE,
    STIFFNESS,
    VOLUME,
    Dimension,
)
from flexor.observables import quantities, slopes, tendons, tip_stiffness, work
from flexor.observables.observable import Observable
from flexor.observables.own import OWN, made
from flexor.observables.snap_margin import snap_margin

ENERGY = Dimension("an energy", "J", "10 mJ")
MASS = Dimension("a mass", "kg", "20 g")
_UNITS: dict[str, tuple[float, str]] = {
    "rad": (np.pi / 180.0, "deg"),
    "m": (1e-3, "mm"),
    "Pa": (1e3, "kPa"),
    "N": (1.0, "N"),
    "N*m": (1.0, "N*m"),
    "m^3": (1e-6, "mL"),
    "J": (1e-3, "mJ"),
    "kg": (1e-3, "g"),
    "N/m": (1e3, "N/mm"),
}
Values = Callable[[Paths], Array]


@dataclass(frozen=True)
class Member:
    """One observable of a kind: its values (n, s) and, if it has derivatives, its change."""

    values: Values
    slope: slopes.Slope | None = None


@dataclass(frozen=True)
class Kind:
    """A kind of observable: one, or one for each of the model's members such as its joints."""

    name: str
    dimension: Dimension | None
    text: str
    # From the model to each member; the empty name is the observable without one.
    members: Callable[[Structure], dict[str, Member]]
    absent: str  # what a model without it lacks
    place: Callable[[State], str] | None = None  # where its value is, for display
    lowest: float | None = None  # that its values are never below
    costly: bool = False  # to evaluate


def observables(model: Structure) -> dict[str, Observable]:
    """Return every observable of a model by name.

    Parameters
    ----------
    model
        The model.

    Returns
    -------
    dict
        Those that concern one member are called such as ``"angle.ph_1"``; those made by `custom`
        come last.
    """
    return {each.name: each for kind in _KINDS for each in _of(kind, model)} | OWN


def observable(name: str, model: Structure) -> Observable:
    """Find an observable of a model.

    Parameters
    ----------
    name
        Such as ``"bending"``, ``"strap-force"`` or ``"strap-force.proximal"``; case and underscores
        of the first part are ignored.
    model
        The model.

    Raises
    ------
    InputError
        If the model has none of this name; the nearest name or what it lacks is said.
    """
    head, dot, member = name.strip().partition(".")
    head = head.strip().casefold().replace("_", "-")
    kinds = {kind.name: kind for kind in _KINDS}
    if head in OWN and not dot:
        return OWN[head]
    if head not in kinds:
        raise InputError(f"{unknown_name('observable', name.strip(), (*kinds, *OWN))}.")
    found = {each.name: each for each in _of(kinds[head], model)}
    if not dot and len(found) == 1:
        return next(iter(found.values()))
    wanted = f"{head}{dot}{member.strip()}"
    if wanted in found:
        return found[wanted]
    if not found:
        raise InputError(f'"{head}" needs {kinds[head].absent}, but "{model.name}" has none.')
    if not dot:
        raise InputError(f'"{head}" is one of several: choose from {", ".join(found)}.')
    raise InputError(f"{unknown_name('observable', wanted, found)}.")


def kinds() -> dict[str, str]:
    """Return what there is, by name: a line about each."""
    return {kind.name: kind.text for kind in _KINDS} | {name: own.text for name, own in OWN.items()}


def custom(
    name: str, function: Callable[[Any], ArrayLike], *, unit: str = "", text: str = "your own"
) -> Observable:
    """Make an observable of one function of the path, known by its name from then on.

    It can be sought, bounded and reached like any other: ``"minimise pinch-span"``,
    ``"pinch-span <= 2 cm at end"``. It has no exact derivatives. It is known in this process alone:
    make it again before a study is resumed or opened, and in a module that the workers of a
    cluster import.

    Parameters
    ----------
    name : str
        Of small letters, digits and hyphens, such as ``"pinch-span"``. Another function of the same
        name takes its place.
    function : callable
        From the `flexor.Path` of one design to its value, or to those at its loads, (s,), SI. It is
        not called for designs that failed; NaN is no value.
    unit : str
        For bounds and display, such as ``"mm"``; of plain numbers, nothing.
    text : str
        What it is, in one line.

    Raises
    ------
    InputError
        If Flexor has one of this name, or the name, the function or the unit is none.

    Examples
    --------
    >>> import flexor
    >>> last = flexor.observables.custom(
    ...     "last-joint", lambda path: path.joint_angles[:, -1], unit="deg"
    ... )
    >>> model = flexor.load("pneumatic-finger")
    >>> flexor.observables.observable("last-joint", model) is last
    True
    """
    return made(name, function, unit, text, {kind.name for kind in _KINDS})


def _of(kind: Kind, model: Structure) -> Iterator[Observable]:
    for member, found in kind.members(model).items():
        unit = (1.0, "") if kind.dimension is None else _UNITS[kind.dimension.unit]
        dimension = kind.dimension
        if kind.name == "angle" and member not in _angular(model):
            dimension, unit = LENGTH, _UNITS["m"]
        yield Observable(
            name=f"{kind.name}.{member}" if member else kind.name,
            dimension=dimension,
            unit=unit,
            text=kind.text,
            values=found.values,
            slope=found.slope,
            lowest=kind.lowest,
            place=kind.place,
            costly=kind.costly,
        )


def _place(key: str) -> Callable[[State], str]:
    return lambda state: _said(state.extremes().get(key))


def _said(extreme: Extreme | None) -> str:
    if extreme is None:
        return ""
    on = "" if extreme.on is None else f" on {extreme.on}"
    return f"{extreme.body}, X = {extreme.X:.2g}{on}"


def _fibre(uses: Callable[[State], Array]) -> Callable[[State], str]:
    def found(state: State) -> str:
        values = uses(state)
        if not np.isfinite(values).any():
            return ""
        material, at = fibre(state, values)
        return f"{material} of {at.body}, X = {at.X:.2g}"

    return found


def _angular(model: Structure) -> list[str]:
    return [model.joint_labels[name] for name in model.angular_joints]


def _angles(model: Structure) -> dict[str, Member]:
    return {
        model.joint_labels[name]: Member(
            lambda paths, i=i: paths.joint_angles[:, :, i],  # type: ignore[misc]
            slopes.member("joints", i),
        )
        for i, name in enumerate(model.joints)
    }


def _if(there: object, values: Values, slope: slopes.Slope | None = None) -> dict[str, Member]:
    return {"": Member(values, slope)} if there else {}


def _volumes(model: Structure) -> dict[str, Member]:
    return {
        name: Member(
            lambda paths, i=i: paths.volume[:, :, i],  # type: ignore[misc]
            slopes.member("volume", i),
        )
        for i, name in enumerate(model.pressures)
    }


def _rods(model: Structure) -> dict[str, Member]:
    return {
        name: Member(
            lambda paths, i=i: paths.rod_bending[:, :, i],  # type: ignore[misc]
            slopes.member("rod_bending", i),
        )
        for i, name in enumerate(model.rods)
    }


def _applied(names: tuple[str, ...], model: Structure) -> dict[str, Member]:
    columns = {name: model.input_of(name) for name in names}
    return {
        name: Member(
            lambda paths, i=i: paths.applied[:, :, i],  # type: ignore[misc]
            slopes.member("applied", i),
        )
        for name, i in columns.items()
    }


def _straps(model: Structure) -> dict[str, Member]:
    names = tuple(model.file.straps)
    outputs = slopes.strap_members(model)
    each = {
        name: Member(
            lambda paths, i=i: paths.strap_tension[:, :, i],  # type: ignore[misc]
            outputs[name],
        )
        for i, name in enumerate(names)
    }
    largest: Values = lambda paths: paths.strap_tension.max(axis=2)  # noqa: E731
    return _if(names, largest, slopes.strap_force) | each


def _obstacles(model: Structure) -> dict[str, Member]:
    return {
        name: Member(
            lambda paths, i=i: paths.obstacle_force[:, :, i],  # type: ignore[misc]
            slopes.member("obstacles", i),
        )
        for i, name in enumerate(model.file.obstacles)
    }


def _ties(model: Structure, which: int) -> dict[str, Member]:
    """Return force (0), moment (1) or drive (2) of each tie that has one."""
    sizes: tuple[Callable[[Array], Array], ...] = (
        lambda loads: np.linalg.norm(loads[..., :3], axis=-1),
        lambda loads: np.linalg.norm(loads[..., 3:6], axis=-1),
        lambda loads: loads[..., 6],
    )
    return {
        name: Member(
            lambda paths, i=i: sizes[which](paths.tie_loads[:, :, i]),  # type: ignore[misc]
            slopes.member("ties", 3 * i + which),
        )
        for i, (name, tie) in enumerate(model.file.ties.items())
        if which == 0 or (tie.holds_rotation if which == 1 else tie.drive is not None)
    }


def _drives(model: Structure, kind: str) -> dict[str, Member]:
    return {
        name: member
        for name, member in _ties(model, 2).items()
        if model.file.ties[name].drive == kind
    }


def _tendons(model: Structure, values: Values, output: str) -> dict[str, Member]:
    return {
        name: Member(
            lambda paths, i=i: values(paths)[:, :, i],  # type: ignore[misc]
            slopes.member(output, i),
        )
        for i, name in enumerate(model.tendons)
    }


def _arms(model: Structure) -> dict[str, Member]:
    names = [model.joint_labels[name] for name in model.joints]
    return {
        f"{model.tendons[tendon]}.{names[joint]}": Member(
            lambda paths, i=tendon, j=joint: tendons.arms(paths)[:, :, i, j]  # type: ignore[misc]
        )
        for tendon, joint in tendons.crossed(model)
        if model.joints[joint] in model.angular_joints
    }


def _tips(model: Structure) -> dict[str, Member]:
    return {
        name: Member(lambda paths, of=(name, columns): tip_stiffness.tip_stiffness(paths, *of))  # type: ignore[misc]
        for name, columns in tip_stiffness.bodies(model).items()
    }


def _limited(model: Structure, key: str) -> bool:
    return any(getattr(each, key) is not None for each in model.file.materials.values())


def _fibres(model: Structure) -> bool:
    return any(slot.endswith(".fibres[0]") for slot in model.engine.slots)


def _range_of_motion(paths: Paths) -> Array:
    bent = quantities.bending(paths)
    return bent - bent[:, :1]


_JOINTS, _CONTACT = "a joint that turns", "contact"
_KINDS = (
    Kind(
        "bending",
        ANGLE,
        "sum of the angles of all joints",
        lambda model: _if(model.angular_joints, quantities.bending, slopes.bending),
        _JOINTS,
    ),
    Kind(
        "range-of-motion",
        ANGLE,
        "bending beyond that under the first load, where a preload has its effect",
        lambda model: _if(model.angular_joints, _range_of_motion, slopes.range_of_motion),
        _JOINTS,
    ),
    Kind(
        "rod-bending",
        ANGLE,
        "angle between both ends of a rod",
        _rods,
        "a rod",
    ),
    Kind("angle", ANGLE, "coordinate of one joint", _angles, "a joint"),
    Kind(
        "tip-force",
        FORCE,
        "force of the exosuit's tip on the finger, F_t (14)",
        lambda model: _if(
            model.first_spheres, lambda paths: paths.tip_force, slopes.output("tip_force")
        ),
        _CONTACT,
        lowest=0.0,
    ),
    Kind(
        "contacts",
        None,
        "number of spheres or points of the exosuit that touch, n_c",
        lambda model: _if(
            model.first_spheres, lambda paths: paths.touching.astype(float), slopes.constant
        ),
        _CONTACT,
        lowest=0.0,
    ),
    Kind(
        "overlap",
        LENGTH,
        "largest overlap of bodies in contact",
        lambda model: _if(
            model.first_spheres, lambda paths: paths.max_overlap, slopes.output("max_overlap")
        ),
        _CONTACT,
        _place("max_overlap"),
        lowest=0.0,
    ),
    Kind(
        "centreline-depth",
        LENGTH,
        "how deep the centreline of a rod is in a body that it touches, negative outside",
        lambda model: _if(
            math.isfinite(model.least_touching_radius),
            lambda paths: paths.max_centreline_depth,
            slopes.output("max_centreline_depth"),
        ),
        "a rod that may touch bodies",
        lambda state: _said(centreline(state)),
    ),
    Kind(
        "contact-pressure",
        PRESSURE,
        "largest pressure of contact through skins",
        lambda model: _if(
            model.has_skins,
            lambda paths: paths.max_contact_pressure,
            slopes.output("max_contact_pressure"),
        ),
        "bodies with a skin",
        _place("max_contact_pressure"),
        lowest=0.0,
    ),
    Kind(
        "strain",
        None,
        "largest strain |λ - 1| of a fibre",
        lambda model: _if(_fibres(model), lambda paths: paths.max_strain, slopes.strain),
        "a section with a material",
        _place("max_strain"),
        lowest=0.0,
    ),
    Kind(
        "strain-use",
        None,
        "largest strain of a fibre, as a share of its material's strain_limit",
        lambda model: _if(
            _limited(model, "strain_limit"), quantities.strain_use, slopes.strain_use
        ),
        "a material with a strain_limit",
        _fibre(lambda state: quantities.strain_uses(state.model, state.stretch)),
        lowest=0.0,
    ),
    Kind(
        "stress-use",
        None,
        "largest nominal stress of a fibre, as a share of its material's stress_limit",
        lambda model: _if(
            _limited(model, "stress_limit"), quantities.stress_use, slopes.stress_use
        ),
        "a material with a stress_limit",
        _fibre(lambda state: quantities.stress_uses(state.model, state.stretch, state.parameters)),
        lowest=0.0,
    ),
    Kind(
        "min-stretch",
        None,
        "smallest stretch λ of a fibre; at 0 the section folds",
        lambda model: _if(_fibres(model), lambda paths: paths.min_stretch, slopes.min_stretch),
        "a section with a material",
        _place("min_stretch"),
    ),
    Kind("strap-force", FORCE, "tension of a strap, or the largest", _straps, "straps", lowest=0.0),
    Kind(
        "obstacle-force",
        FORCE,
        "sum of the normal forces on an obstacle",
        _obstacles,
        "obstacles",
        lowest=0.0,
    ),
    Kind("tie-force", FORCE, "force in a tie", lambda model: _ties(model, 0), "ties", lowest=0.0),
    Kind(
        "tie-moment",
        MOMENT,
        "moment in a tie, about its second place",
        lambda model: _ties(model, 1),
        "ties that hold a rotation",
        lowest=0.0,
    ),
    Kind(
        "drive-force",
        FORCE,
        "force that a driven displacement of a tie needs",
        lambda model: _drives(model, "displacement"),
        "a tie driven by a displacement",
    ),
    Kind(
        "drive-moment",
        MOMENT,
        "moment that a driven rotation of a tie needs",
        lambda model: _drives(model, "rotation"),
        "a tie driven by a rotation",
    ),
    Kind(
        "tendon-length",
        LENGTH,
        "length of a tendon",
        lambda model: _tendons(model, tendons.lengths, "tendon_lengths"),
        "tendons",
        lowest=0.0,
    ),
    Kind(
        "tendon-force",
        FORCE,
        "tension of a tendon",
        lambda model: _tendons(model, tendons.tensions, "tendon_tensions"),
        "tendons",
    ),
    Kind(
        "moment-arm",
        LENGTH,
        "moment arm of a tendon about a joint, positive where it turns the joint positively",
        _arms,
        "a tendon across a joint that turns",
    ),
    Kind(
        "effort",
        None,
        "sum of the squared activations of all muscles",
        lambda model: _if(model.muscles, tendons.effort, tendons.effort_slope),
        "muscles",
        lowest=0.0,
    ),
    Kind("volume", VOLUME, "volume of a cavity", _volumes, "a pressure"),
    Kind(
        "pressure",
        PRESSURE,
        "pressure in a cavity, given or found",
        lambda model: _applied(model.pressures, model),
        "a pressure",
    ),
    Kind(
        "mass",
        MASS,
        "mass of all rods",
        lambda model: _if(model.rods, quantities.mass, slopes.mass),
        "a rod",
        lowest=0.0,
    ),
    Kind(
        "tip-stiffness",
        STIFFNESS,
        "force across the tip of a body, along its z, by the distance it gives, with loads held",
        _tips,
        "a body that can move and neither ties nor friction",
        lowest=0.0,
        costly=True,
    ),
    Kind(
        "efficiency",
        None,
        "work on the joints over work of the pressures since the first load",
        lambda model: _if(work.has_work(model), work.efficiency),
        "joints that turn, driven by pressures alone and without friction",
    ),
    Kind("energy", ENERGY, "potential energy", lambda model: _if(True, lambda p: p.energy), ""),
    Kind(
        "snap-margin",
        None,
        "how far beyond the last load the next snap is, as a share of it, or 1 if further",
        lambda model: _if(model.inputs, snap_margin),
        "a load",
        lowest=0.0,
    ),
    Kind(
        "snaps",
        None,
        "number of snaps along the path",
        lambda model: _if(True, quantities.snaps, slopes.constant),
        "",
        lowest=0.0,
    ),
)
