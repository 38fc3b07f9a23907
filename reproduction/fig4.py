"""Fig. 4: the landscape of f_b over base and tip radius, and two methods on it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

import flexor
from flexor.optimizers import starting_designs
from flexor.study.landscape import SearchPath
from reproduction.optima import evaluated, optimum, target
from reproduction.study import FINGER, PUBLISHED, SURFACE, Data, Study, model, parameters

if TYPE_CHECKING:
    from matplotlib.figure import Figure

# The paper's contact spheres make the contact force oscillate in sliding; round cones do not.
CONTACTS = {"spheres": {}, "round-cones": {"contacts.skin.shape": "round-cones"}}
METHODS = {
    "levenberg-marquardt": ("L", "Levenberg-Marquardt", PUBLISHED["fig4"]["least_squares_starts"]),
    "pattern-search": ("P", "pattern search", PUBLISHED["fig4"]["pattern_search_starts"]),
}


def compute(study: Study) -> Data:
    """Evaluate both landscapes and run both methods from random starts."""
    best = optimum(study, "R01")
    searches = study.cached("fig4-searches", lambda: _searches(study))
    reached = target(study, best["value"])
    return {
        "best": best,
        "target": reached,
        "searches": searches,
        "found": {
            method: sum(run["values"][-1] <= reached for run in searches[method])
            for method in METHODS
        },
        "methods": METHODS,
        "at_published": study.cached("fig4-published-minimum", _at_published_minimum),
        "landscapes": {contact: _summary(_landscape(study, contact)) for contact in CONTACTS},
    }


def draw(study: Study, data: Data) -> dict[str, Figure]:
    """Draw both landscapes, that of the paper with the search paths."""
    from flexor import plot

    paths = [
        SearchPath(
            label=f"${letter}_{{{i + 1}}}$",
            method=method,
            designs=np.array(run["designs"]),
            values=np.array(run["values"]),
            evaluations=np.array(run["evaluations"], dtype=np.float64),
        )
        for method, (letter, _, _) in METHODS.items()
        for i, run in enumerate(data["searches"][method])
    ]
    return {
        "fig4": plot.landscape(_landscape(study, "spheres"), paths),
        "fig4-round-cones": plot.landscape(_landscape(study, "round-cones")),
    }


def _landscape(study: Study, contact: str) -> flexor.Landscape:
    folder, exists = study.subfolder(f"landscape-{contact}")
    if not exists:
        study.report_progress(f"landscape, contact by {contact}")
    chosen = flexor.load(FINGER, SURFACE, CONTACTS[contact])
    return flexor.landscape(
        chosen, "R01", "bending", grid=study.effort.grid, folder=folder, resume=exists
    )


def _summary(landscape: flexor.Landscape) -> Data:
    value = np.where(landscape.failed, np.nan, landscape.value)
    best = landscape.minimum
    return {
        "designs": landscape.value.size,
        "radii": (100.0 * best.vector).tolist(),
        "value": best.value,
        "bending": best.bending,
        "minima": len(landscape.local_minima()),
        "largest_step": max(float(np.nanmax(np.abs(np.diff(value, axis=i)))) for i in (0, 1)),
        "snapping": 100.0 * float((landscape.events > 0).mean()),
        "failed": int(landscape.failed.sum()),
    }


def _at_published_minimum() -> Data:
    return evaluated("R01", np.array(PUBLISHED["fig4"]["minimum"]) * parameters("R01").scale)


def _searches(study: Study) -> Data:
    """Run both methods; return the improvements of each search."""
    random = np.random.default_rng(study.seed)
    chosen = parameters("R01")
    found: Data = {}
    for method, (_, _, count) in METHODS.items():
        # One Latin hypercube per method, so that its starts cover the range.
        starts = starting_designs(None, count, chosen.lower, chosen.upper, random)
        found[method] = []
        for start in starts:
            done = flexor.optimize(
                model(), chosen, "bending", method, start=start, seed=study.seed,
                budget=study.effort.pattern_search,
            ).result  # fmt: skip
            assert done is not None
            found[method].append(
                {
                    "designs": done.improvement_designs.tolist(),
                    "values": done.improvement_values.tolist(),
                    "evaluations": done.improvement_evaluations.tolist(),
                    "spent": done.evaluations,
                }
            )
    return found
