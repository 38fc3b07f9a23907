"""`flexor export`: what is made of a design."""

from __future__ import annotations

from dataclasses import fields
from pathlib import Path as FilePath
from typing import TYPE_CHECKING, Annotated, Any

import typer

from flexor.cli import options
from flexor.cli.console import print_json, say
from flexor.cli.progress import working
from flexor.cli.table import number, show
from flexor.cli.values import load_changed
from flexor.errors import InputError

if TYPE_CHECKING:
    from flexor.export import Body, BodyOptions, FingerOptions, MouldOptions
    from flexor.model import Model
    from flexor.model.geometry import Geometry, SlotValues
    from flexor.study import Design

_BODY, _MOULD = "Dimensions of the body", "Dimensions of the mould"
_FINGER = "Dimensions of the printed limb"


def _length(text: str, panel: str) -> Any:
    return typer.Option(metavar="LENGTH", help=text, rich_help_panel=panel)


def export(
    design: Annotated[
        str,
        typer.Argument(
            metavar="DESIGN",
            help="Model file, preset, or study folder (its optimum, or --design N).",
            autocompletion=options.preset_names,
        ),
    ],
    body: Annotated[
        FilePath | None,
        typer.Option(
            metavar="FILE", help="Write the body as a solid: an STL, 3MF or STEP file, in mm."
        ),
    ] = None,
    mould: Annotated[
        FilePath | None,
        typer.Option(
            metavar="DIR",
            help="Write everything to cast it into this folder: parts of the mould "
            "as STL, the body, sheets to cut, and instructions.html.",
        ),
    ] = None,
    sheets: Annotated[
        FilePath | None,
        typer.Option(
            metavar="FILE", help="Write layers and straps as flat outlines: a DXF file, in mm."
        ),
    ] = None,
    finger: Annotated[
        FilePath | None,
        typer.Option(
            metavar="FILE|DIR",
            help="Write the limb to print, links with hinges that take springs: into one STL, "
            "3MF or STEP file, or into a folder with its parts, springs.csv, and bench.csv to "
            "fill in.",
        ),
    ] = None,
    mjcf: Annotated[
        FilePath | None,
        typer.Option(
            metavar="FILE",
            help="Write links, joints and tendons for the simulator MuJoCo: an XML file.",
        ),
    ] = None,
    which: options.Which = None,
    rod: Annotated[
        str | None, typer.Option(metavar="NAME", help="Which rod; by default the designed one.")
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="Overwrite files that exist.")] = False,
    variant: options.Variant = None,
    changes: options.Set = None,
    cap: Annotated[str, _length("Thickness of the caps that close chambers.", _BODY)] = "5 mm",
    inlet: Annotated[str, _length("Diameter of the hole for the tube.", _BODY)] = "3 mm",
    strap: Annotated[str, _length("Width of straps without one.", _BODY)] = "15 mm",
    strap_thickness: Annotated[str, _length("Thickness of the webbing.", _BODY)] = "1.5 mm",
    ear: Annotated[str, _length("Thickness of the ears for the straps.", _BODY)] = "2.5 mm",
    margin: Annotated[str, _length("Material around the slots.", _BODY)] = "3 mm",
    fold: Annotated[str, _length("End of a strap that is folded back.", _BODY)] = "30 mm",
    wall: Annotated[str, _length("Thickness of the walls.", _MOULD)] = "6 mm",
    pour: Annotated[str, _length("Diameter of the hole for silicone.", _MOULD)] = "5 mm",
    vent: Annotated[str, _length("Diameter of the holes for air.", _MOULD)] = "2 mm",
    draft: Annotated[
        str,
        typer.Option(
            metavar="ANGLE",
            help="By which the cavity widens towards the parting surface.",
            rich_help_panel=_MOULD,
        ),
    ] = "0 deg",
    shrinkage: Annotated[
        float,
        typer.Option(help="Of the silicone, as a share of its length.", rich_help_panel=_MOULD),
    ] = 0.0,
    clearance: Annotated[
        str, _length("Gap between parts that are put together.", _MOULD)
    ] = "0.15 mm",
    least_wall: Annotated[
        str, _length("Thinnest wall and core that can be made.", _MOULD)
    ] = "1 mm",
    stretch: Annotated[
        float,
        typer.Option(
            help="Largest strain of the silicone when a core is pulled.", rich_help_panel=_MOULD
        ),
    ] = 0.5,
    grip: Annotated[str, _length("Depth to which a lid takes the body.", _MOULD)] = "6 mm",
    pin: Annotated[str, _length("Diameter of the pins.", _FINGER)] = "3 mm",
    gap: Annotated[str, _length("Gap between what moves.", _FINGER)] = "0.4 mm",
    seat: Annotated[str, _length("Length of the block behind.", _FINGER)] = "20 mm",
    plot: options.Plot = None,
    as_json: options.Json = False,
) -> int:
    """Export what is made of a design: body, mould, sheets to cut, and a limb to print.

    The solids have the sections of the model, which the mechanics is computed with. Bores go from
    end to end of the spans of their pressures; caps are added at the ends of the rod, ears with
    slots beside it where straps are. Needs the extra `flexor[make]`.

    Examples
    --------
    * `flexor export pneumatic-finger --body body.stl --sheets sheets.dxf`
    * `flexor export studies/pneumatic-finger-fields-range-of-motion --mould mould/`
    * `flexor export studies/r01 --design 12 --body twelfth.3mf`
    * `flexor export pneumatic-finger --mould mould/ --draft "1 deg" --shrinkage 0.001`
    * `flexor export pneumatic-finger --finger finger/`
    """
    from flexor import export as making
    from flexor.export import files

    given = dict(locals())
    if mjcf is not None:
        _write_mjcf(designed(design, which, variant, changes)[0], mjcf, force)
        if all(each is None for each in (body, mould, sheets, finger, plot)):
            return 0
    if all(each is None for each in (body, mould, sheets, finger, plot)):
        raise InputError(
            "nothing to export: give --body, --mould, --sheets, --finger, --mjcf or --plot."
        )
    files.require_packages()
    for path, formats in ((body, files.FORMATS), (sheets, (".dxf",))):
        if path is not None:
            files.check_target(path, force, formats)
    for folder in (mould, finger):
        if folder is not None and folder.suffix and folder is finger:
            files.check_target(folder, force)
        elif folder is not None:
            files.check_folder(folder, force)
    chosen, of_mould, of_finger = _options(given)
    model, found, _ = designed(design, which, variant, changes)
    written: list[FilePath] = []
    limb_only = body is None and mould is None and sheets is None and finger is not None
    if finger is not None:
        written += _print_finger(model, found, of_finger, finger, plot if limb_only else None)
    if limb_only:
        if as_json:
            print_json({"files": written})
        else:
            _list(written)
        return 0
    if found is None:
        device = making.device_of(model, rod, f'the model "{model.name}"')
    else:
        called = "the best design" if which is None else f"design {which}"
        device = making.device_of_design(found, rod, f"{called} of {design}")
    with working("making the body"):
        made = making.body(device, chosen)
        if body is not None:
            files.write_solid(made.solid, body)
            written.append(body)
        if sheets is not None:
            pieces = making.sheets(made)
            if not pieces:
                raise InputError(f"{device.source} has no layers and no straps to be cut.")
            files.write(sheets, lambda draft: making.write_dxf(pieces, draft))
            written.append(sheets)
    cast = None
    if mould is not None:
        from flexor.export.kit import write_kit

        with working("making the mould"):
            cast = making.mould(device, of_mould, chosen)
            written += write_kit(cast, mould, model.equilibrium() if found is None else found.path)
    if plot is not None:
        from flexor.export.drawing import making_figure
        from flexor.plot import save

        with working("drawing"):
            written.append(save(making_figure(made, cast), plot))
    if as_json:
        print_json(_as_json(made, written))
    else:
        _print_summary(made, written)
    return 0


