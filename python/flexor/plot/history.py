"""The panel that shows a path with a history: what bends against the load, there and back."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from flexor.arrays import Array
from flexor.plot.style import CHAMBER, LINE, shades

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from flexor.model import Path

_MOST_ARROWS = 10
# Inputs whose loads are stated beside that of the legend.
MOST_STATED = 3


@dataclass(frozen=True)
class History:
    """What to draw of a path that returns, or that is not stable throughout."""

    loads: Array  # (s,): load of the input that changes most
    values: Array  # (s,): what is shown over them
    label: str  # what that is, with its unit
    stable: NDArray[np.bool_]  # (s,): whether each point is stable
    snapped: NDArray[np.bool_]  # (s,): whether a snap happened on the way to each point
    load: str = "force / N"  # what the loads are, with their unit


def varied_input(path: Path) -> int:
    """Return which input varies most; 0 without inputs."""
    return int(np.argmax(np.ptp(path.loads, axis=0))) if path.loads.shape[1] else 0


def stated_inputs(path: Path, shown: int) -> str:
    """Return which of several inputs is shown, and the loads of the others."""
    model = path.model
    if len(model.inputs) < 2:
        return ""
    others = []
    if len(model.inputs) > MOST_STATED:
        return f"{model.inputs[shown]}, with {len(model.inputs) - 1} other inputs"
    for index, name in enumerate(model.inputs):
        if index != shown:
            ends = path.loads[[0, -1], index]
            first, last = (model.show_load(load, index=index) for load in ends)
            others.append(f"{name} {first if first == last else f'{first} to {last}'}")
    return f"{model.inputs[shown]} ({', '.join(others)})"


def read_history(path: Path) -> History | None:
    """Return what the panel shows; None where loads only rise and every state is stable."""
    found = path.converged
    if path.loads.shape[1] == 0 or found.sum() < 2:
        return None
    most = varied_input(path)
    size, unit = path.model.load_unit(most)
    load = f"{path.model.load_name(most)} / {unit}".removesuffix(" / ")
    loads = path.loads[:, most] / size
    snaps = [event.step for event in path.events if event.kind == "snap"]
    snapped = np.isin(np.arange(len(path)), snaps)
    if (np.diff(loads) >= 0.0).all() and path.stable[found].all():
        return None
    angular = [path.model.joints.index(name) for name in path.model.angular_joints]
    if angular:
        values = np.degrees(path.joint_angles[:, angular].sum(axis=1))
        label = "sum of joint angles / °" if len(angular) > 1 else "joint angle / °"
    elif path.model.joints:
        values, label = 100.0 * path.joint_angles[:, 0], f"{path.model.joints[0]} / cm"
    else:
        rod = path.model.rods[-1]
        steps = np.flatnonzero(found)
        tips = np.full((len(path), 3), np.nan)
        for step in steps:
            tips[step] = 100.0 * path.frames(int(step))[rod][-1, :3, 3]
        axis = int(np.argmax(np.ptp(tips[found], axis=0)))
        values, label = tips[:, axis], f"{rod} tip {'xyz'[axis]} / cm"
    return History(loads[found], values[found], label, path.stable[found], snapped[found], load)


def draw_history(axes: Axes, history: History) -> None:
    """Draw values over loads: stable parts solid, others dashed, arrows along the path."""
    loads, values, stable = history.loads, history.values, history.stable
    colours = shades(len(loads))
    for start, stop in zip(range(len(loads) - 1), range(1, len(loads)), strict=True):
        held = stable[start] and stable[stop]
        snap = history.snapped[stop]
        axes.plot(
            loads[[start, stop]],
            values[[start, stop]],
            color=CHAMBER if snap else tuple(colours[stop]),
            linestyle=":" if snap else "-" if held else (0, (3, 2)),
            linewidth=1.2,
            solid_capstyle="round",
        )
    every = max(1, -(-(len(loads) - 1) // _MOST_ARROWS))
    for start in range(0, len(loads) - 1, every):
        first, last = ((loads[i], values[i]) for i in (start, start + 1))
        if first != last:
            middle = tuple(0.5 * (a + b) for a, b in zip(first, last, strict=True))
            axes.annotate(
                "", middle, first, arrowprops={"arrowstyle": "-|>", "color": LINE, "linewidth": 0.5}
            )
    if not stable.all():
        axes.plot([], [], color=LINE, linewidth=1.2, linestyle=(0, (3, 2)), label="not stable")
    if history.snapped.any():
        axes.plot([], [], color=CHAMBER, linewidth=1.2, linestyle=":", label="snap")
    if history.snapped.any() or not stable.all():
        axes.legend(loc="best")
    axes.set_xlabel(history.load)
    axes.set_ylabel(history.label)
    axes.grid(visible=True, linewidth=0.3, alpha=0.5)
