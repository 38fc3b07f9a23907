"""What the paper concludes on optimal designs and on objectives."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from flexor.paper import published
from flexor.paper.conclusion import Conclusion
from flexor.paper.context import Context
from flexor.paper.default import default_design
from flexor.paper.optimum import Optimum, as_legendre
from flexor.paper.settings import OBJECTIVES, SETS
from flexor.paper.table3 import published_design
from flexor.paper.table4 import SYMBOLS


def on_designs(context: Context, best: Mapping[str, Optimum]) -> list[Conclusion]:
    """Test what is said of the optimal designs.

    Parameters
    ----------
    context : Context
        Models, settings and folder.
    best : dict of Optimum
        By parameter set.
    """
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
        *(
            Conclusion(
                f"the optimal surface of {name} has a thin base and a thick tip",
                "Sec. IV, Fig. 5",
                thick[name],
                "radius at base and tip: "
                + ", ".join(
                    f"{each} {ends[each][0]:.2f} to {ends[each][1]:.2f} cm"
                    for each in (name, f"L+{name}")
                ),
            )
            for name in shapes
        ),
        Conclusion(
            "the shape of the surface matters more for bending than the length",
            "Sec. IV",
            min(gain["R01"], gain["RLP"]) > gain["L"],
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


def on_objectives(context: Context, best: Mapping[str, Optimum]) -> list[Conclusion]:
    """Test what is said of the objectives.

    Parameters
    ----------
    context : Context
        Models, settings and folder.
    best : dict of Optimum
        On L+R01, by objective.
    """
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
                f"R_0 = {R_0:.2f} cm, R_1 = {R_1:.2f} cm, spheres touching: "
                f"{best[name].touching} (f_b: {best['bending'].touching})",
            )
        )
    rows.append(
        Conclusion(
            "of the objectives, f_b bends the finger furthest",
            "Sec. IV",
            best[most].bending < 1.01 * best["bending"].bending,
            ", ".join(f"{SYMBOLS[name]} {best[name].bending:.2f} rad" for name in OBJECTIVES),
        )
    )
    return rows


def _ends(context: Context, found: Optimum) -> tuple[float, float]:
    """Radius at base and tip of a design [cm]."""
    parameters = context.problem(found.parameters).parameters
    radius = parameters.geometry(found.design[None, :], np.array([0.0, 1.0])).radius[0]
    return 100.0 * float(radius[0]), 100.0 * float(radius[1])


def _bending(context: Context, parameters: str, design: np.ndarray) -> float:
    path = context.path(context.problem(parameters), design)
    return float(path.joint_angles[-1].sum())