def _write_mjcf(model: Model, target: FilePath, force: bool) -> None:
    from flexor.exchange import mjcf_of
    from flexor.export.files import check_target
    from flexor.store import write_text

    check_target(target, force, (".xml",))
    text, left_out = mjcf_of(model.file)
    write_text(target, text)
    say(f"model:     {target}")
    for what, count in sorted(left_out.items()):
        say(f"left out:  {what}{f', {count} times' if count > 1 else ''}")


def _options(given: dict[str, Any]) -> tuple[BodyOptions, MouldOptions, FingerOptions]:
    from flexor.export import BodyOptions, FingerOptions, MouldOptions

    def values(kind: Any) -> Any:
        return kind(**{each.name: _value(each.name, given[each.name]) for each in fields(kind)})

    return values(BodyOptions), values(MouldOptions), values(FingerOptions)


def _value(name: str, text: str | float) -> float:
    """Return the value of an option [SI]."""
    from flexor.model.quantity import parse_quantity
    from flexor.model.units import ANGLE, LENGTH

    option = "--" + name.replace("_", "-")
    if isinstance(text, float):
        if not 0.0 <= text < 1.0:
            raise InputError(f"{option} is {text:g}: expected a number from 0 to below 1.")
        return text
    found, _ = parse_quantity(text, ANGLE if name == "draft" else LENGTH, option)
    may_vanish = name in ("draft", "clearance", "fold")
    if found < 0.0 or (found == 0.0 and not may_vanish):
        least = "at least 0" if may_vanish else "above 0"
        raise InputError(f'{option} is "{text}": it must be {least}.')
    if name == "draft" and found > 0.35:
        raise InputError(f'{option} is "{text}": it must be at most 20 deg.')
    return found


