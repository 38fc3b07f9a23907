"""A path in the terminal: a row per load step, what is beyond its limits, and events."""

from __future__ import annotations

from collections.abc import Sequence
from math import degrees
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from flexor.arrays import Array
from flexor.cli.console import say
from flexor.cli.table import fixed, number, numbers, show, stated

if TYPE_CHECKING:
    from flexor.model import Event, Path
    from flexor.model.accuracy import Accuracy

Columns = dict[str, list[str]]  # cells by heading
_STILL = 1e-6  # [rad or m]


def report(path: Path) -> None:
    """Print a path as a table, then explanations, warnings and events."""
    from flexor.model import explained, why_not_closed, why_singular, why_stalled
    from flexor.model.accuracy import accuracy

    known = accuracy(path)
    still = _still(path)
    columns = _loads(path, known) | _joints(path, still) | _contacts(path, known)
    columns |= _friction(path) | _device(path, known)
    columns["state"] = [_state(path, step) for step in range(len(path))]
    if path.events:
        columns["events"] = [
            ", ".join(_kind(event) for event in path.events if event.step == step)
            for step in range(len(path))
        ]
    show(list(columns), list(zip(*columns.values(), strict=True)), left=0)
    if still:
        stays = "stays" if len(still) == 1 else "stay"
        say(f"{', '.join(path.model.joint_labels[name] for name in still)} {stays} at zero.")
    failed = path.status[~path.converged]
    if len(failed):
        say(explained(failed[0]))
    if "stalled" in failed:
        say(why_stalled(path))
    if "not-closed" in failed:
        say(why_not_closed(path))
    if "singular" in failed:
        say(why_singular(path))
    free = dict.fromkeys(name for names in path.free for name in names)
    if free:
        say(f"without stiffness: {', '.join(free)}")
    if path.converged[-1]:
        _print_extremes(path)
    for warning in path.warnings:
        say(f"warning: {warning}")
    for event in path.events:
        say(_event(event, path))


def _loads(path: Path, known: Accuracy) -> Columns:
    model, columns = path.model, {}
    several = len(model.inputs) > 1
    loads = path.loads.T if several else path.force[None]
    for index, load in enumerate(loads):
        size, unit = model.load_unit(index)
        name = model.inputs[index] if several else model.load_name()
        columns[f"{name} / {unit}".removesuffix(" / ")] = stated((load / size).tolist())
    for name, found in path.found_loads().items():
        size, unit = model.controlled[name].shown
        what = model.controlled[name].noun
        heading = f"{what} of {name}" if several else what
        least = known.force
        if name in model.pressures:
            volume = path.volume[:, model.pressures.index(name)]
            least = known.moment / volume
        columns[f"{heading} / {unit}"] = _cells(found / size, least / size)
    return columns


def _still(path: Path) -> list[str]:
    """Return the coordinates of joints with several that never move while others of these do."""
    moves = (np.nan_to_num(np.abs(path.joint_angles)).max(axis=0) > _STILL).tolist()
    bodies = [each["body"] for each in path.model.engine.joints]
    moving = {body for body, moved in zip(bodies, moves, strict=True) if moved}
    every = zip(path.model.joints, bodies, moves, strict=True)
    return [name for name, body, moved in every if not moved and body in moving]


def _joints(path: Path, still: Sequence[str]) -> Columns:
    """Return the angles and travels of joints, or the tips of rods where no joint turns."""
    model, columns = path.model, {}
    angular = model.angular_joints
    angles = {
        name: np.degrees(column)
        for name, column in zip(model.joints, path.joint_angles.T, strict=True)
        if name in angular and name not in still
    }
    for name, angle in angles.items():
        columns[f"{model.joint_labels[name]} / °"] = [fixed(x) for x in angle]
    axes = {tuple(each["axis"]) for each in model.engine.joints if each["name"] in angular}
    if len(angles) > 1 and len(axes) == 1:
        columns["sum / °"] = [fixed(x) for x in sum(angles.values())]
    for name, column in zip(model.joints, path.joint_angles.T, strict=True):
        if name not in angular and name not in still:
            columns[f"{model.joint_labels[name]} / mm"] = [fixed(1e3 * x) for x in column]
    if not angular:
        frames = [path.frames(step) for step in range(len(path))]
        for rod in model.rods:
            tips = (100.0 * each[rod][-1, :3, 3] for each in frames)
            columns[f"{rod} tip x, y, z / cm"] = [", ".join(map(fixed, tip)) for tip in tips]
    return columns


