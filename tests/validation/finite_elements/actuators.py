"""The actuators that are solved: their geometry, reinforcement, pressures and obstacle."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from . import sections
from .equilibrium import Equilibrium, Term
from .mesh import Indices, Mesh, graded, sweep
from .sections import Fineness, Section
from .solid import Solid
from .surfaces import Bars, Cavity, Fibres, Plane

SHEAR = 0.314  # MPa, of the silicone
BULK = 600.0  # MPa
FIBRES = 2000.0  # N/mm, stiffness per width of windings and, if not given, of layers
BARS = 2000.0  # N, of the bars of a frame
CONTACT = 200.0  # N/mm, of a node on a plane
CAP = 4.0  # mm, of the same silicone
SYMMETRY = 1e-6  # mm from the plane of symmetry

MESHES = {"coarse": Fineness(1, 3, 2, 8.0), "fine": Fineness(2, 3, 3, 6.0)}


@dataclass(frozen=True)
class Actuator:
    """An actuator, clamped at the outer face of its first cap.

    Parameters
    ----------
    about
        A line for the report.
    kind, sizes
        A function of `sections`, and its arguments [mm] at the start of the chamber.
    length
        Of the chamber [mm].
    outside
        Fibres wound around it, frames that keep the outline of each section, or nothing.
    flat
        Whether the underside is kept flat across.
    layer
        Half the width [mm] of the strain-limiting layer on the underside; on a tube, half its angle
        [°] about the axis; negative for none.
    layer_stiffness
        Of the strain-limiting layer per width [N/mm].
    taper
        Size of the last section over that of the first.
    pressures
        In kPa.
    plane
        Distance [mm] below the underside of a plane that the lower edge of the last cap may touch.
    """

    about: str
    kind: Literal["half_round", "box", "tube"]
    sizes: tuple[float, ...]
    length: float
    pressures: tuple[float, ...]
    outside: Literal["wound", "frames", "bare"] = "wound"
    flat: bool = True
    layer: float = np.inf
    layer_stiffness: float = FIBRES
    taper: float = 1.0
    plane: float | None = None

    def section(self, fineness: Fineness) -> Section:
        """Return the section at the start of the chamber."""
        make: Callable[..., Section] = getattr(sections, self.kind)
        return make(*self.sizes, fineness)


@dataclass(frozen=True)
class Model:
    """The mesh of an actuator, its energy terms and its equations."""

    actuator: Actuator
    mesh: Mesh
    solid: Solid
    cavity: Cavity
    fibres: tuple[Fibres, ...]
    plane: Plane | None
    equilibrium: Equilibrium


def build(actuator: Actuator, fineness: Fineness) -> Model:
    """Return the finite-element model of an actuator."""
    size = fineness.slice
    mesh = sweep(
        actuator.section(fineness),
        graded(actuator.length, size, (0.3 * size, 0.5 * size, 0.75 * size)),
        CAP,
        lambda x: 1.0 + (actuator.taper - 1.0) * x / actuator.length,
    )
    solid, cavity = Solid(mesh, SHEAR, BULK), Cavity(mesh.cavity)
    below = _below(mesh, actuator)
    covered = below[mesh.outside].all(axis=(1, 2))
    fibres = []
    if covered.any():
        layer = mesh.outside[covered]
        fibres.append(Fibres(mesh.points, layer, "along", actuator.layer_stiffness))
    if actuator.outside == "wound":
        # A flat underside has no need of fibres.
        faces = mesh.outside[~covered] if actuator.flat else mesh.outside
        fibres.append(Fibres(mesh.points, faces, "around", FIBRES))
    terms: list[Term] = [solid, cavity, *fibres]
    if actuator.outside == "frames":
        terms.append(Bars(mesh.points, _frames(mesh), BARS))
    plane = None
    if actuator.plane is not None:
        # Elsewhere the actuator arches away from the plane.
        nodes = mesh.tip[below[mesh.tip]]
        plane = Plane(nodes, mesh.points[:, 2].min() - actuator.plane, CONTACT)
        terms.append(plane)
    equations = _equations(mesh, below if actuator.flat else np.zeros_like(below))
    model = Equilibrium(terms, equations)
    return Model(actuator, mesh, solid, cavity, tuple(fibres), plane, model)


def _below(mesh: Mesh, actuator: Actuator) -> NDArray[np.bool_]:
    """Say which nodes the strain-limiting layer covers."""
    y, z = mesh.points[:, 1], mesh.points[:, 2]
    if actuator.kind == "tube":
        surface = np.isin(np.arange(len(y)), mesh.outside)
        return surface & (np.degrees(np.arctan2(y, -z)) < actuator.layer + 1e-6)
    return (z < SYMMETRY) & (y < actuator.layer + SYMMETRY)


def _equations(mesh: Mesh, flat: NDArray[np.bool_]) -> Indices:
    """Number the unknowns, plane by plane: the root is clamped, y = 0 is a plane of symmetry.

    The nodes `flat` of one plane move together along x and z and do not move along y.
    """
    free = np.ones(mesh.points.shape, dtype=bool)
    free[mesh.root] = False
    free[np.abs(mesh.points[:, 1]) < SYMMETRY, 1] = False
    free[flat, 1] = False
    tied = np.flatnonzero(flat)
    _, first, index = np.unique(mesh.ring[tied], return_index=True, return_inverse=True)
    master = np.arange(len(mesh.points))
    master[tied] = tied[first][index]
    own = np.flatnonzero(master == np.arange(len(master)))
    own = own[np.argsort(mesh.ring[own], kind="stable")]
    numbers = np.full(mesh.points.shape, -1, dtype=np.int64)
    numbers[own] = np.where(free[own], np.cumsum(free[own]).reshape(-1, 3) - 1, -1)
    return np.where(free, numbers[master], -1)


def _frames(mesh: Mesh) -> Indices:
    """Join the nodes of each outline to its lowest and highest nodes on the plane of symmetry."""
    bars = []
    outline = np.unique(mesh.outside)
    for ring in range(1, len(mesh.rings)):
        nodes = outline[mesh.ring[outline] == ring]
        y, z = mesh.points[nodes, 1], mesh.points[nodes, 2]
        middle = nodes[y < SYMMETRY]
        ends = middle[[np.argmin(mesh.points[middle, 2]), np.argmax(mesh.points[middle, 2])]]
        # The underside is held by the equations.
        others = nodes[(y > SYMMETRY) & (z > SYMMETRY)]
        bars += [ends, *(np.array((end, node)) for end in ends for node in others)]
    return np.array(bars)


ROUND, BOX, TUBE = (8.0, 2.0, 2.0), (12.0, 8.0, 2.0, 2.0), (8.0, 2.0)
RISING = (5.0, *np.arange(10.0, 161.0, 10.0).tolist())
BARE = (0.5, 1.0, 2.0, 4.0, 6.0, 8.0, 10.0, 12.0, 14.0, 16.0, 18.0, 20.0)
LISTED = (20.0, 40.0, 60.0, 80.0)
FEWER = tuple(np.arange(20.0, 161.0, 20.0).tolist())

HALF_ROUND = Actuator(
    "Half-round chamber, wound outside, floor held flat", "half_round", ROUND, 160.0, RISING
)
FRAMED = Actuator(
    "Box in frames that keep all sides flat", "box", BOX, 120.0, RISING, outside="frames"
)
TAPERED = Actuator(
    "Tube, tapered to 60 %, wound outside, with a strain-limiting strip",
    *("tube", TUBE, 160.0, RISING),
    flat=False,
    # Stiffer, a strip on an arc bends as a shell, and its middle buckles under compression.
    layer=15.0,
    layer_stiffness=200.0,
    taper=0.6,
)
BLOCKED = "The same, its tip blocked by a plane"

ACTUATORS = {
    "half-round": HALF_ROUND,
    "half-round-blocked": replace(HALF_ROUND, about=BLOCKED, pressures=LISTED, plane=20.0),
    "box-framed": FRAMED,
    "box-framed-wide": replace(
        FRAMED, about="Wide box in frames", sizes=(24.0, 8.0, 2.0, 2.0), pressures=FEWER
    ),
    "box-framed-high": replace(
        FRAMED, about="High box in frames", sizes=(8.0, 12.0, 1.5, 2.5), pressures=FEWER
    ),
    "box-framed-thick": replace(
        FRAMED,
        about="Box with thick walls, in frames",
        sizes=(10.0, 6.0, 3.0, 3.0),
        pressures=FEWER,
    ),
    "box-framed-blocked": replace(FRAMED, about=BLOCKED, pressures=LISTED, plane=10.0),
    "tube-tapered": TAPERED,
    "tube-tapered-blocked": replace(TAPERED, about=BLOCKED, pressures=LISTED, plane=10.0),
    "tube-stretched": replace(
        TAPERED,
        about="Tube, tapered to 60 %, wound outside, without a strip",
        pressures=(20.0, 40.0, 60.0, 80.0, 100.0),
        layer=-1.0,
        layer_stiffness=FIBRES,
    ),
    "half-round-free-floor": replace(
        HALF_ROUND,
        about="Half-round chamber, wound all around, floor free to bulge, layer in its middle",
        flat=False,
        layer=4.4,
    ),
    "half-round-free-layer": replace(
        HALF_ROUND,
        about="Half-round chamber, wound all around, floor free to bulge, layer on all of it",
        pressures=(5.0, 10.0, 20.0, 30.0, 40.0),
        flat=False,
    ),
    "box-wound": replace(
        FRAMED,
        about="Box wound with fibres, free to become round, floor flat",
        outside="wound",
    ),
    "half-round-bare": replace(
        HALF_ROUND,
        about="Half-round chamber, not wound, floor held flat",
        pressures=BARE,
        outside="bare",
    ),
    "box-bare": replace(
        FRAMED,
        about="Box, not wound, floor free to bulge, layer in its middle",
        pressures=BARE,
        outside="bare",
        flat=False,
        layer=4.0,
    ),
}
