"""The instructions to cast a body, on one page that can be printed."""

from __future__ import annotations

from html import escape
from string import Template
from typing import TYPE_CHECKING

import numpy as np

from flexor.export.body import Body
from flexor.export.drawing import drawing, picture
from flexor.export.masses import portions
from flexor.export.mould import Mould
from flexor.export.sheets import cast_material, sheets
from flexor.export.silicone import silicone
from flexor.export.solids import Solid
from flexor.export.walls import thinnest

if TYPE_CHECKING:
    from flexor.model import Path

SPARE = 1.2  # of silicone that is mixed, for what stays in cup and holes

_PAGE = Template("""<!doctype html>
<html lang="en">
<meta charset="utf-8">
<title>$title</title>
<style>
@page { size: A4; margin: 12mm }
body { font: 10.5px/1.35 "DejaVu Sans", Verdana, sans-serif; color: #1c2227; max-width: 186mm;
  margin: 4mm auto }
h1 { font-size: 16px; margin: 0 }
h2 { font-size: 11.5px; margin: 2mm 0 0.5mm }
p { margin: 0.5mm 0 }
table { border-collapse: collapse; width: 100% }
th, td { text-align: left; padding: 0.2mm 2mm 0.2mm 0; border-bottom: 0.2mm solid #c9d0d5 }
td.n, th.n { text-align: right }
ol { margin: 0; padding-left: 5mm }
svg { width: 100%; height: auto; display: block }
.two { display: grid; grid-template-columns: 1fr 1fr; gap: 0 6mm }
.limit { font-weight: bold }
</style>
<h1>$title</h1>
<p>$source</p>
$drawing
<div class="two">
<div><h2>To be poured</h2>
<table><tr><th>part<th>material<th class="n">mL<th class="n">g</tr>$poured</table>
<p>$silicone</p>
<p>$mix</p></div>
<div><h2>To be cut (sheets.dxf)</h2>
<table><tr><th>piece<th>material<th class="n">mm</tr>$cut</table></div>
<div><h2>To be printed</h2>
<table><tr><th>file<th class="n">mm<th class="n">cm³</tr>$printed</table></div>
<div>$picture
<p>Halves (blue), end plates (green), cores (grey), lids (pink).</p></div>
</div>
<h2>Order</h2>
<ol>$steps</ol>
<h2>Limits</h2>
$limits
</html>
""")


def page(mould: Mould, path: Path | None) -> str:
    """Return the instructions as an HTML page that needs no other file.

    Parameters
    ----------
    mould
        The mould.
    path
        Equilibria of the design under the loads it is evaluated at.
    """
    import flexor

    body = mould.body
    title = body.device.file.title or body.device.file.name
    cast = portions(body)
    mass, volume = sum(each.mass for each in cast), sum(each.volume for each in cast)
    mix = f"Mix {1e6 * SPARE * volume:.0f} mL" + (f" ({1e3 * SPARE * mass:.0f} g)" if mass else "")
    return _PAGE.substitute(
        title=escape(f"{title}: casting"),
        source=escape(f"From {body.device.source}, Flexor {flexor.__version__}. Lengths in mm."),
        drawing=drawing(body),
        picture=picture(mould),
        poured="".join(
            _row(each.name, each.material or "-", f"{1e6 * each.volume:.2f}", _grams(each.mass))
            for each in cast
        ),
        silicone=escape(" ".join(silicone(body))),
        mix=f"{mix}: a fifth stays in the cup and in the holes.",
        cut="".join(
            _row(
                each.name,
                each.material,
                " x ".join(f"{x:.1f}" for x in each.size) + f" x {each.thickness:.2g}",
                numbers=1,
            )
            for each in sheets(body)
        ),
        printed="".join(
            _row(
                f"{name}.stl",
                " x ".join(f"{x:.1f}" for x in _extent(solid)),
                f"{solid.volume() / 1e3:.1f}",
            )
            for name, solid in mould.printed().items()
        ),
        steps="".join(f"<li>{escape(step)}" for step in steps(mould)),
        limits="".join(
            f'<p class="{kind}">{escape(text)}</p>' for kind, text in _limits(body, path)
        ),
    )


