"""Tests of every conclusion of the paper."""

from __future__ import annotations

from math import degrees, radians

import numpy as np

from reproduction import fig3, fig4, optimisers
from reproduction.optima import (
    as_legendre,
    default_design,
    evaluated,
    optimum,
    pattern_search,
    target,
)
from reproduction.study import (
    ALONE,
    CONSTANTS,
    FINGER,
    LINEAR,
    OBJECTIVES,
    PUBLISHED,
    SETS,
    SURFACE,
    SYMBOLS,
    Array,
    Data,
    Study,
    bending,
    model,
    parameters,
    published_design,
    tip_angle,
)

SHAPES = ("R01", "Rsc", "RLP")
# A finger is curled if both joints beyond the knuckle bend by more than this.
CURLED = radians(30.0)
Row = tuple[str, str, bool, str]  # claim, place, whether it holds, numbers


def compute(study: Study) -> Data:
    """Test every conclusion with `surface`, and those on designs with the other sets."""
    rows = {each: _on_model(study, each) for each in CONSTANTS}
    searches = _on_searches(study)
    table: list[Data] = [
        {
            "claim": claim,
            "place": place,
            "holds": {each: rows[each][i][2] for each in CONSTANTS},
            "numbers": numbers,
        }
        for i, (claim, place, _, numbers) in enumerate(rows[SURFACE])
    ]
    table += [
        {"claim": claim, "place": place, "holds": {SURFACE: holds}, "numbers": numbers}
        for claim, place, holds, numbers in searches
    ]
    return {
        "rows": table,
        "held": {each: sum(row["holds"].get(each, False) for row in table) for each in CONSTANTS},
        "tested": {each: sum(each in row["holds"] for row in table) for each in CONSTANTS},
    }


def _on_model(study: Study, constants: str) -> list[Row]:
    best = {name: optimum(study, name, constants=constants) for name in SETS}
    by_objective = {name: optimum(study, LINEAR, name, constants) for name in OBJECTIVES}
    default = default_design(study, constants)["bending"]
    return [
        *_on_designs(study, constants, best, default),
        *_on_objectives(by_objective),
        *_on_mechanics(study, constants, best),
    ]


def _on_designs(study: Study, constants: str, best: Data, default: float) -> list[Row]:
    ends = {name: _ends(name, np.array(best[name]["design"])) for name in SETS if name != "L"}
    gain = {name: best[name]["bending"] - default for name in SETS}
    lengths = {name: best[name]["shown"][0] for name in ("L+Rsc", "L+RLP")}
    largest = max(SETS, key=lambda name: best[name]["bending"])
    lifted = _published_linear_as_legendre(study, constants)
    return [
        (
            "all optimal designs bend the finger further than the default",
            "Sec. III",
            min(gain.values()) > 0.0,
            f"default {default:.2f} rad; "
            + ", ".join(f"{name} {best[name]['bending']:.2f}" for name in SETS),
        ),
        *(
            (
                f"the optimal surface of {name} has a thin base and a thick tip",
                "Sec. IV, Fig. 5",
                ends[name][1] > 1.01 * ends[name][0],
                "radius at base and tip: "
                + ", ".join(
                    f"{each} {ends[each][0]:.2f} to {ends[each][1]:.2f} cm"
                    for each in (name, f"L+{name}")
                ),
            )
            for name in SHAPES
        ),
        (
            "the shape of the surface matters more for bending than the length",
            "Sec. IV",
            min(gain["R01"], gain["RLP"]) > gain["L"],
            f"gained over the default by L alone {gain['L']:.2f} rad, by "
            + ", ".join(f"{name} alone {gain[name]:.2f}" for name in SHAPES)
            + f", by L and R01 together {gain[LINEAR]:.2f}",
        ),
        (
            "with a general surface the optimal length stays close to the default 10 cm",
            "Sec. IV, Table III",
            all(abs(length - 10.0) < 0.5 for length in lengths.values()),
            ", ".join(f"{name} {length:.1f} cm" for name, length in lengths.items()),
        ),
        (
            "L+R01 bends the finger furthest of all sets",
            "Sec. III, Fig. 5",
            largest == LINEAR,
            ", ".join(f"{name} {best[name]['bending']:.3f} rad" for name in (LINEAR, "L+RLP"))
            + f"; as coefficients of L+RLP the published optimum of L+R01 bends {lifted:.2f} rad",
        ),
    ]


