"""The uncertain constants: the fit of `surface`, and the results of each set of constants."""

from __future__ import annotations

from functools import partial
from math import pi
from typing import TYPE_CHECKING

import numpy as np

from flexor.calibration import calibrate
from reproduction.fig3 import FORCES
from reproduction.optima import distance, evaluated, optimum
from reproduction.panels import Layer, Panel, draw_panels, load_handles
from reproduction.study import (
    ALONE,
    CONSTANTS,
    FINGER,
    HERE,
    LINEAR,
    PRINTED,
    TWO_LINKS,
    Data,
    Study,
    bending,
    model,
    published_design,
    tip_angle,
)

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    import flexor

TARGETS = HERE / "surface-targets.toml"
UNIT_FORCES = np.arange(0.0, 5.1, 1.0)  # N


def compute(study: Study) -> Data:
    """Fit two constants, and compute the experiments of the paper with every set."""
    sets = {
        name: study.cached(f"constants-{name}", partial(_experiments, name))
        for name in (PRINTED, *CONSTANTS)
    }
    return {
        "fit": study.cached("fit", lambda: _fit(study)),
        "sets": sets,
        "optima": {name: optimum(study, LINEAR, "bending", name) for name in CONSTANTS},
        "distance": {name: distance(study, name) for name in CONSTANTS},
    }


def draw(study: Study, data: Data) -> dict[str, Figure]:
    """Draw the free exosuit and the finger in 1 N steps, with three sets of constants."""
    names = (PRINTED, *CONSTANTS[:2])
    panels = []
    for body, what in ((ALONE, "exosuit alone"), (FINGER, "on the finger")):
        for name in names:
            path = model(body, name).equilibrium(UNIT_FORCES)
            turns, angle = data["sets"][name]["turns_5"], bending(path) if body == FINGER else 0.0
            end = f"{turns:.2f} turns at 5 N" if body == ALONE else f"{angle:.2f} rad at 5 N"
            panels.append(Panel(f"{name}, {what}\n{end}", Layer.along(path, 0.8)))
    handles = load_handles(UNIT_FORCES, "chamber (drawn on the surface)")
    return {"constants": draw_panels(panels, len(names), handles)}


def _fit(study: Study) -> Data:
    found = calibrate(
        model(FINGER, PRINTED), TARGETS, samples=study.effort.samples,
        starts=study.effort.starts, seed=study.seed,
    ).best  # fmt: skip
    return {name: float(value) for name, value in found.constants.items()}


def _experiments(name: str) -> Data:
    alone, two, three = (model(each, name) for each in (ALONE, TWO_LINKS, FINGER))
    paths = {each: each.equilibrium(FORCES) for each in (alone, two, three)}
    at_5 = alone.equilibrium(UNIT_FORCES)
    optimal = evaluated(LINEAR, published_design(LINEAR), constants=name)
    spheres = three.sphere_groups
    return {
        "dof": three.dof,
        "exosuit_spheres": spheres["exosuit"],
        "finger_spheres": spheres["finger"],
        "E": float(three.slot("exosuit.young_modulus")[0]),
        "lever": float(three.slot("chamber.lever")[1]),
        "k": float(three.slot("skin.stiffness")[0]),
        "turns_5": tip_angle(at_5) / (2.0 * pi),
        "turns_10": tip_angle(paths[alone]) / (2.0 * pi),
        "strain_5": _largest_strain(alone, at_5),
        "strain_10": _largest_strain(alone, paths[alone]),
        "two_links": bending(paths[two]),
        "three_links": bending(paths[three]),
        "snaps": len(paths[two].events) + len(paths[three].events),
        "published_optimum": optimal["bending"],
    }


def _largest_strain(model: flexor.Model, path: flexor.Path) -> float:
    """Return the largest axial strain along the rod at the last load."""
    names = model.engine.coordinates
    return float(max(q for q, name in zip(path.q[-1], names, strict=True) if ".extend_x" in name))
