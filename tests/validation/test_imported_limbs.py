"""Another library: limbs that are imported, against MuJoCo."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from tests.exchange.postures import Imported, mujoco_postures

from .comparison import Comparison, compare
from .report import Case, load

Array = NDArray[np.float64]
FAMILY = "Other libraries"
POSTURES = 1000


def _compare(label: str, imported: Imported, postures: list[dict[str, Any]]) -> list[Comparison]:
    found: dict[str, list[list[float]]] = {"places": [], "lengths": [], "arms": []}
    theirs: dict[str, list[list[float]]] = {"places": [], "lengths": [], "arms": []}
    engine, p = imported.model.engine, imported.model.parameters
    rows = imported.rows
    for each in postures:
        q = imported.coordinates(each["posture"])
        places = imported.places(q)
        shared = [name for name in places if name in each["bodies"]]
        found["places"].append(np.ravel([places[name] for name in shared]).tolist())
        theirs["places"].append(np.ravel([each["bodies"][name] for name in shared]).tolist())
        lengths, arms = engine.tendon_lengths(p, q), engine.tendon_arms(p, q)
        found["lengths"].append([lengths[row] for row in rows.values()])
        theirs["lengths"].append([each["lengths"][name] for name in rows])
        about = {joint: imported.columns(joint)[0] for joint in next(iter(each["arms"].values()))}
        found["arms"].append([arms[r, c] for r in rows.values() for c in about.values()])
        theirs["arms"].append([each["arms"][name][joint] for name in rows for joint in about])
    names = {"places": "poses of bodies", "lengths": "lengths / m", "arms": "moment arms / m"}
    tolerances = {"places": 1e-6, "lengths": 1e-6, "arms": 1e-5}
    return [
        compare(f"{names[key]} ({label})", theirs[key], found[key], tolerances[key], scale=1.0)
        for key in found
    ]


@pytest.mark.slow
def test_imported_limbs(case: Case, tmp_path: Path) -> None:
    """Tendons around wraps of imported limbs.

    The tendon-driven finger and the right hand of `myo-sim` (Apache-2.0), the latter with 39
    muscles over 23 joints, whose tendons wrap around spheres and cylinders from outside and from
    inside, in 1,000 random postures each within the limits of the joints. Poses of bodies, lengths
    of tendons and moment arms from MuJoCo; errors are absolute.
    """
    mujoco: Any = load("mujoco", "mujoco")
    limbs: Any = load("myo-sim", "myo_sim")
    finger = Path(limbs.get_path("legacy/finger/myofinger_v0.xml"))
    hand = tmp_path / "hand.xml"
    spec = limbs.load_spec("myohand_r")
    compiled = spec.compile()
    hand.write_text(spec.to_xml(), encoding="utf-8")
    comparisons = []
    for label, file, model in (
        ("finger", finger, mujoco.MjModel.from_xml_path(str(finger))),
        ("hand", hand, compiled),
    ):
        postures = mujoco_postures(mujoco, model, POSTURES, seed=5)
        comparisons += _compare(label, Imported.of(file), postures)
    case.check(comparisons)
