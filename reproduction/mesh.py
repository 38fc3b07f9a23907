"""Mesh dependence of the results."""

from __future__ import annotations

from functools import partial

import numpy as np

import flexor
from reproduction.fig3 import FORCES
from reproduction.optima import optimum
from reproduction.study import (
    CONSTANTS,
    FINGER,
    LINEAR,
    TWO_LINKS,
    Data,
    Study,
    bending,
    follow,
    parameters,
)


def compute(study: Study) -> Data:
    """Repeat Fig. 3, the default design and the optimum of L+R01 on other meshes."""

    def rows(constants: str) -> Data:
        best = np.array(optimum(study, LINEAR, "bending", constants)["design"])
        found = []
        for elements in study.effort.elements:
            changes = {"exosuit.elements": elements}
            three, two = (
                flexor.load(name, constants, changes).equilibrium(FORCES)
                for name in (FINGER, TWO_LINKS)
            )
            default, optimal = (
                follow(LINEAR, design, constants, changes)
                for design in (parameters(LINEAR).start, best)
            )
            found.append(
                {
                    "elements": elements,
                    "three_links": bending(three),
                    "two_links": bending(two),
                    "default": bending(default),
                    "optimum": bending(optimal),
                }
            )
        return {"rows": found}

    return {each: study.cached(f"mesh-{each}", partial(rows, each)) for each in CONSTANTS}
