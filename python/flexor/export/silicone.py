"""Which silicone is cast, and how it is mixed."""

from __future__ import annotations

from flexor import materials
from flexor.export.body import Body
from flexor.export.sheets import cast_material

# Parts A to B of the makers' data sheets, by the first words of a material's name in the library.
MIXES = {
    "dragon-skin": "1 part A to 1 part B, by mass or volume",
    "ecoflex": "1 part A to 1 part B, by mass or volume",
    "elastosil-m4601": "9 parts A to 1 part B, by mass",
}


def silicone(body: Body) -> list[str]:
    """Return what is cast, in sentences: its name, where its constants are from, and its mix."""
    name = cast_material(body)
    if not name:
        return ["The model gives the stiffness of its section, not the material to cast."]
    table = body.device.file.materials[name]
    known = materials.library()
    library = table.library or (name if name in known else None)
    density = f"{float(table.density):.4g} kg/m³" if table.density else "density not given"
    if library is None:
        return [
            f'Material: "{name}" of the model, {table.kind}, {density}; the file does not say '
            "which product that is."
        ]
    found = known[library]
    own = f' ("{name}" in the model)' if name != library else ""
    sentences = [f"Material: {found.title}{own}, {density}."]
    if found.source:
        sentences.append(f"Its constants: {found.source}.")
    ratio = next((mix for key, mix in MIXES.items() if library.startswith(key)), None)
    sentences.append(f"Parts: {ratio}." if ratio else "Parts: see the maker's data sheet.")
    return sentences
