"""Every number the paper publishes, and where it stands there.

"Paper" is "Modelling and Design Optimization of a Soft-exosuit for Wearable Assistive Devices".
Everything is SI but for times, which it gives in minutes.
"""

from __future__ import annotations

from dataclasses import dataclass

CM = 0.01


@dataclass(frozen=True)
class Number:
    """A published number.

    Attributes
    ----------
    value : float
        As printed, in SI.
    unit : str
        Its SI unit.
    what : str
        What it is.
    place : str
        Where it stands in the paper.
    """

    value: float
    unit: str
    what: str
    place: str


@dataclass(frozen=True)
class Optimum:
    """A published optimum.

    Attributes
    ----------
    design : tuple of float
        In the order of the parameter set's labels, SI.
    minutes : float
        Time of its search [min].
    place : str
        Where it stands in the paper.
    """

    design: tuple[float, ...]
    minutes: float
    place: str


@dataclass(frozen=True)
class Body:
    """A line of Table I.

    Attributes
    ----------
    length, radius_base, radius_tip : float
        [m].
    joint_stiffness : float or None
        [N m/rad].
    """

    length: float
    radius_base: float
    radius_tip: float
    joint_stiffness: float | None


# Table I, by the names of the bodies in the shipped model.
TABLE_I = {
    "exosuit": Body(10 * CM, 1.16 * CM, 0.8 * CM, None),
    "ph_1": Body(4.5 * CM, 2.16 * CM, 1.39 * CM, 0.04),
    "ph_2": Body(2.53 * CM, 1.39 * CM, 1.02 * CM, 0.03),
    "ph_3": Body(2.36 * CM, 1.02 * CM, 0.87 * CM, 0.02),
    "tip": Body(0.1 * CM, 0.87 * CM, 0.8 * CM, None),
}

YOUNG_MODULUS = Number(30e3, "Pa", "Young's modulus of the exosuit", "Sec. II-A1")
DEGREES_OF_FREEDOM = Number(25, "", "degrees of freedom", "Sec. II-A2")
EXOSUIT_SPHERES = Number(42, "", "contact spheres of the exosuit", "Sec. II-A3")
FINGER_SPHERES = Number(8, "", "contact spheres of the finger", "Sec. II-A3")

TWO_LINKS = Number(0.27, "rad", "sum of the joint angles, two links, 10 N", "Fig. 3, Sec. III")
THREE_LINKS = Number(1.05, "rad", "sum of the joint angles, three links, 10 N", "Fig. 3, Sec. III")

GLOBAL_MINIMUM = Optimum((0.53 * CM, 0.52 * CM), 0.0, "Fig. 4, Sec. III")
SURVEYED = (0.4 * CM, 1.2 * CM)  # range of both radii in Fig. 4
LEAST_SQUARES_STARTS = 10  # Sec. III
PATTERN_SEARCH_STARTS = 2  # Sec. III

_RLP = (0.4, 0.7, 0.0, 1.0, 0.8, 0.9, 1.0, 1.0, 1.0, 1.0)

TABLE_III = {
    "L": Optimum((7.97 * CM,), 30, "Table III"),
    "R01": Optimum((0.67 * CM, 0.75 * CM), 96, "Table III"),
    "L+R01": Optimum((10.8 * CM, 0.65 * CM, 0.74 * CM), 201, "Table III"),
    "Rsc": Optimum((-2.0, -0.5, 0.0, 0.0), 66, "Table III"),
    "L+Rsc": Optimum((10 * CM, -2.0, -0.5, 0.0, 0.0), 77, "Table III"),
    "RLP": Optimum(_RLP, 236, "Table III"),
    "L+RLP": Optimum((10 * CM, *_RLP), 264, "Table III"),
}
# Of the optimum of L, R01 at 5 N, the largest of all sets; 82° in Sec. IV.
LARGEST_BENDING = Number(1.43, "rad", "sum of the joint angles, optimum of L+R01, 5 N", "Sec. III")
LARGEST_BENDING_DEGREES = Number(82.0, "°", LARGEST_BENDING.what, "Sec. IV")

# By objective, on L+R01.
TABLE_IV = {
    "bending": Optimum((10.8 * CM, 0.65 * CM, 0.74 * CM), 203, "Table IV"),
    "tip-force": Optimum((10.4 * CM, 0.62 * CM, 0.80 * CM), 119, "Table IV"),
    "bending-contact": Optimum((9.6 * CM, 0.88 * CM, 0.57 * CM), 166, "Table IV"),
}


def hours() -> float:
    """Return how long the searches of Tables III and IV took in all [h]."""
    searches = [*TABLE_III.values(), *TABLE_IV.values()]
    return sum(search.minutes for search in searches) / 60.0
