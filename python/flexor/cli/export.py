"""`flexor export`: what is made of a design."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import fields
from pathlib import Path as FilePath
from typing import TYPE_CHECKING, Annotated, Any

import typer

from flexor.cli import options
from flexor.cli.console import err, print_json, say
from flexor.cli.table import number, show
from flexor.cli.values import load_changed
from flexor.errors import InputError

if TYPE_CHECKING:
    from flexor.export import Body, BodyOptions, Device, MouldOptions
    from flexor.model import Model, Path

_BODY, _MOULD = "Dimensions of the body", "Dimensions of the mould"


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
        typer.Option(metavar="FILE", help="Write the body as a solid: an STL or 3MF file, in mm."),
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
    index: Annotated[
        int | None,
        typer.Option(
            "--design",
            metavar="N",
            callback=options.at_least(1),
            help="Number of a recorded design of the study, from 1 in the order of evaluation.",
        ),
    ] = None,
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
    plot: options.Plot = None,
    as_json: options.Json = False,
) -> int:
    """Export what is made of a design: the body, its mould, and sheets to cut.

    The solids have the sections of the model, which the mechanics is computed with. Bores go from
    end to end of the spans of their pressures; caps are added at the ends of the rod, ears with
    slots beside it where straps are. Needs the extra `flexor[make]`.

    Examples
    --------
    * `flexor export pneumatic-finger --body body.stl --sheets sheets.dxf`
    * `flexor export studies/pneumatic-finger-fields-range-of-motion --mould mould/`
    * `flexor export studies/r01 --design 12 --body twelfth.3mf`
    * `flexor export pneumatic-finger --mould mould/ --draft "1 deg" --shrinkage 0.001`
    """
    from flexor import export as making
    from flexor.export import files

    given = dict(locals())
    if body is None and mould is None and sheets is None and plot is None:
        raise InputError("nothing to export: give --body, --mould, --sheets or --plot.")
    for path, formats in ((body, files.FORMATS), (sheets, (".dxf",))):
        if path is not None:
            files.check_target(path, force, formats)
    if mould is not None:
        files.check_folder(mould, force)
    chosen, of_mould = _options(given)
    device, equilibria = _device(design, index, rod, variant, changes)
    written: list[FilePath] = []
    with err.status("making the body"):
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

        with err.status("making the mould"):
            cast = making.mould(device, of_mould, chosen)
            written += write_kit(cast, mould, equilibria())
    if plot is not None:
        from flexor.export.drawing import making_figure
        from flexor.plot import save

        with err.status("drawing"):
            written.append(save(making_figure(made, cast), plot))
    if as_json:
        print_json(_as_json(made, written))
    else:
        _print_summary(made, written)
    return 0


def _options(given: dict[str, Any]) -> tuple[BodyOptions, MouldOptions]:
    from flexor.export import BodyOptions, MouldOptions
    from flexor.model.quantity import parse_quantity
    from flexor.model.units import ANGLE, LENGTH

    def value(name: str) -> float:
        text = given[name]
        option = "--" + name.replace("_", "-")
        if isinstance(text, float):
            if not 0.0 <= text < 1.0:
                raise InputError(f"{option} is {text:g}: expected a number from 0 to below 1.")
            return text
        found, _ = parse_quantity(text, ANGLE if name == "draft" else LENGTH, option)
        low = name in ("draft", "clearance", "fold")
        if found < 0.0 or (found == 0.0 and not low):
            raise InputError(
                f'{option} is "{text}": it must be {"at least" if low else "above"} 0.'
            )
        if name == "draft" and found > 0.35:
            raise InputError(f'{option} is "{text}": it must be at most 20 deg.')
        return found

    return (
        BodyOptions(**{each.name: value(each.name) for each in fields(BodyOptions)}),
        MouldOptions(**{each.name: value(each.name) for each in fields(MouldOptions)}),
    )


def _device(
    design: str,
    index: int | None,
    rod: str | None,
    variant: str | None,
    changes: list[str] | None,
) -> tuple[Device, Callable[[], Path]]:
    """Return the device, and what computes its path under the loads of its evaluation."""
    from flexor import export as making

    if FilePath(design).is_dir():
        if variant is not None or changes:
            raise InputError(f'"{design}" is a study: its model has no --set and --variant.')
        found = making.recorded(FilePath(design), index)
        name = f"the best design of {design}" if index is None else f"design {index} of {design}"
        return making.device_of_design(found, rod, name), lambda: found.path
    if index is not None:
        raise InputError(f'--design is for a study folder, and "{design}" is none.')
    model: Model = load_changed(design, variant, changes)
    return making.device_of(model, rod, f'the model "{model.name}"'), model.equilibrium


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
    for file in written:
        say(f"file: {file}")


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