def designed(
    design: str, which: str | None, variant: str | None, changes: list[str] | None
) -> tuple[Model, Design | None, SlotValues | Geometry | None]:
    """Return a model, and of a study the design and its values of the engine's parameters.

    The model is that of the file, or of the study without its design.
    """
    if FilePath(design).is_dir():
        if variant is not None or changes:
            raise InputError(f'"{design}" is a study: its model has no --set and --variant.')
        found = _recorded(FilePath(design), which)
        problem = found.problem
        values, _ = problem.parameters.designs(found.vector[None, :], problem.model)
        return problem.model, found, values
    if which is not None:
        raise InputError(f'--design is for a study folder, and "{design}" is none.')
    return load_changed(design, variant, changes), None, None


def _recorded(folder: FilePath, which: str | None) -> Design:
    """Return the best design of a folder, or that of a number or a name."""
    from flexor import export as making
    from flexor.study import has_members, member

    if has_members(folder):
        return making.recorded(member(folder, which), None)
    if which is None:
        return making.recorded(folder, None)
    try:
        number = int(which)
    except ValueError:
        raise InputError(
            f'--design is "{which}": the study "{folder}" has designs by their number, from 1.'
        ) from None
    return making.recorded(folder, number)


def _print_finger(
    model: Model,
    design: Design | None,
    chosen: FingerOptions,
    target: FilePath,
    plot: FilePath | None,
) -> list[FilePath]:
    """Write the limb and list its springs; return the files."""
    from flexor import export as making
    from flexor.export.finger_kit import HEADINGS, spring_row, write_finger

    with working("making the limb"):
        changed = model if design is None else making.model_of_design(design)
        made = making.finger(changed.file, chosen)
        written = write_finger(made, changed, target)
    if plot is not None:
        from flexor.export.drawing import finger_figure
        from flexor.plot import save

        written.append(save(finger_figure(made), plot))
    if made.springs:
        show(HEADINGS, [spring_row(each) for each in made.springs], left=1)
    return written


def _list(written: list[FilePath]) -> None:
    for file in written:
        say(f"file: {file}")


def _print_summary(body: Body, written: list[FilePath]) -> None:
    from flexor.export.masses import portions
    from flexor.export.walls import thinnest

    size = body.solid.bounding_box()
    say(
        f"{body.device.source}: "
        + " x ".join(number(size[i + 3] - size[i], 4) for i in range(3))
        + " mm"
    )
    rows = [
        (each.name, each.material, number(1e6 * each.volume, 4), number(1e3 * each.mass, 4))
        for each in portions(body)
    ]
    show(("cast", "material", "volume / mL", "mass / g"), rows, left=2)
    places = [(each.what, number(each.size, 3), number(each.x, 3)) for each in thinnest(body)]
    show(("thinnest", "mm", "at X"), places, left=1)
    _list(written)


def _as_json(body: Body, written: list[FilePath]) -> dict[str, Any]:
    """Return the volume, the portions and thin places (SI), and the files."""
    from flexor.export.masses import portions
    from flexor.export.walls import thinnest

    return {
        "volume": 1e-9 * body.solid.volume(),
        "portions": portions(body),
        "thinnest": [
            {"what": each.what, "size": 1e-3 * each.size, "X": each.x} for each in thinnest(body)
        ],
        "files": written,
    }