def steps(mould: Mould) -> list[str]:
    """Return what to do, in order."""
    body = mould.body
    layers = [each for each in sheets(body) if each.name.startswith("layer")]
    material = cast_material(body)
    wound = bool(material) and body.device.file.materials[material].winding == "hoop"
    found = [
        "Print all parts as they lie in their files, with the cavity's surfaces smooth (layers of "
        "0.1 mm or less); remove strings, and coat all surfaces with release agent."
    ]
    if names := ", ".join(each.name for each in layers if not each.applied):
        found.append(
            f"Cut {names} and lay it on the lower half where it belongs; wet it with a thin film "
            "of silicone, so that no air stays below."
        )
    if mould.cores:
        names = ", ".join(core.name for core in mould.cores)
        found.append(f"Put {names} between the halves, and push the end plates over the ends.")
    found.append("Clamp halves and end plates together: the pins have to sit without a gap.")
    found.append(
        "Mix and degas the silicone. Raise the tip by about 20 degrees, and inject slowly through "
        "the hole at the base until silicone without bubbles comes out of every hole for air."
    )
    found.append("Let it cure as its maker says; then take off the end plates and the upper half.")
    for core in mould.cores:
        stretch = (
            f"; the body is stretched by {100.0 * core.stretch:.0f} % then, so use soap and air"
            if core.stretch > 0.02
            else ""
        )
        found.append(f"Pull {core.name} out at the {core.pull}{stretch}.")
    if wound:
        found.append(
            "Wind thread without stretch around the body from end to end, turn beside turn no "
            "further apart than the wall is thick"
            + (", and with a needle through the ears close to the body; " if body.ears else "; ")
            + "fix it with a thin coat of silicone."
        )
    if names := ", ".join(each.name for each in layers if each.applied):
        found.append(f"Cut {names} and bond it with silicone along the middle of the underside.")
    for end in body.caps:
        tubes = [inlet.pressure for inlet in body.inlets if inlet.end == end]
        tube = (
            f" Push the tube of {' and '.join(tubes)} ({1e3 * body.options.inlet:.3g} mm) through "
            "its hole, so that it ends above the cap, and close the hole around it."
            if tubes
            else ""
        )
        found.append(
            f"Cap the {end}: stand lid-{end} on its bottom and fill it to a depth of "
            f"{1e3 * body.options.cap:.3g} mm.{tube} Push the end of the body in until it touches, "
            "and let it cure upright."
        )
    for inlet in body.inlets:
        if inlet.end == "top":
            found.append(
                f"Pierce the hole for the tube of {inlet.pressure} from above, "
                f"{inlet.place[0]:.1f} mm from the base, and glue the tube in with silicone."
            )
    if body.ears:
        found.append(
            "Thread each strap through the slots of its ears and around the limb, and fold back "
            f"and fasten {1e3 * body.options.fold:.3g} mm at either end."
        )
    if body.inlets:
        found.append(
            "Inflate it under water to a fifth of the pressure below: no bubbles may rise."
        )
    return found


def _limits(body: Body, path: Path | None) -> list[tuple[str, str]]:
    """Return the limit of the pressure and the thinnest places, with their class."""
    thin = min(thinnest(body), key=lambda each: each.size)
    found = [("", f"Thinnest: {thin.what}, {thin.size:.2f} mm at X = {thin.x:.3g}.")]
    if path is None or not len(path):
        return found
    model, largest = path.model, np.max(path.loads, axis=0)
    each = [model.show_load(float(load), ".4g", index) for index, load in enumerate(largest)]
    if len(each) > 1:
        each = [f"{load} ({name})" for load, name in zip(each, model.inputs, strict=True)]
    loads = ", ".join(each)
    if path.converged.all():
        text = f"Do not load it beyond {loads}, up to which it was computed"
        strain = np.asarray(path.max_strain)
        if np.isfinite(strain).any():
            text += f" (largest strain of a material {100.0 * np.nanmax(strain):.3g} %)"
        found.insert(0, ("limit", f"{text}."))
    else:
        found.insert(0, ("limit", f"It has no computed equilibrium at {loads}: find its limit."))
    found += [("", f"Warning: {warning}.") for warning in path.warnings]
    return found


def _grams(mass: float) -> str:
    return f"{1e3 * mass:.2f}" if mass else "-"


def _extent(solid: Solid) -> tuple[float, float, float]:
    low_x, low_y, low_z, high_x, high_y, high_z = solid.bounding_box()
    return high_x - low_x, high_y - low_y, high_z - low_z


def _row(*cells: str, numbers: int = 2) -> str:
    texts = len(cells) - numbers
    shown = (
        f"<td{' class=n' if i >= texts else ''}>{escape(cell)}" for i, cell in enumerate(cells)
    )
    return f"<tr>{''.join(shown)}</tr>"
