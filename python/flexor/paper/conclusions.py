"""The paper's conclusions, tested one by one."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import degrees

import numpy as np

from flexor.paper import published
from flexor.paper.context import ALONE, FINGER, Context
from flexor.paper.default import default_design, target
from flexor.paper.fig3 import FORCES, tip_angle
from flexor.paper.fig4 import searches_on_landscape
from flexor.paper.optimisers import method_comparison, success_rates, title
from flexor.paper.optimum import Optimum, as_legendre, true_optimum
from flexor.paper.pattern_search import paper_search
from flexor.paper.section import Column, Section, Table
from flexor.paper.settings import OBJECTIVES, SETS
from flexor.paper.table3 import published_design

# Methods that take derivatives, if only by differences.
GRADIENT = ("levenberg-marquardt",)
# A joint that takes part in curling bends by more than this.
CURLED = np.radians(30.0)


@dataclass(frozen=True)
class Conclusion:
    """A conclusion of the paper and what became of it.

    Attributes
    ----------
    claim : str
        What the paper says.
    place : str
        Where.
    holds : bool
        Whether it holds in our model.
    evidence : str
        The numbers.
    """

    claim: str
    place: str
    holds: bool
    evidence: str


def conclusions(context: Context) -> Section:
    """Test the paper's conclusions.

    Parameters
    ----------
    context : Context
        Models, settings and folder.

    Returns
    -------
    Section
        Each with a yes or no and the numbers.
    """
    best = {name: true_optimum(context, name) for name in SETS}
    by_objective = {name: true_optimum(context, "L+R01", name) for name in OBJECTIVES}
    found = [
        *_of_designs(context, best),
        *_of_objectives(context, by_objective),
        *_of_searches(context, best),
        *_of_mechanics(context, best),
    ]
    held = sum(each.holds for each in found)
    return Section(
        name="conclusions",
        title="The paper's conclusions, one by one",
        text=(
            f"{held} of {len(found)} conclusions hold in our model with the constants "
            f'"{context.settings.constants}", {len(found) - held} do not.',
        ),
        tables=(
            Table(
                name="conclusions",
                caption="What the paper concludes, and what our model says.",
                columns=(Column("conclusion"), Column("place"), Column("holds"), Column("numbers")),
                rows=tuple((each.claim, each.place, each.holds, each.evidence) for each in found),
            ),
        ),
    )


def _of_designs(context: Context, best: Mapping[str, Optimum]) -> list[Conclusion]:
    default = default_design(context)["bending"]
    ends = {name: _ends(context, best[name]) for name in SETS if name != "L"}
    shapes = ("R01", "Rsc", "RLP")
    thick = {name: ends[name][1] > 1.01 * ends[name][0] for name in shapes}
    gain = {name: best[name].bending - default for name in ("L", *shapes)}
    lengths = {name: 100.0 * best[name].design[0] for name in ("L+Rsc", "L+RLP")}
    largest = max(SETS, key=lambda name: best[name].bending)
    linear = np.array(published.TABLE_III["L+R01"].design)
    problem = context.problem("L+RLP")
    lifted = np.concatenate((linear[:1], as_legendre(linear[1:], problem.parameters.size - 1)))
    as_rlp = context.part(
        "published-lifted", lambda: {"bending": _bending(context, "L+RLP", lifted)}
    ).data["bending"]
    return [
        Conclusion(
            "all optimal designs bend the finger further than the default",
            "Sec. III",
            all(best[name].bending > default for name in SETS),
            f"default {default:.2f} rad; "
            + ", ".join(f"{name} {best[name].bending:.2f}" for name in SETS),
        ),
        Conclusion(
            "the optimal surface has a thin base and a thick tip, for R01, Rsc and RLP",
            "Sec. IV, Fig. 5",
            all(thick.values()),
            "radius at base and tip: "
            + ", ".join(
                f"{name} {ends[name][0]:.2f} to {ends[name][1]:.2f} cm"
                + ("" if name not in thick or thick[name] else " (no)")
                for name in ends
            ),
        ),
        Conclusion(
            "the shape of the surface matters more for bending than the length",
            "Sec. IV",
            gain["R01"] > gain["L"],
            "gained over the default by L alone "
            f"{gain['L']:.2f} rad, by "
            + ", ".join(f"{name} alone {gain[name]:.2f}" for name in shapes)
            + f", by L and R01 together {best['L+R01'].bending - default:.2f}",
        ),
        Conclusion(
            "with a general surface the optimal length stays close to the default 10 cm",
            "Sec. IV, Table III",
            all(abs(length - 10.0) < 0.5 for length in lengths.values()),
            ", ".join(f"{name} {length:.1f} cm" for name, length in lengths.items()),
        ),
        Conclusion(
            "L+R01 bends the finger furthest of all sets",
            "Sec. III, Fig. 5",
            largest == "L+R01",
            ", ".join(f"{name} {best[name].bending:.2f} rad" for name in ("L+R01", "L+RLP"))
            + "; L+RLP holds the published optimum of L+R01, which as its coefficients bends "
            f"{as_rlp:.2f} rad in our model, and the published optimum of L+RLP "
            f"{published_design(context, 'L+RLP')['bending']:.2f} rad: that the larger set came "
            "out worse was a failure of the search",
        ),
    ]


def _of_objectives(context: Context, best: Mapping[str, Optimum]) -> list[Conclusion]:
    chosen = context.problem("L+R01").parameters
    span = chosen.upper - chosen.lower
    apart = np.abs(best["tip-force"].design - best["bending"].design) / span
    most = max(OBJECTIVES, key=lambda name: best[name].bending)
    rows = [
        Conclusion(
            "the optima for f_b and f_exo are similar",
            "Sec. IV, Table IV",
            bool(np.max(apart) < 0.1),
            "they differ by "
            + ", ".join(
                f"{100.0 * part:.0f} % of the range of {label}"
                for part, label in zip(apart.tolist(), chosen.labels, strict=True)
            ),
        ),
        Conclusion(
            "f_exo bends the finger far, too",
            "Sec. IV, Fig. 6",
            best["tip-force"].bending > 0.8 * best["bending"].bending,
            f"f_b {best['bending'].bending:.2f} rad, f_exo {best['tip-force'].bending:.2f} rad",
        ),
    ]
    for name, reading in (
        ("bending-contact", "as the text means it"),
        ("bending-contact-printed", "as printed"),
    ):
        R_0, R_1 = (100.0 * float(value) for value in best[name].design[1:])
        rows.append(
            Conclusion(
                f"f_bc, {reading}, makes the tip narrower than the base",
                "Sec. IV, Table IV",
                R_1 < R_0,
                f"R_0 = {R_0:.2f} cm, R_1 = {R_1:.2f} cm, {best[name].touching} spheres touching "
                f"(f_b: {best['bending'].touching})",
            )
        )
    rows.append(
        Conclusion(
            "of the objectives, f_b bends the finger furthest",
            "Sec. IV",
            best[most].bending <= best["bending"].bending + 1e-3,
            ", ".join(f"{name} {best[name].bending:.2f} rad" for name in OBJECTIVES),
        )
    )
    return rows


def _of_searches(context: Context, best: Mapping[str, Optimum]) -> list[Conclusion]:
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


def _of_mechanics(context: Context, best: Mapping[str, Optimum]) -> list[Conclusion]:
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
            not all(angle > CURLED for angle in furthest.joint_angles.tolist()),
            f"the optimum of {furthest.parameters} bends the joints by "
            + ", ".join(f"{angle:.0f}°" for angle in angles),
        ),
    ]


def _ends(context: Context, found: Optimum) -> tuple[float, float]:
    """Radius at base and tip of a design [cm]."""
    parameters = context.problem(found.parameters).parameters
    radius = parameters.geometry(found.design[None, :], np.array([0.0, 1.0])).radius[0]
    return 100.0 * float(radius[0]), 100.0 * float(radius[1])


def _bending(context: Context, parameters: str, design: np.ndarray) -> float:
    path = context.path(context.problem(parameters), design)
    return float(path.joint_angles[-1].sum())
