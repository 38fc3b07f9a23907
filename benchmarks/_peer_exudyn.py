"""Exudyn: a geometrically exact beam pressed onto spheres, by its static solver."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np
from _contest import Contest
from _section import Missing
from _validation import systems
from numpy.typing import NDArray

from flexor.model import Model

Array = NDArray[np.float64]
LENGTH, RADIUS, YOUNG, FORCE = 0.2, 0.008, 1e6, 0.05  # m, m, Pa, N
STIFFNESS = 500.0  # N/m, of each pair
SPHERES = ((0.10, -0.012, 0.006), (0.16, -0.020, 0.006))  # x, z, radius [m]
STATIONS, STEPS = 20, 5  # spheres along the rod, steps of the load
AREA = np.pi * RADIUS**2


def contests(quick: bool) -> list[Contest]:
    """A cantilever pressed onto two spheres."""
    try:
        import exudyn
    except ImportError:
        raise Missing("exudyn") from None
    assert quick in (True, False)
    times = 20
    model, theirs = _ours(), _theirs(exudyn, STATIONS)
    loads = np.linspace(0.0, FORCE, STEPS + 1)

    def deviation() -> tuple[float, str]:
        coarse, fine = theirs(), _theirs(exudyn, 2 * STATIONS)()
        path = model.equilibrium(loads)
        tip = path.frames(-1)["rod"][-1, :3, 3]
        rest = (4.0 * fine - coarse) / 3.0
        gap, own = (np.abs(end - rest).max() / LENGTH for end in (tip[[0, 2]], coarse))
        remark = (
            f"with {STATIONS} elements its own is off by {own:.0e}; {path.pairs[-1]} pairs touch"
        )
        return float(gap), remark

    return [
        Contest(
            f"Exudyn {exudyn.__version__}",
            f"a plane cantilever, {STATIONS} elements, pressed onto two spheres in {STEPS} steps: "
            f"{3 * STATIONS} DOF there, {model.dof} here, {2 * STATIONS} pairs",
            "Exudyn's time is that of `SolveStatic` alone, without building the system; its "
            "elements are of 2nd order; it does not say whether the equilibrium is stable",
            lambda: [theirs() for _ in range(times)],
            lambda: [model.equilibrium(loads) for _ in range(times)],
            (times, times),
            deviation,
            1e-4,
            "tip / L, Exudyn's extrapolated from 20 and 40 elements",
        )
    ]


def _ours() -> Model:
    strain = dict.fromkeys(("bend_y", "extend_x", "shear_z"), "nodal_linear")
    bodies = {
        "rod": systems.rod(
            LENGTH, RADIUS, strain, young_modulus=YOUNG, elements=STATIONS, gauss_points=3
        )
    }
    for i, (x, z, radius) in enumerate(SPHERES):
        at = {"x": systems.si(x, "m"), "z": systems.si(z, "m")}
        bodies[f"stop_{i}"] = systems.link(0.001, radius, placement=at)
    stations = [{"body": "rod", "at": (i + 1) / STATIONS} for i in range(STATIONS)]
    stops = [{"body": f"stop_{i}", "at": "base"} for i in range(len(SPHERES))]
    load = {
        "body": "rod",
        "at": "tip",
        "force": systems.vector((0.0, 0.0, -1.0), "N"),
        "input": True,
    }
    contact = {"first": "rod", "second": "stops", "stiffness": systems.si(STIFFNESS, "N/m")}
    return systems.build(
        "pressed cantilever",
        bodies,
        spheres={"rod": {"points": stations}, "stops": {"points": stops}},
        contacts={"stop": contact},
        wrenches={"load": load},
    )


def _theirs(exudyn: Any, elements: int) -> Any:
    """Build the system; return what solves it and gives the tip's x and z [m]."""
    from exudyn import itemInterface as items

    container = exudyn.SystemContainer()
    system = container.AddSystem()
    h, area = LENGTH / elements, np.pi / 4.0 * RADIUS**4
    nodes = [
        system.AddNode(items.NodeRigidBody2D(referenceCoordinates=[i * h, 0.0, 0.0]))
        for i in range(elements + 1)
    ]
    for first, second in pairwise(nodes):
        beam = items.ObjectBeamGeometricallyExact2D(
            nodeNumbers=[first, second],
            length=h,
            massPerLength=1.0,
            crossSectionInertia=1.0,
            bendingStiffness=YOUNG * area,
            axialStiffness=YOUNG * AREA,
            shearStiffness=YOUNG / 3.0 * AREA,
        )
        system.AddObject(beam)
    ground = system.AddObject(items.ObjectGround())
    origin = system.AddNode(items.NodePointGround())
    still = system.AddMarker(items.MarkerNodeCoordinate(nodeNumber=origin, coordinate=0))
    for coordinate in range(3):
        held = items.MarkerNodeCoordinate(nodeNumber=nodes[0], coordinate=coordinate)
        pair = [still, system.AddMarker(held)]
        system.AddObject(items.ObjectConnectorCoordinate(markerNumbers=pair))
    markers = [system.AddMarker(items.MarkerNodeRigid(nodeNumber=node)) for node in nodes]
    each = elements // STATIONS
    for x, z, radius in SPHERES:
        place = items.MarkerBodyRigid(bodyNumber=ground, localPosition=[x, z, 0.0])
        stop = system.AddMarker(place)
        for marker in markers[each::each]:
            apart = items.NodeGenericData(
                numberOfDataCoordinates=4, initialCoordinates=[1.0, 0.0, 0.0, 0.0]
            )
            contact = items.ObjectContactSphereSphere(
                markerNumbers=[marker, stop],
                nodeNumber=system.AddNode(apart),
                spheresRadii=[RADIUS, radius],
                contactStiffness=STIFFNESS,
            )
            system.AddObject(contact)
    force = items.LoadForceVector(markerNumber=markers[-1], loadVector=[0.0, -FORCE, 0.0])
    system.AddLoad(force)
    system.Assemble()
    settings = exudyn.SimulationSettings()
    settings.staticSolver.numberOfLoadSteps = STEPS
    settings.staticSolver.newton.relativeTolerance = 1e-9
    settings.staticSolver.newton.absoluteTolerance = 1e-12
    settings.staticSolver.discontinuous.iterationTolerance = 1e-10
    settings.staticSolver.verboseMode = 0
    settings.solution.file.write = False
    settings.linearSolver.solverType = exudyn.LinearSolverType.EigenSparse

    def solve() -> Array:
        assert container is not None  # it owns the system
        if not system.SolveStatic(settings):
            raise RuntimeError("Exudyn's static solver did not converge")
        position = exudyn.OutputVariableType.Position
        return np.asarray(system.GetNodeOutput(nodes[-1], position))[:2]

    return solve
