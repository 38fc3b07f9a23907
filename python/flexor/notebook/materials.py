"""Materials as HTML."""

from __future__ import annotations

from flexor.materials import Material
from flexor.notebook.card import card, html, picture, table
from flexor.plot.material_figure import draw_materials


@html.register
def _(material: Material) -> str:
    rows = [
        ("law", material.kind),
        *((key, str(value)) for key, value in material.constants.items()),
        ("winding", material.winding),
        ("Young's modulus at rest", f"{material.young_modulus / 1e3:.4g} kPa"),
        ("source", material.source),
    ]
    drawn = picture(draw_materials([material]), f"Nominal stress of {material.name} over strain")
    shown = table(("", ""), [row for row in rows if row[1]], 2)
    return card(material.name, material.title, drawn, shown)
