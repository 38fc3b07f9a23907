"""Constraints that hold by default: what a device must keep to be worn and made."""

from __future__ import annotations

from collections.abc import Iterator

from flexor.constraints.constraint import Constraint, constraint
from flexor.model.limits import skin_depth
from flexor.model.structure import Structure
from flexor.observables import observables

# Of spheres, which have no thickness: overlaps that follow from materials stay below.
SPHERES = 1e-3


def default_constraints(model: Structure) -> tuple[Constraint, ...]:
    """Return the constraints that hold by default for a model.

    Parameters
    ----------
    model
        The model.

    Returns
    -------
    tuple of Constraint
        ``overlap``: at most half of the thickness of the skins that touch, 1 mm for spheres;
        ``centreline``: no centreline of a rod inside a body that it touches;
        ``strain`` and ``stress``: within the limits of the materials that have them;
        ``stretch``: no fibre shorter than a tenth of its length.
    """
    return tuple(_defaults(model))


def _defaults(model: Structure) -> Iterator[Constraint]:
    present = observables(model)
    if "overlap" in present:
        yield constraint(f"overlap <= {_overlap(model)!r} m", model, "overlap")
    if "centreline-depth" in present:
        yield constraint("centreline-depth <= 0 mm", model, "centreline")
    for key in ("strain", "stress"):
        if f"{key}-use" in present:
            yield constraint(f"{key}-use <= 1", model, key)
    if "min-stretch" in present:
        yield constraint("min-stretch >= 0.1", model, "stretch")


def _overlap(model: Structure) -> float:
    """Return the depth that the skins of a model bear, or that of spheres."""
    depth = skin_depth(model.file)
    return SPHERES if depth is None or model.file.contacts else depth
