"""Paths of equilibria as HTML."""

from __future__ import annotations

import numpy as np

from flexor import plot
from flexor.model import Path
from flexor.notebook.card import card, html, note, picture, table


@html.register
def _(path: Path) -> str:
    model = path.model
    columns = _loads(path) | _joints(path)
    if model.first_spheres:
        columns["tip force / N"] = [f"{force:.4g}" for force in path.tip_force]
    if model.foundations:
        columns["overlap / mm"] = [f"{1e3 * overlap:.3g}" for overlap in path.max_overlap]
    columns["state"] = [
        str(path.stability[step] if path.converged[step] else path.status[step])
        for step in range(len(path))
    ]
    kinds = [[each.kind for each in path.events if each.step == i] for i in range(len(path))]
    columns["events"] = [", ".join(each) for each in kinds]
    drawn = ""
    if path.converged.any():
        drawn = picture(plot.path(path), f"{model.name} at every load, to scale")
    rows = zip(*columns.values(), strict=True)
    warnings = "".join(note(f"Warning: {each}") for each in path.warnings)
    title = f"{len(path)} equilibria up to {model.show_loads(path.loads[-1])}"
    return card(model.name, title, drawn, table(list(columns), rows, 0), warnings)


def _loads(path: Path) -> dict[str, list[str]]:
    model, columns = path.model, {}
    for index, name in enumerate(model.inputs):
        size, unit = model.load_unit(index)
        columns[f"{name} / {unit}".removesuffix(" / ")] = [
            f"{load:.4g}" for load in path.loads[:, index] / size
        ]
    return columns


def _joints(path: Path) -> dict[str, list[str]]:
    model, columns = path.model, {}
    for name, values in zip(model.joints, path.joint_angles.T, strict=True):
        turns = name in model.angular_joints
        shown = np.degrees(values) if turns else 1e3 * values
        columns[f"{model.joint_labels[name]} / {'°' if turns else 'mm'}"] = [
            f"{value:.2f}" for value in shown
        ]
    return columns
