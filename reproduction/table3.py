"""Table III: published and computed optimum of every parameter set."""

from __future__ import annotations

from reproduction.optima import NESTED, default_design, optimum, pattern_search, published, target
from reproduction.study import CONSTANTS, SETS, Data, Study


def compute(study: Study) -> Data:
    """Find the optimum of every set, with every set of constants."""
    best = {
        each: {name: optimum(study, name, constants=each) for name in SETS} for each in CONSTANTS
    }
    ours = best[CONSTANTS[0]]
    searched = {name: pattern_search(study, name) for name in SETS}
    return {
        "default": {each: default_design(study, each) for each in CONSTANTS},
        "best": best,
        "published": {
            each: {name: published(study, name, constants=each) for name in SETS}
            for each in CONSTANTS
        },
        "searched": searched,
        "order": sorted(SETS, key=lambda name: -ours[name]["bending"]),
        "missed": [
            name for name in SETS if searched[name]["value"] > target(study, ours[name]["value"])
        ],
        "worse_than_contained": [
            f"{outer} than {inner}"
            for outer, contained in NESTED.items()
            for inner in contained
            # Rounding of the designs changes values by less than this.
            if ours[outer]["value"] > ours[inner]["value"] + 1e-4
        ],
    }
