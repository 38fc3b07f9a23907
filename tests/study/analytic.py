"""A model whose paths are a formula: what studies need of a model, without mechanics.

Run as a program it is a study that takes its time and can be killed.
"""

from __future__ import annotations

import sys
import time
from dataclasses import dataclass
from types import SimpleNamespace
from typing import Any, ClassVar

import numpy as np

from flexor.design import DesignSpace, Geometry, GeometryJacobian
from flexor.model import Paths
from flexor.model.derivatives import Derivatives
from flexor.model.units import FORCE


@dataclass(frozen=True)
class Space(DesignSpace):
    points: Any = None


class AnalyticModel:
    """Bends most at L = 11 cm, R_0 = 0.65 cm, R_1 = 0.8 cm; fails where R_1 < 0.45 cm."""

    name = "analytic"
    joints = ("a", "b", "c")
    inputs = ("chamber",)
    input_dimensions: ClassVar = {"chamber": FORCE}
    first_spheres = 42
    frictions = ()
    geometry_indices = np.arange(3)
    engine = SimpleNamespace(outputs={"joints": (0, 3), "tip_force": (3, 4)})

    def __init__(self, pause: float = 0.0, hash: str = "0123") -> None:
        self.hash = hash
        self.pause = pause
        self.calls: list[int] = []
        self.before_batch: Any = lambda model: None
        self.design = Space(points=np.linspace(0.0, 1.0, 5))
        self.evaluation_loads = np.arange(6.0)[:, None]
        self.file = SimpleNamespace(use=None, design=None, to_toml=lambda: 'name = "analytic"\n')

    def geometry_slot_jacobian(self, jacobian: GeometryJacobian) -> np.ndarray:
        radius = jacobian.radius
        return np.stack((jacobian.length, radius[:, 0], radius[:, -1]), axis=1)

    def differentiate(self, paths: Paths, rows: Any, slots: Any, threads: int = 0) -> Derivatives:
        """The gradient is that of the bending, by the length and the radius of base and tip."""
        good = paths.converged[:, -1]
        outputs = np.array([1.0, 0.8, 0.6, 0.3]) * paths.force[-1] / 5.0
        by_slots = np.zeros((len(paths), len(rows), 3))
        for i, row in enumerate(rows):
            for _, weights in row.parts:
                by_slots[:, i] += (weights @ outputs)[:, None] * paths.gradient
        by_slots[~good] = np.nan
        words = np.where(good, "regular", "no-equilibrium").astype(object)
        regularity = np.repeat(words[:, None], len(rows), axis=1)
        return Derivatives(by_slots, np.zeros((len(paths), len(rows), 6, 1)), regularity)

    def show_loads(self, loads: Any) -> str:
        return f"{loads[0]:g} N"

    def evaluate(
        self,
        geometry: Geometry,
        force: Any,
        threads: int = 0,
        **options: float,
    ) -> Paths:
        self.before_batch(self)
        self.calls.append(len(geometry.length))
        time.sleep(self.pause)
        u = np.asarray(force, dtype=float)[:, 0] / 5.0
        base, tip = geometry.radius[:, 0], geometry.radius[:, -1]
        away = (
            ((geometry.length - 0.11) / 0.04) ** 2
            + ((base - 0.0065) / 0.004) ** 2
            + 0.5 * ((tip - 0.008) / 0.004) ** 2
            + 0.05 * np.cos(40.0 * (base / 0.004 - tip / 0.003))
        )
        bend = 0.6 * np.exp(-away)
        angles = bend[:, None, None] * u[None, :, None] * np.array([1.0, 0.8, 0.6])
        good = np.broadcast_to((tip >= 0.0045)[:, None], angles.shape[:2]).copy()
        good[:, u < 0.5] = True
        angles[~good] = np.nan
        wave = 0.05 * 40.0 * np.sin(40.0 * (base / 0.004 - tip / 0.003))
        slopes = (
            -bend * 2.0 * (geometry.length - 0.11) / 0.04**2,
            -bend * (2.0 * (base - 0.0065) / 0.004**2 - wave / 0.004),
            -bend * ((tip - 0.008) / 0.004**2 + wave / 0.003),
        )
        return Paths(
            model=self,  # type: ignore[arg-type]
            gradient=np.stack(slopes, axis=1),
            loads=np.asarray(force, dtype=float),
            joint_angles=angles,
            tip_force=0.3 * bend[:, None] * u,
            touching=np.broadcast_to((20 * base[:, None] / 0.012).astype(np.uint32), good.shape),
            status=np.where(good, "converged", "iteration limit").astype(object),
            converged=good,
            stable=good.copy(),
            event_count=(base < 0.005).astype(np.int64),
            total_iterations=np.full(len(good), 5 * len(u)),
        )

    def equilibrium(self, force: Any, design: Geometry, **options: float) -> Any:
        return self.evaluate(design, force)[0]


if __name__ == "__main__":
    from flexor.study import optimize

    optimize(
        AnalyticModel(pause=0.01),  # type: ignore[arg-type]
        seed=3,
        method_options={"starts": 4, "tolerance": 1e-3},
        folder=sys.argv[1],
        resume="--resume" in sys.argv,
    )
    print("done")
