"""Table IV: three objectives, one of them in two interpretations, over length and radii."""

from __future__ import annotations

from reproduction.optima import optimum, published
from reproduction.study import CONSTANTS, LINEAR, OBJECTIVES, Data, Study


def compute(study: Study) -> Data:
    """Find the optimum of L+R01 for every objective, with every set of constants."""
    return {
        "best": {
            each: {name: optimum(study, LINEAR, name, each) for name in OBJECTIVES}
            for each in CONSTANTS
        },
        "published": {
            each: {name: published(study, LINEAR, name, each) for name in OBJECTIVES}
            for each in CONSTANTS
        },
    }
