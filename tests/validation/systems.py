"""Model files of the systems that are validated, so that cases test the way from file to result."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from flexor.model import Model
from flexor.model.reading import check

Array = NDArray[np.float64]
Json = dict[str, Any]
Vector = Sequence[float] | Array


def build(
    name: str,
    bodies: Mapping[str, Json],
    *,
    planar: bool = True,
    gravity: Vector = (0.0, 0.0, 0.0),
    **interactions: Json,
) -> Model:
    """Build a model as from a file."""
    document = {
        "name": name,
        "planar": planar,
        "gravity": vector(gravity, "m/s^2"),
        "bodies": dict(bodies),
        **interactions,
    }
    return Model(check(document, source=name))


def rod(
    length: float,
    radius: float | tuple[float, float],
    strain: Mapping[str, object],
    *,
    young_modulus: float = 1e6,
    elements: int = 1,
    gauss_points: int = 12,
    **fields: object,
) -> Json:
    """Write the table of a rod.

    Parameters
    ----------
    length, radius
        Length and radius (or radii of base and tip) [m].
    strain
        Modes with their bases.
    young_modulus
        [Pa]; the material is incompressible.
    elements, gauss_points
        The discretisation.
    **fields
        Further fields as in a file.
    """
    base, tip = radius if isinstance(radius, tuple) else (radius, radius)
    return {
        "kind": "rod",
        "length": si(length, "m"),
        "radius": {"base": si(base, "m"), "tip": si(tip, "m")},
        "young_modulus": si(young_modulus, "Pa"),
        "poisson_ratio": 0.5,
        "strain": dict(strain),
        "elements": elements,
        "gauss_points": gauss_points,
        **fields,
    }


def link(length: float, radius: float | tuple[float, float], **fields: object) -> Json:
    """Write the table of a link."""
    base, tip = radius if isinstance(radius, tuple) else (radius, radius)
    taper = {"base": si(base, "m"), "tip": si(tip, "m")}
    return {"kind": "link", "length": si(length, "m"), "radius": taper, **fields}


def legendre(order: int) -> Json:
    """Name the Legendre polynomials up to a degree along the whole rod."""
    return {"basis": "legendre", "order": order}


def si(value: float, unit: str) -> str:
    """Write a quantity so that it reads back to the same number."""
    return f"{float(value)!r} {unit}"


def vector(components: Vector, unit: str) -> Json:
    """Write a vector of quantities."""
    return {axis: si(value, unit) for axis, value in zip("xyz", components, strict=True)}


def sample_points(model: Model, name: str) -> Array:
    """Return the places X in [0, 1] of a rod's frames, (P,)."""
    return model.file.rod(name).sample_points
