"""`flexor simulate`: follow the equilibrium of a model along a load path."""

from __future__ import annotations

from typing import Annotated

import typer

from flexor.cli import options
from flexor.cli.console import note, print_json, say
from flexor.cli.path_report import report
from flexor.cli.values import load_changed, numbers, one_or_assignments
from flexor.errors import InputError


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
            "for a model with several inputs `NAME=LOADS`; may be repeated.",
        ),
    ] = None,
    start: Annotated[
        list[str] | None,
        typer.Option(
            metavar="START",
            help="Initial state: an output file of `simulate --json` (its last equilibrium, under "
            "its load), or coordinates without load such as `ph_1=20 deg`; may be repeated.",
        ),
    ] = None,
    follow: Annotated[
        str,
        typer.Option(
            metavar="HOW",
            help="`load` (stable equilibria only) or `arc-length` (one branch through its limit "
            "points).",
        ),
    ] = "load",
    reach: Annotated[
        list[str] | None,
        typer.Option(
            metavar="TARGETS",
            help="Find the loads, within the range of --load, at which joints or observables have "
            "these values, such as `ph_1=40 deg, ph_2=30 deg`; may be repeated.",
        ),
    ] = None,
    variant: options.Variant = None,
    changes: options.Set = None,
    solver: options.Solver = None,
    as_json: options.Json = False,
    plot: options.Plot = None,
) -> int:
    """Compute the equilibria of a model along a load path.

    Prints the joint angles, how many spheres or points of skins of the bodies that `[contacts]`
    name first, such as an exosuit, touch others (`contacts`; obstacles have columns of their own),
    the tip force and the static stability at each force, followed by all snaps and bifurcations.
    The exit code is 1 if a load step does not converge; the meaning of its status and a remedy are
    printed below the table (`docs/method.md` lists all statuses).

    Examples
    --------
    * `flexor simulate finger`
    * `flexor simulate examples/finger.toml --force 0:10:2 --plot finger.svg`
    * `flexor simulate finger --variant printed --json`
    * `flexor simulate finger --set exosuit.length="8 cm"`
    * `flexor simulate finger --force 0:5:1,5:0:1 --plot loop.svg` loads and unloads
    * `flexor simulate finger --start ph_1="40 deg" --start exosuit.bend_y="90 deg"`
    * `flexor simulate examples/pneumatic-finger.toml --set actuators.chamber.control=volume
      --load "0:8:1 mL"` finds the pressures that a syringe needs
    * `flexor simulate examples/pneumatic-finger.toml --reach "bending=45 deg"` finds the pressure
    * `flexor simulate finger --json > bent.json`, then
      `flexor simulate finger --start bent.json --force 4,3,2`
    * `flexor simulate arch.toml --force 0:9:1 --follow arc-length --plot arch.svg`

    Every list of the JSON object has one entry per load step; angles are in rad, forces in N.
    """
    built = load_changed(model, variant, changes)
    forces = one_or_assignments("--load", force, "chamber=0:5:1")
    begin = one_or_assignments("--start", start, "ph_1=20 deg")
    settings = numbers("--solver", solver or [])
    if reach:
        if follow != "load":
            raise InputError("--reach follows the loads it finds: leave --follow out.")
        from flexor.inverse import reach as find_loads

        inverse = find_loads(built, ", ".join(reach), forces, start=begin, **settings)
        path = inverse.path
    else:
        inverse = None
        path = built.equilibrium(
            forces,
            start=begin,
            follow=follow,  # type: ignore[arg-type]  # checked there
            **settings,  # type: ignore[arg-type]
        )
    if as_json:
        print_json(path.to_dict() | ({} if inverse is None else {"reach": inverse.to_dict()}))
    else:
        report(path)
        if inverse is not None:
            say(str(inverse))
        elif force is None and path.model.inputs and not path.loads.any():
            name, dimension = next(iter(path.model.input_dimensions.items()))
            say(f'no load is given: --load {name}="{dimension.example}" applies one')
    if plot is not None and path.converged.any():
        from flexor import plot as figures
        from flexor.cli.progress import working

        with working("drawing the figure", at_once=False):
            figures.save(figures.path(path), plot)
        note(f"figure: {plot}")
    elif plot is not None:
        note("no figure: no load step has converged")
    reached = inverse is None or inverse.reached
    return 0 if reached and bool(path.converged.all()) else 1