def _on_objectives(best: Data) -> list[Row]:
    chosen = parameters(LINEAR)
    designs = {name: np.array(best[name]["design"]) for name in OBJECTIVES}
    apart = np.abs(designs["tip-force"] - designs["bending"]) / (chosen.upper - chosen.lower)
    angle = {name: best[name]["bending"] for name in OBJECTIVES}
    rows: list[Row] = [
        (
            "the optima for f_b and f_exo are similar",
            "Sec. IV, Table IV",
            bool(np.max(apart) < 0.1),
            "they differ by "
            + ", ".join(
                f"{100.0 * part:.0f} % of the range of {label}"
                for part, label in zip(apart.tolist(), chosen.labels, strict=True)
            ),
        ),
        (
            "f_exo bends the finger far, too",
            "Sec. IV, Fig. 6",
            angle["tip-force"] > 0.8 * angle["bending"],
            f"f_b {angle['bending']:.2f} rad, f_exo {angle['tip-force']:.2f} rad",
        ),
    ]
    for name, reading in (
        ("bending-contact", "as the text means it"),
        ("bending-contact-printed", "as printed"),
    ):
        _, base, tip = best[name]["shown"]
        rows.append(
            (
                f"f_bc, {reading}, makes the tip narrower than the base",
                "Sec. IV, Table IV",
                tip < base,
                f"R_0 = {base:.2f} cm, R_1 = {tip:.2f} cm, spheres touching: "
                f"{best[name]['touching']} (f_b: {best['bending']['touching']})",
            )
        )
    rows.append(
        (
            "of the objectives, f_b bends the finger furthest",
            "Sec. IV",
            max(angle.values()) < 1.01 * angle["bending"],
            ", ".join(f"{SYMBOLS[name]} {angle[name]:.2f} rad" for name in OBJECTIVES),
        )
    )
    return rows


def _on_mechanics(study: Study, constants: str, best: Data) -> list[Row]:
    def compute() -> Data:
        free, held = (model(name, constants).equilibrium(fig3.FORCES) for name in (ALONE, FINGER))
        return {
            "alone": degrees(tip_angle(free)),
            "held": degrees(tip_angle(held)),
            "joints": degrees(bending(held)),
        }

    turned = study.cached(f"tip-angles-{constants}", compute)
    furthest = max(SETS, key=lambda name: best[name]["bending"])
    angles = best[furthest]["joint_angles"]
    return [
        (
            "the mechanics of the interaction are essential to evaluate the actuation",
            "Abstract, Fig. 3",
            turned["joints"] < 0.9 * turned["alone"],
            f"at 10 N the tip of the free exosuit turns by {turned['alone']:.0f}°, on the finger "
            f"by {turned['held']:.0f}°, and the joints bend by {turned['joints']:.0f}°",
        ),
        (
            "such an exosuit bends the joints but cannot curl the finger",
            "Sec. IV",
            not all(angle > CURLED for angle in angles[1:]),
            f"the optimum of {furthest} bends the joints by "
            + ", ".join(f"{degrees(angle):.0f}°" for angle in angles),
        ),
    ]


def _on_searches(study: Study) -> list[Row]:
    fourth, comparison = fig4.compute(study), optimisers.compute(study)
    starts = {method: count for method, (_, _, count) in fig4.METHODS.items()}
    least, polls = (fourth["found"][each] for each in ("levenberg-marquardt", "pattern-search"))
    worst = max(run["values"][-1] for run in fourth["searches"]["levenberg-marquardt"])
    free = {
        name: rate for name, rate in comparison["overall"].items() if name != "levenberg-marquardt"
    }
    order = sorted(free, key=lambda name: -free[name])
    large, best = pattern_search(study, "L+RLP"), optimum(study, "L+RLP")
    low, high = PUBLISHED["fig4"]["range"]
    base, tip = fourth["best"]["shown"]
    return [
        (
            "least squares gets stuck short of the global minimum of R01",
            "Sec. III, Fig. 4",
            least < 0.5 * starts["levenberg-marquardt"],
            f"{least} of {starts['levenberg-marquardt']} starts find it; the worst ends at "
            f"f_b = {worst:.3f} rad, the minimum is {fourth['best']['value']:.3f} rad",
        ),
        (
            "pattern search finds the global minimum of R01",
            "Sec. III, Fig. 4",
            polls == starts["pattern-search"],
            f"{polls} of {starts['pattern-search']} starts find it",
        ),
        (
            "pattern search is the most robust of the methods without gradients",
            "Sec. IV",
            order[0] == "pattern-search",
            "searches that succeed, over all sets: "
            + ", ".join(f"{comparison['title'][name]} {free[name]:.0f} %" for name in order),
        ),
        (
            "pattern search may have failed to find the optimum of the 11 parameters of L+RLP",
            "Sec. IV",
            large["value"] > target(study, best["value"]),
            f"from the default design it ends at {large['bending']:.2f} rad of bending, the "
            f"optimum is {best['bending']:.2f} rad",
        ),
        (
            "the best radii are not at the lower bound of 0.4 cm but inside the range",
            "Sec. III, IV, Fig. 4",
            low + 0.011 < min(base, tip) and max(base, tip) < high - 0.011,
            f"R_0 = {base:.3f} cm, R_1 = {tip:.3f} cm",
        ),
    ]


def _published_linear_as_legendre(study: Study, constants: str) -> float:
    """Return how far the published optimum of L+R01 bends the finger as a design of L+RLP [rad]."""

    def compute() -> Data:
        line = published_design(LINEAR)
        size = parameters("L+RLP").size - 1
        design = np.concatenate((line[:1], as_legendre(line[1:], size)))
        return evaluated("L+RLP", design, constants=constants)

    return float(study.cached(f"published-lifted-{constants}", compute)["bending"])


def _ends(name: str, design: Array) -> tuple[float, float]:
    """Return the radius at base and tip of a design [cm]."""
    radius = parameters(name).geometry(design[None, :], np.array([0.0, 1.0])).radius[0]
    return 100.0 * float(radius[0]), 100.0 * float(radius[1])
