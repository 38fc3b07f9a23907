"""`flexor simulate`: follow a model's equilibrium as its actuation rises and falls."""

from __future__ import annotations

from math import degrees
from typing import TYPE_CHECKING, Annotated

import typer

from flexor.cli import options
from flexor.cli.console import note, print_json, say
from flexor.cli.table import fixed, number, show
from flexor.cli.values import load_changed, numbers, one_or_assignments

if TYPE_CHECKING:
    from flexor.model import Event, Path


def simulate(
    model: options.Model,
    force: Annotated[
        list[str] | None,
        typer.Option(
            "--load",
            "--force",
            metavar="LOADS",
            help="Forces in N, pressures, or volumes and lengths of controlled inputs: "
            "`first:last:step`, values, or a list of both such as `0:5:1,5:0:1` or `0:60:5 kPa`; "
            "of a model with several inputs `NAME=LOADS`, repeated.",
        ),
    ] = None,
    start: Annotated[
        list[str] | None,
        typer.Option(
            metavar="START",
            help="Where to begin: a file of `simulate --json` (its last equilibrium, under its "
            "load), or coordinates without load such as `ph_1=20 deg`, repeated.",
        ),
    ] = None,
    follow: Annotated[
        str,
        typer.Option(
            metavar="HOW",
            help="`load`, stable equilibria only, or `arc-length`, one branch through its limit "
            "points.",
        ),
    ] = "load",
    constants: options.Constants = None,
    changes: options.Set = None,
    solver: options.Solver = None,
    as_json: options.Json = False,
    plot: options.Plot = None,
) -> int:
    """Compute the equilibria of a model along a load path.

    Prints the joint angles, the number of spheres in contact, the tip force and the static
    stability at each force, followed by all snaps and bifurcations. The exit code is 1 if a load
    step does not converge; its state is then one of the following, and a remedy is printed below
    the table (see also `docs/method.md`):

    * `iteration-limit`: too many iterations, usually because of many successive snaps
    * `unstable`: an unstable equilibrium under loads without a potential
    * `time-limit`: more time than `max_seconds` allows
    * `cancelled`: the solve was interrupted
    * `unrestrained`: a force acts on a motion that nothing holds
    * `stalled`: the energy cannot be reduced further, but the residual exceeds the tolerance
    * `diverged`: the energy is not finite, or no acceptable step was found
    * `invalid-design`: a length, radius, modulus or stiffness is invalid
    * `not-reached`: an earlier load step failed

    Examples
    --------
    * `flexor simulate finger`
    * `flexor simulate examples/finger.toml --force 0:10:2 --plot finger.svg`
    * `flexor simulate finger --constants printed --json`
    * `flexor simulate finger --set exosuit.length="8 cm"`
    * `flexor simulate finger --force 0:5:1,5:0:1 --plot loop.svg` loads and unloads
    * `flexor simulate finger --start ph_1="40 deg" --start exosuit.bend_y="90 deg"`
    * `flexor simulate examples/pneumatic-finger.toml --set actuators.chamber.control=volume
      --load "0:8:1 mL"` finds the pressures that a syringe needs
    * `flexor simulate finger --json > bent.json`, then
      `flexor simulate finger --start bent.json --force 4,3,2`
    * `flexor simulate arch.toml --force 0:9:1 --follow arc-length --plot arch.svg`

    Every list of the JSON object has one entry per load step; angles are in rad, forces in N.
    """
    path = load_changed(model, constants, changes).equilibrium(
        one_or_assignments("--force", force, "chamber=0:5:1"),
        start=one_or_assignments("--start", start, "ph_1=20 deg"),
        follow=follow,  # type: ignore[arg-type]  # checked there
        **numbers("--solver", solver or []),  # type: ignore[arg-type]
    )
    if as_json:
        print_json(path.to_dict())
    else:
        report(path)
        if force is None and len(path.model.inputs) > 1:
            say(f"no load is given: --force {path.model.inputs[0]}=0:5:1 applies one")
    if plot is not None:
        from flexor import plot as figures

        figures.save(figures.path(path), plot)
        note(f"figure: {plot}")
    return 0 if bool(path.converged.all()) else 1


