"""PyElastica: a discrete Cosserat rod, damped in time until it rests."""

from __future__ import annotations

from importlib.metadata import version

import numpy as np
from _contest import Contest
from _section import Missing
from _validation import discrete_rod


def contests(quick: bool) -> list[Contest]:
    """A cantilever in space under its weight and a force."""
    try:
        import elastica
    except ImportError:
        raise Missing("pyelastica") from None
    assert elastica and quick in (True, False)
    elements, one = 20, [0.0, 0.25, 0.5, 0.75, 1.0]
    model = discrete_rod.cantilever("nodal_linear", elements)

    def deviation() -> tuple[float, str]:
        coarse, fine = discrete_rod.relaxed(elements), discrete_rod.relaxed(2 * elements)
        rest = (4.0 * fine[:, -1] - coarse[:, -1]) / 3.0
        tip = model.equilibrium(one).frames(-1)["rod"][-1, :3, 3]
        gap, own = (np.abs(end - rest).max() / discrete_rod.LENGTH for end in (tip, coarse[:, -1]))
        return float(gap), f"with {elements} elements its own is off by {own:.0e}"

    return [
        Contest(
            f"PyElastica {version('pyelastica')}",
            f"rest of a cantilever in space under weight and a force, {elements} elements, "
            f"{model.dof} DOF here",
            "PyElastica simulates 32 s of critically damped motion in 80,000 steps: it is made for "
            "dynamics and has no static solver",
            lambda: discrete_rod.relaxed(elements),
            lambda: [model.equilibrium(one) for _ in range(20)],
            (1, 20),
            deviation,
            1e-4,
            "tip / L, PyElastica's extrapolated from 20 and 40 elements",
        )
    ]