def _contacts(path: Path, known: Accuracy) -> Columns:
    if not path.model.first_spheres:
        return {}
    return {
        "contacts": [str(count) for count in path.touching],
        "tip force / N": _cells(path.tip_force, known.force),
    }


def _friction(path: Path) -> Columns:
    """Return how many of the points with friction that touch slide, and the energy lost."""
    if path.friction is None:
        return {}
    counts = [f"{int(each['slides'].sum())} of {len(each)}" for each in path.friction]
    reached = np.isfinite(path.q).all(axis=1)
    lost = [number(x) for x in np.where(reached, 1e3 * path.dissipated, np.nan).tolist()]
    return {"sliding": counts, "dissipated / mJ": lost}


def _device(path: Path, known: Accuracy) -> Columns:
    """Return contact, strain, volumes and forces of the device."""
    from flexor.model.accuracy import force_accuracy

    model, cells = path.model, Columns()
    if model.foundations:
        cells["overlap / mm"] = _cells(1e3 * path.max_overlap, 1e3 * known.place)
    if model.has_skins:
        pressure = np.where(_touch(path, known), path.max_contact_pressure / 1e3, 0.0)
        cells["contact pressure / kPa"] = [number(each) for each in pressure.tolist()]
    if np.isfinite(path.stretch).any():
        cells["strain / %"] = _cells(100.0 * path.max_strain, 100.0 * known.strain)
    for name, volume in zip(model.pressures, path.volume.T, strict=True):
        cells[f"volume of {name} / mL"] = [number(1e6 * each) for each in volume.tolist()]
    least = force_accuracy(path, _forces)
    cells |= {f"{name} / N": _cells(force, least[name]) for name, force in _forces(path).items()}
    return cells | _ties(path, known)


def _touch(path: Path, known: Accuracy) -> NDArray[np.bool_]:
    """Return at which steps skins touch, beyond what is known of places."""
    pressing = sum(path.obstacle_forces().values(), np.zeros(len(path)))
    return np.asarray((path.max_overlap > known.place) | (pressing > known.force))


def _forces(path: Path) -> dict[str, Array]:
    forces = {f"strap {name}": force for name, force in path.strap_forces().items()}
    forces |= {f"tendon {name}": force for name, force in path.tendon_forces().items()}
    return forces | {f"obstacle {name}": x for name, x in path.obstacle_forces().items()}


def _ties(path: Path, known: Accuracy) -> Columns:
    """Return the reactions of ties: magnitudes of forces and moments, and what drives them."""
    found: dict[str, dict[str, Array]] = {"N": {}, "N*m": {}}
    least = {"N": known.force, "N*m": known.moment}
    moments, drives = path.tie_moments(), path.tie_drives()
    for name, force in path.tie_forces().items():
        tie = path.model.file.ties[name]
        found["N"][f"force in {name}"] = force
        if tie.holds_rotation:
            found["N*m"][f"moment in {name}"] = moments[name]
        if name in drives:
            unit = "N*m" if tie.drive == "rotation" else "N"
            found[unit][f"drive of {name}"] = drives[name]
    return {
        f"{what} / {unit}": _cells(values, least[unit])
        for unit, each in found.items()
        for what, values in each.items()
    }


def _cells(values: Array, least: Array) -> list[str]:
    return numbers(values.tolist(), least.tolist())


def _print_extremes(path: Path) -> None:
    """Print where contact pressure and strain are largest at the last step."""
    found = path[-1].extremes()
    for key, what in (("max_contact_pressure", "contact pressure"), ("max_strain", "strain")):
        if (each := found.get(key)) is not None:
            on = f" on {each.on}" if each.on else ""
            say(f"largest {what}: {each.body} at X = {each.X:.3g}{on}")


def _state(path: Path, step: int) -> str:
    if not path.converged[step]:
        return str(path.status[step]).replace("_", " ")
    return str(path.stability[step])


def _kind(event: Event) -> str:
    return event.kind.replace("_", " ")


def _event(event: Event, path: Path) -> str:
    moves = []
    joints = zip(path.model.joints, event.angles_before, event.angles_after, strict=True)
    for name, *ends in joints:
        turns = name in path.model.angular_joints
        before, after = (
            f"{fixed(degrees(end))}°" if turns else f"{fixed(1e3 * end)} mm" for end in ends
        )
        moves.append(f"{path.model.joint_labels[name]} {before} to {after}")
    what = f"{_kind(event)} at {path.model.show_loads(event.loads, '.4g')}"
    return f"{what}: {', '.join(moves)}" if moves else what
