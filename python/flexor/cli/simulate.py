"""`flexor simulate`: follow a model's equilibrium as its actuation rises."""

from __future__ import annotations

import json
from math import degrees
from pathlib import Path as FilePath
from typing import TYPE_CHECKING, Annotated

import typer

from flexor.cli.changes import load_changed
from flexor.cli.console import err, out
from flexor.cli.options import Constants, Model, Set
from flexor.cli.table import fixed, number, show
from flexor.cli.values import loads

if TYPE_CHECKING:
    from flexor.model import Event, Path


def simulate(
    model: Model,
    force: Annotated[
        list[str] | None,
        typer.Option(
            metavar="FORCES",
            help="Forces in N: `first:last:step`, or a list such as `0,1,2.5`; of a model with "
            "several inputs `NAME=FORCES`, repeated.",
        ),
    ] = None,
    constants: Constants = None,
    changes: Set = None,
    as_json: Annotated[
        bool, typer.Option("--json", help="Print one JSON object instead of the table.")
    ] = False,
    plot: Annotated[
        FilePath | None,
        typer.Option(help="Draw every load step to scale into this PNG, SVG or PDF."),
    ] = None,
) -> int:
    """Follow a model's equilibrium as its actuation rises.

    Prints, for each force, the joint angles, the spheres in contact, the force of the exosuit's
    tip, and whether the equilibrium is statically stable; then every snap and bifurcation on the
    way. The exit code is 1 if a
    load step found no equilibrium; its state is then one of these, and what to do is said below the
    table (`docs/method.md` has more):

    * `iteration-limit`: too many iterations, mostly many snaps in a row
    * `unstable`: an equilibrium from which some motion grows by itself
    * `unrestrained`: a force acts on a motion that nothing holds
    * `stalled`: forces do not balance, yet the energy cannot be lowered
    * `diverged`: the energy is not finite, or no step could be found
    * `invalid-design`: a length, radius, modulus or stiffness makes no sense
    * `not-reached`: an earlier load step failed

    Examples
    --------
    * `flexor simulate finger`
    * `flexor simulate examples/finger.toml --force 0:10:2 --plot finger.svg`
    * `flexor simulate finger --constants printed --json`
    * `flexor simulate finger --set exosuit.length="8 cm"`

    In the JSON object every list has one entry per load step; angles are in rad, forces in N.
    """
    if plot is not None:
        from flexor.plot import writable

        writable(plot)
    path = load_changed(model, constants, changes or []).equilibrium(loads(force or []))
    if as_json:
        print(json.dumps(path.to_dict(), allow_nan=False))
    else:
        report(path)
    if plot is not None:
        from flexor import plot as figures

        figures.save(figures.path(path), plot)
        err.print(f"figure: {plot}", markup=False, soft_wrap=True)
    return 0 if bool(path.converged.all()) else 1


def report(path: Path) -> None:
    """Print a path as a table, and its events.

    Parameters
    ----------
    path : Path
        What to print.
    """
    import numpy as np

    from flexor.model import explained

    angular = path.model.angular_joints
    columns = [path.model.joints.index(name) for name in angular]
    angles = np.degrees(path.joint_angles[:, columns])
    inputs = path.model.inputs if len(path.model.inputs) > 1 else ("force",)
    headings = [f"{name} / N" for name in inputs]
    headings += [*(f"{name.removesuffix('.theta')} / °" for name in angular)]
    if len(angular) > 1:
        headings.append("sum / °")
    tips = [] if angular else list(path.model.rods)
    headings += [f"{rod} tip x, y, z / cm" for rod in tips]
    touches = bool(path.model.file.contacts)
    headings += [*(["contacts", "tip force / N"] if touches else []), "state", "events"]
    rows = []
    for step in range(len(path)):
        forces = path.loads[step] if len(inputs) > 1 else path.force[step : step + 1]
        cells = [number(float(force)) for force in forces]
        cells += [fixed(angle) for angle in angles[step]]
        if len(angular) > 1:
            cells.append(fixed(angles[step].sum()))
        for rod in tips:
            tip = 100.0 * path.frames(step)[rod][-1, :3, 3]
            cells.append(", ".join(fixed(x) for x in tip))
        if touches:
            cells += [str(path.touching[step]), number(float(path.tip_force[step]))]
        cells += [_state(path, step), _count([e for e in path.events if e.step == step])]
        rows.append(cells)
    show(headings, rows, left=0)
    failed = next((word for word in path.status if word != "converged"), None)
    if failed is not None:
        out.print(explained(failed), markup=False, soft_wrap=True)
    free = dict.fromkeys(name for names in path.free for name in names)
    if free:
        said = f"held by nothing: {', '.join(free)}"
        out.print(said, markup=False, soft_wrap=True)
    for event in path.events:
        out.print(_tell(event, path), markup=False, soft_wrap=True)


def _state(path: Path, step: int) -> str:
    if not path.converged[step]:
        return str(path.status[step]).replace("_", " ")
    return str(path.stability[step])


def _count(events: list[Event]) -> str:
    return ", ".join(event.kind.replace("_", " ") for event in events)


def _tell(event: Event, path: Path) -> str:
    turns = (
        f"{name.removesuffix('.theta')} {fixed(degrees(before))}° to {fixed(degrees(after))}°"
        for name, before, after in zip(
            path.model.joints, event.angles_before, event.angles_after, strict=True
        )
        if name in path.model.angular_joints
    )
    kind = event.kind.replace("_", " ")
    return f"{kind} at {event.force:.4g} N: {', '.join(turns) or 'no joint moves'}"
