"""A limb of an MJCF file in postures of MuJoCo: the same in Flexor, and MuJoCo's own numbers.

`python -m tests.exchange.postures` writes the numbers of `tests/reference/limb.json` again.
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from flexor.exchange import document_of, read_limb
from flexor.exchange.document import Converted
from flexor.exchange.limb import Limb
from flexor.exchange.rotations import from_quaternion, rotation_vector
from flexor.model import Model
from flexor.model.reading import check

Array = NDArray[np.float64]
REFERENCE = Path(__file__).parents[1] / "reference"


@dataclass(frozen=True, eq=False)
class Imported:
    """A limb in Flexor."""

    limb: Limb
    converted: Converted
    model: Model

    @classmethod
    def of(cls, file: Path, *, skip_meshes: bool = False) -> Imported:
        """Import a file."""
        limb = read_limb(file, skip_meshes=skip_meshes)
        converted = document_of(limb)
        return cls(limb, converted, Model(check(converted.tables)))

    @property
    def rows(self) -> dict[str, int]:
        """Which of the model's tendons each tendon of the limb is."""
        made = self.converted.tendons
        return {each.name: self.model.tendons.index(made[each.name]) for each in self.limb.tendons}

    def columns(self, joint: str) -> list[int]:
        """Return which coordinates a joint has."""
        body = self.converted.joints[joint]
        return [each["coordinate"] for each in self.model.engine.joints if each["body"] == body]

    def coordinates(self, posture: dict[str, list[float]]) -> Array:
        """Return the coordinates of a posture: by joint one number, or a quaternion."""
        q = np.zeros(self.model.dof)
        for joint, values in posture.items():
            given = np.array(values)
            turned = len(given) == 4
            q[self.columns(joint)] = rotation_vector(from_quaternion(given)) if turned else given
        return q

    def places(self, q: Array) -> dict[str, Array]:
        """Return the pose of each body's own origin, (3, 4)."""
        frames = self.model.engine.frames(self.model.parameters, q)
        found = {}
        for name, (link, origin) in self.converted.bodies.items():
            frame = frames[self.model.body_frames[link][0]]
            place = frame[:3, 3] + frame[:3, :3] @ origin
            found[name] = np.column_stack([frame[:3, :3], place])
        return found

    def lengths(self, q: Array) -> dict[str, float]:
        """Return the length of each tendon."""
        found = self.model.engine.tendon_lengths(self.model.parameters, q).tolist()
        return {name: found[row] for name, row in self.rows.items()}

    def arms(self, q: Array, joint: str) -> dict[str, Array]:
        """Return the moment arms of each tendon about the coordinates of a joint."""
        found = self.model.engine.tendon_arms(self.model.parameters, q)[:, self.columns(joint)]
        return {name: found[row] for name, row in self.rows.items()}


def mujoco_postures(mujoco: Any, model: Any, count: int, seed: int) -> list[dict[str, Any]]:
    """Return random postures of a model of MuJoCo, with poses of bodies, lengths and moment arms.

    Moment arms are those about hinges and slides.
    """
    random = np.random.default_rng(seed)
    data = mujoco.MjData(model)
    found = []
    for _ in range(count):
        data.qpos[:] = model.qpos0
        posture: dict[str, list[float]] = {}
        simple: dict[str, int] = {}
        for j in range(model.njnt):
            name, start = model.joint(j).name, int(model.jnt_qposadr[j])
            if model.jnt_type[j] == mujoco.mjtJoint.mjJNT_BALL:
                vector = random.uniform(-0.8, 0.8, 3)
                quaternion = np.zeros(4)
                angle = float(np.linalg.norm(vector))
                mujoco.mju_axisAngle2Quat(quaternion, vector / angle, angle)
                data.qpos[start : start + 4] = quaternion
                posture[name] = quaternion.tolist()
                continue
            low, high = model.jnt_range[j] if model.jnt_limited[j] else (-1.0, 1.0)
            value = random.uniform(low, high)
            data.qpos[start] = value
            posture[name] = [float(value - model.qpos0[start])]
            simple[name] = int(model.jnt_dofadr[j])
        mujoco.mj_forward(model, data)
        jacobian = tendon_jacobian(mujoco, model, data)
        found.append(
            {
                "posture": posture,
                "bodies": {
                    model.body(b).name: np.column_stack(
                        [data.xmat[b].reshape(3, 3), data.xpos[b]]
                    ).tolist()
                    for b in range(1, model.nbody)
                },
                "lengths": {
                    model.tendon(t).name: float(data.ten_length[t]) for t in range(model.ntendon)
                },
                "arms": {
                    model.tendon(t).name: {
                        name: float(-jacobian[t, dof]) for name, dof in simple.items()
                    }
                    for t in range(model.ntendon)
                },
            }
        )
    return found


def tendon_jacobian(mujoco: Any, model: Any, data: Any) -> Array:
    """Return the derivative of the lengths of tendons by velocities, (tendons, nv)."""
    flat = np.asarray(data.ten_J)
    if flat.size == model.ntendon * model.nv and flat.ndim == 2:
        return flat
    dense = np.zeros((model.ntendon, model.nv))
    counts = getattr(model, "ten_J_rownnz", None)
    starts = getattr(model, "ten_J_rowadr", None)
    columns = getattr(model, "ten_J_colind", None)
    owner = model if counts is not None else data
    counts, starts, columns = owner.ten_J_rownnz, owner.ten_J_rowadr, owner.ten_J_colind
    columns, flat = np.ravel(columns), np.ravel(flat)
    for t in range(model.ntendon):
        span = slice(int(starts[t]), int(starts[t]) + int(counts[t]))
        dense[t, columns[span]] = flat[span]
    return dense


def main() -> None:
    """Write the reference."""
    import mujoco

    model = mujoco.MjModel.from_xml_path(str(REFERENCE / "limb.xml"))
    postures = mujoco_postures(mujoco, model, 20, seed=1)
    about = {"source": f"MuJoCo {mujoco.__version__}", "postures": postures}
    (REFERENCE / "limb.json").write_text(json.dumps(about) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
