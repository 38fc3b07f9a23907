"""Equilibria of an actuator under rising pressure, and what is reported of each."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path as File

import numpy as np

from .actuators import CAP, SYMMETRY, Model
from .equilibrium import Diverged
from .mesh import Indices, Mesh
from .sections import Array

ENOUGH = 190.0  # degrees
TRIES = 12  # of a step


@dataclass(frozen=True)
class State:
    """An equilibrium; lengths in mm, angles in degrees.

    Attributes
    ----------
    pressure
        In kPa.
    angle
        Of the outer face of the last cap.
    middle_angle
        Between the sections at a quarter and three quarters of the chamber, times 2: what the
        chamber would bend without its ends.
    tip_x, tip_z
        Displacement of the lower edge of the last cap.
    top, bottom
        Length of the chamber's upper and lower sides on the plane of symmetry over that at rest.
    height, width
        Of the section in the middle, over those at rest.
    volume
        Of the chamber [mL].
    force
        On the plane [N].
    fibre_strain
        The largest of windings and layers.
    error
        Residual over the largest of the forces that act.
    """

    pressure: float
    angle: float
    middle_angle: float
    tip_x: float
    tip_z: float
    top: float
    bottom: float
    height: float
    width: float
    volume: float
    force: float
    fibre_strain: float
    error: float


@dataclass(frozen=True)
class Point:
    """What the next equilibrium starts from."""

    pressure: float
    x: Array
    unknowns: list[Array]


class Path:
    """Equilibria at rising pressures [kPa]; `points` are the last two, at most."""

    def __init__(self, model: Model, pressures: Sequence[float]) -> None:
        self.model, self.pressures = model, pressures
        self.states: list[State] = []
        self.points = [Point(0.0, model.mesh.points, model.equilibrium.unknowns())]
        self.end = ""

    def save(self, file: File, settings: str) -> None:
        """Write what `resume` reads."""
        arrays = {
            f"{i}-{j}": values
            for i, point in enumerate(self.points)
            for j, values in enumerate((point.x, *point.unknowns))
        }
        about = {
            "settings": settings,
            "pressures": [point.pressure for point in self.points],
            "states": [asdict(state) for state in self.states],
        }
        new = file.with_suffix(".new.npz")
        np.savez(new, about=np.array(json.dumps(about)), **arrays)
        new.replace(file)

    def resume(self, file: File, settings: str) -> None:
        """Continue an unfinished path of the same settings, if there is one."""
        if not file.exists():
            return
        with np.load(file) as found:
            about = json.loads(str(found["about"]))
            if about["settings"] != settings:
                return
            count = 1 + len(self.points[0].unknowns)
            self.points = [
                Point(pressure, found[f"{i}-0"], [found[f"{i}-{j}"] for j in range(1, count)])
                for i, pressure in enumerate(about["pressures"])
            ]
        self.states = [State(**state) for state in about["states"]]

    def follow(self) -> Iterator[State]:
        """Yield the states that are still to come, and say in `end` why there are no more."""
        for target in self.pressures:
            if target < self.points[-1].pressure + 1e-9:
                continue
            if self.states and abs(self.states[-1].angle) > ENOUGH:
                self.end = f"bent beyond {ENOUGH:.0f}°"
                return
            error = self._reach(target)
            if error is None:
                self.end = f"no convergence beyond {self.points[-1].pressure:.4g} kPa"
                return
            last = self.states[-1] if self.states else None
            self.states.append(observe(self.model, self.points[-1].x, error, last))
            yield self.states[-1]
        self.end = "last listed pressure"

    def _reach(self, target: float) -> float | None:
        """Go to a pressure, in halved steps if need be; return the residual."""
        equilibrium = self.model.equilibrium
        step, tries, error = target - self.points[-1].pressure, 0, None
        while (here := self.points[-1]).pressure < target - 1e-9:
            pressure = min(here.pressure + step, target)
            self.model.cavity.pressure = 1e-3 * pressure
            start = here if tries % 2 else self._extrapolate(pressure)
            equilibrium.restore(start.unknowns)
            try:
                x, error = equilibrium.solve(start.x)
            except Diverged:
                # Once more without extrapolation, then with half the step.
                tries += 1
                if tries > TRIES:
                    return None
                step /= 2.0 if tries % 2 == 0 else 1.0
                continue
            self.points = [here, Point(pressure, x, equilibrium.unknowns())]
        return error

    def _extrapolate(self, pressure: float) -> Point:
        if len(self.points) < 2:
            return self.points[0]
        old, new = self.points
        share = (pressure - new.pressure) / (new.pressure - old.pressure)
        unknowns = [b + share * (b - a) for a, b in zip(old.unknowns, new.unknowns, strict=True)]
        return Point(pressure, new.x + share * (new.x - old.x), unknowns)


def observe(model: Model, x: Array, error: float, before: State | None) -> State:
    """Return the state of equilibrium positions; angles continue from the state before."""
    mesh, rest = model.mesh, model.mesh.points
    planes = [_plane(mesh, share * model.actuator.length) for share in (0.25, 0.5, 0.75)]
    span = (rest[planes[2][0], 0] - rest[planes[0][0], 0]) / model.actuator.length
    middle = rotation(mesh, planes[2], x) - rotation(mesh, planes[0], x)
    bottom, top = _sides(mesh)
    ends = rest[bottom[[0, -1]], 0] + (CAP - SYMMETRY, SYMMETRY - CAP)
    chamber = (rest[bottom, 0] > ends[0]) & (rest[bottom, 0] < ends[1])
    ratios = [_length(x[side[chamber]]) / _length(rest[side[chamber]]) for side in (top, bottom)]
    half = mesh.ring[planes[1][0]]
    height = [np.linalg.norm(points[top[half]] - points[bottom[half]]) for points in (x, rest)]
    width = [points[planes[1], 1].max() for points in (x, rest)]
    tip = x[bottom[-1]] - rest[bottom[-1]]
    return State(
        pressure=1e3 * model.cavity.pressure,
        angle=_near(rotation(mesh, mesh.tip, x), before.angle if before else 0.0),
        middle_angle=_near(middle, before.middle_angle * span if before else 0.0) / span,
        tip_x=float(tip[0]),
        tip_z=float(tip[2]),
        top=ratios[0],
        bottom=ratios[1],
        height=float(height[0] / height[1]),
        width=float(width[0] / width[1]),
        volume=2e-3 * model.cavity.volume(x),
        force=2.0 * model.plane.force(x) if model.plane else 0.0,
        fibre_strain=float(max(abs(fibres.stretch(x) - 1.0).max() for fibres in model.fibres)),
        error=error,
    )


def rotation(mesh: Mesh, nodes: Indices, x: Array) -> float:
    """Return the rotation [°] about y that fits the motion of nodes best."""
    start, end = mesh.points[nodes], x[nodes]
    start, end = start - start.mean(axis=0), end - end.mean(axis=0)
    sine = np.sum(start[:, 2] * end[:, 0] - start[:, 0] * end[:, 2])
    cosine = np.sum(start[:, 0] * end[:, 0] + start[:, 2] * end[:, 2])
    return float(np.degrees(np.arctan2(sine, cosine)))


def _near(angle: float, last: float) -> float:
    return angle + 360.0 * round((last - angle) / 360.0)


def _plane(mesh: Mesh, at: float) -> Indices:
    return np.flatnonzero(mesh.ring == np.argmin(np.abs(mesh.rings - CAP - at)))


def _sides(mesh: Mesh) -> tuple[Indices, Indices]:
    """Return the lowest and the highest node of each plane, on the plane of symmetry."""
    nodes = np.flatnonzero(mesh.points[:, 1] < SYMMETRY)
    order = nodes[np.lexsort((mesh.points[nodes, 2], mesh.ring[nodes]))]
    starts = np.flatnonzero(np.diff(mesh.ring[order], prepend=-1))
    return order[starts], order[np.append(starts[1:], len(order)) - 1]


def _length(points: Array) -> float:
    return float(np.linalg.norm(np.diff(points, axis=0), axis=1).sum())
