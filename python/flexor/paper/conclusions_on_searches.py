"""What the paper concludes on searches and on mechanics."""

from __future__ import annotations

from collections.abc import Mapping
from math import degrees

import numpy as np

from flexor.paper import published
from flexor.paper.conclusion import Conclusion
from flexor.paper.context import ALONE, FINGER, Context
from flexor.paper.default import target
from flexor.paper.fig3 import FORCES, tip_angle
from flexor.paper.fig4_searches import searches_on_landscape
from flexor.paper.optimisers import method_comparison, success_rates, title
from flexor.paper.optimum import Optimum
from flexor.paper.pattern_search import paper_search

# Methods that take derivatives.
GRADIENT = ("levenberg-marquardt",)
# A finger is curled if both joints beyond the knuckle bend by more than this.
CURLED = np.radians(30.0)


def on_searches(context: Context, best: Mapping[str, Optimum]) -> list[Conclusion]:
    """Test what is said of the methods and of the landscape.

    Parameters
    ----------
    context : Context
        Models, settings and folder.
    best : dict of Optimum
        By parameter set.
    """
    searches = searches_on_landscape(context).data
    reached = target(context, best["R01"].value)
    found = {
        method: (sum(run["values"][-1] <= reached for run in runs), len(runs))
        for method, runs in searches.items()
    }
    least, polls = found["levenberg-marquardt"], found["pattern-search"]
    comparison = method_comparison(context)
    rates = success_rates(comparison)
    free = {method: rate for method, rate in rates.items() if method not in GRADIENT}
    order = sorted(free, key=lambda method: -free[method])
    large = paper_search(context, "L+RLP")
    R_0, R_1 = (100.0 * float(value) for value in best["R01"].design)
    low, high = (100.0 * bound for bound in published.SURVEYED)
    least_ends = [run["values"][-1] for run in searches["levenberg-marquardt"]]
    return [
        Conclusion(
            "least squares gets stuck short of the global minimum of R01",
            "Sec. III, Fig. 4",
            least[0] < 0.5 * least[1],
            f"{least[0]} of {least[1]} starts find it; the worst ends at f_b = "
            f"{max(least_ends):.3f} rad, the minimum is {best['R01'].value:.3f} rad",
        ),
        Conclusion(
            "pattern search finds the global minimum of R01",
            "Sec. III, Fig. 4",
            polls[0] == polls[1],
            f"{polls[0]} of {polls[1]} starts find it",
        ),
        Conclusion(
            "pattern search is the most robust of the methods without gradients",
            "Sec. IV",
            order[0] == "pattern-search",
            "searches that succeed, over all sets: "
            + ", ".join(f"{title(name)} {100.0 * free[name]:.0f} %" for name in order),
        ),
        Conclusion(
            "pattern search may have failed to find the optimum of the 11 parameters of L+RLP",
            "Sec. IV",
            large.value > target(context, best["L+RLP"].value),
            f"from the default design it ends at {large.bending:.2f} rad of bending, the optimum "
            f"is {best['L+RLP'].bending:.2f} rad",
        ),
        Conclusion(
            "the best radii are not at the lower bound of 0.4 cm but inside the range",
            "Sec. III, IV, Fig. 4",
            low + 0.011 < min(R_0, R_1) and max(R_0, R_1) < high - 0.011,
            f"R_0 = {R_0:.3f} cm, R_1 = {R_1:.3f} cm",
        ),
    ]


def on_mechanics(context: Context, best: Mapping[str, Optimum]) -> list[Conclusion]:
    """Test what is said of the interaction of exosuit and finger.

    Parameters
    ----------
    context : Context
        Models, settings and folder.
    best : dict of Optimum
        By parameter set.
    """

    def compute() -> dict[str, float]:
        free = context.model(ALONE).equilibrium(FORCES)
        held = context.model(FINGER).equilibrium(FORCES)
        return {
            "alone": tip_angle(free, -1),
            "held": tip_angle(held, -1),
            "joints": float(held.joint_angles[-1].sum()),
        }

    turned = context.part("conclusions-tip", compute).data
    furthest = max(best.values(), key=lambda found: found.bending)
    angles = [degrees(angle) for angle in furthest.joint_angles.tolist()]
    return [
        Conclusion(
            "the mechanics of the interaction are essential to judge the actuation",
            "Abstract, Fig. 3",
            turned["joints"] < 0.9 * turned["alone"],
            f"at 10 N the tip of the free exosuit turns by {degrees(turned['alone']):.0f}°, on the "
            f"finger by {degrees(turned['held']):.0f}°, and the joints bend by "
            f"{degrees(turned['joints']):.0f}°",
        ),
        Conclusion(
            "such an exosuit bends the joints but cannot curl the finger",
            "Sec. IV",
            not all(angle > CURLED for angle in furthest.joint_angles[1:].tolist()),
            f"the optimum of {furthest.parameters} bends the joints by "
            + ", ".join(f"{angle:.0f}°" for angle in angles),
        ),
    ]
