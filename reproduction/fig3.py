"""Fig. 3: the exosuit alone, on two links and on three, from 0 to 10 N."""

from __future__ import annotations

from math import degrees
from typing import TYPE_CHECKING

import numpy as np

from reproduction.panels import Layer, Panel, draw_panels, load_handles
from reproduction.study import (
    ALONE,
    FINGER,
    TWO_LINKS,
    Data,
    Study,
    bending,
    model,
    tip_angle,
)

if TYPE_CHECKING:
    from matplotlib.figure import Figure

FORCES = np.arange(0.0, 10.1, 2.0)  # N


def compute(study: Study) -> Data:
    """Follow the three models."""

    def follow() -> Data:
        alone, two, three = (model(name).equilibrium(FORCES) for name in (ALONE, TWO_LINKS, FINGER))
        return {
            "rows": [
                {
                    "force": float(force),
                    "alone": degrees(tip_angle(alone, step)),
                    "held": degrees(tip_angle(three, step)),
                    "two": np.degrees(two.joint_angles[step]).tolist(),
                    "two_sum": bending(two, step),
                    "three": np.degrees(three.joint_angles[step]).tolist(),
                    "three_sum": bending(three, step),
                    "touching": int(three.touching[step]),
                    "snaps": sum(e.step == step for p in (two, three) for e in p.events),
                }
                for step, force in enumerate(FORCES)
            ]
        }

    return study.cached("fig3", follow)


def draw(study: Study, data: Data) -> dict[str, Figure]:
    """Draw the three rows of the figure as three panels."""
    last = data["rows"][-1]
    titles = {
        ALONE: f"exosuit alone: tip turns {last['alone']:.0f}°",
        TWO_LINKS: f"two links: {last['two_sum']:.2f} rad",
        FINGER: f"three links: {last['three_sum']:.2f} rad",
    }
    panels = [
        Panel(title, Layer.along(model(name).equilibrium(FORCES), 0.55, 0.9))
        for name, title in titles.items()
    ]
    return {"fig3": draw_panels(panels, 3, load_handles(FORCES))}
