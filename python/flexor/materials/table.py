"""A material as a table of a model file, with units."""

from __future__ import annotations

import math

from flexor.materials.material import KINDS, Constant, Material

_PURE = ("poisson_ratio", "alpha")


def model_table(material: Material, name: str | None = None) -> str:
    """Return the table ``[materials.NAME]`` that describes a material in a model file.

    Parameters
    ----------
    material
        The material.
    name
        What to call it; by default its own name.
    """
    lines = [f"[materials.{name or material.name}]"]
    if material.title:
        lines.append(f"# {material.title}")
    if material.source:
        lines.append(f"# {material.source}")
    if material.stretch_range is not None:
        low, high = material.stretch_range
        lines.append(f"# measured at stretches from {low:.4g} to {high:.4g}")
    lines.append(f'kind = "{material.kind}"')
    for key in KINDS[material.kind]:
        lines.append(f"{key} = {_constant(key, material[key])}")
    if material.winding != "none":
        lines.append(f'winding = "{material.winding}"')
    if material.density > 0.0:
        lines.append(f'density = "{material.density:g} kg/m^3"')
    if math.isfinite(material.strain_limit):
        lines.append(f"strain_limit = {material.strain_limit!r}")
    if math.isfinite(material.stress_limit):
        lines.append(f"stress_limit = {modulus(material.stress_limit)}")
    return "\n".join(lines) + "\n"


def modulus(value: float) -> str:
    """Return a modulus as the text of a model file, such as ``"23.9 kPa"``."""
    for scale, unit in ((1e9, "GPa"), (1e6, "MPa"), (1e3, "kPa")):
        if abs(value) >= scale:
            return f'"{value / scale:.6g} {unit}"'
    return f'"{value:.6g} Pa"'


def _constant(key: str, value: Constant) -> str:
    if isinstance(value, tuple):
        return "[" + ", ".join(_constant(key, each) for each in value) + "]"
    return f"{float(value)!r}" if key in _PURE else modulus(value)
