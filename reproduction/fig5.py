"""Fig. 5: the default and every optimal design, at 0 and 5 N."""

from __future__ import annotations

from typing import TYPE_CHECKING

from reproduction.optima import default_design, optimum
from reproduction.panels import draw_designs
from reproduction.study import SETS, SURFACE, Data, Study, follow, parameters

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def compute(study: Study) -> Data:
    """Return the bending of each design [rad]."""
    best = {name: optimum(study, name)["bending"] for name in SETS}
    return {"bending": {"default": default_design(study)["bending"], **best}}


def draw(study: Study, data: Data) -> dict[str, Figure]:
    """Draw every design."""
    return {"fig5": designs(study, SURFACE, data["bending"])}


def designs(study: Study, constants: str, bending: dict[str, float]) -> Figure:
    """Draw the default and every optimal design with a set of constants."""
    paths = {"default": follow("L", parameters("L").start, constants)}
    for name in SETS:
        paths[name] = follow(name, optimum(study, name, constants=constants)["design"], constants)
    return draw_designs({f"{name}: {bending[name]:.2f} rad": paths[name] for name in paths})