def report(path: Path) -> None:
    """Print a path as a table, and its events."""
    import numpy as np

    from flexor.model import explained

    angular = path.model.angular_joints
    columns = [path.model.joints.index(name) for name in angular]
    angles = np.degrees(path.joint_angles[:, columns])
    several = len(path.model.inputs) > 1
    inputs = path.model.inputs if several else (path.model.load_name(),)
    units = [path.model.load_unit(i) for i in range(len(inputs))]
    headings = [
        f"{name} / {unit}".removesuffix(" / ")
        for name, (_, unit) in zip(inputs, units, strict=True)
    ]
    found = path.found_loads()
    found_units = [dimension.shown for dimension in path.model.controlled.values()]
    headings += [
        f"{dimension.name.split(' ', 1)[1]}{f' of {name}' if several else ''} / {unit}"
        for (name, dimension), (_, unit) in zip(
            path.model.controlled.items(), found_units, strict=True
        )
    ]
    headings += [*(f"{name.removesuffix('.theta')} / °" for name in angular)]
    axes = {tuple(each["axis"]) for each in path.model.engine.joints if each["name"] in angular}
    summed = len(angular) > 1 and len(axes) == 1
    headings += ["sum / °"] if summed else []
    slides = [name for name in path.model.joints if name not in angular]
    travel = 1e3 * path.joint_angles[:, [path.model.joints.index(name) for name in slides]]
    headings += [f"{name} / mm" for name in slides]
    tips = [] if angular else list(path.model.rods)
    headings += [f"{rod} tip x, y, z / cm" for rod in tips]
    has_contacts = bool(path.model.file.contacts)
    headings += [*(["contacts", "tip force / N"] if has_contacts else []), "state", "events"]
    rows = []
    for step in range(len(path)):
        forces = path.loads[step] if several else path.force[step : step + 1]
        cells = [
            number(float(force) / size) for force, (size, _) in zip(forces, units, strict=True)
        ]
        cells += [
            number(float(column[step]) / size)
            for column, (size, _) in zip(found.values(), found_units, strict=True)
        ]
        cells += [fixed(angle) for angle in angles[step]]
        if summed:
            cells.append(fixed(angles[step].sum()))
        cells += [fixed(length) for length in travel[step]]
        for rod in tips:
            tip = 100.0 * path.frames(step)[rod][-1, :3, 3]
            cells.append(", ".join(fixed(x) for x in tip))
        if has_contacts:
            cells += [str(path.touching[step]), number(float(path.tip_force[step]))]
        events = [event.kind.replace("_", " ") for event in path.events if event.step == step]
        cells += [_state(path, step), ", ".join(events)]
        rows.append(cells)
    show(headings, rows, left=0)
    failed = path.status[~path.converged]
    if len(failed):
        say(explained(failed[0]))
    free = dict.fromkeys(name for names in path.free for name in names)
    if free:
        say(f"held by nothing: {', '.join(free)}")
    for warning in path.warnings:
        say(f"warning: {warning}")
    for event in path.events:
        say(_describe_event(event, path))


def _state(path: Path, step: int) -> str:
    if not path.converged[step]:
        return str(path.status[step]).replace("_", " ")
    return str(path.stability[step])


def _describe_event(event: Event, path: Path) -> str:
    moves = []
    for name, *values in zip(
        path.model.joints, event.angles_before, event.angles_after, strict=True
    ):
        angle = name in path.model.angular_joints
        before, after = (
            f"{fixed(degrees(value))}°" if angle else f"{fixed(1e3 * value)} mm" for value in values
        )
        moves.append(f"{name.removesuffix('.theta')} {before} to {after}")
    what = f"{event.kind.replace('_', ' ')} at {path.model.show_load(event.force, '.4g')}"
    return f"{what}: {', '.join(moves)}" if moves else what
