"""Scenes made by hand: a rod of constant curvature over a finger of given joint angles."""

from __future__ import annotations

import numpy as np

from flexor.plot.scene import ContactArrow, Line, Link, Rod, Scene


def rod_frames(length: float, curvature: float, base: tuple[float, float], points: int = 41):
    """Return frames (points, 4, 4) of a circular arc that flexes towards -z."""
    s = np.linspace(0.0, length, points)
    angle = curvature * s
    with np.errstate(invalid="ignore", divide="ignore"):
        x = np.where(curvature == 0.0, s, np.sin(angle) / curvature) if curvature else s
        z = (np.cos(angle) - 1.0) / curvature if curvature else 0.0 * s
    frames = np.tile(np.eye(4), (points, 1, 1))
    frames[:, 0, 0] = frames[:, 2, 2] = np.cos(angle)
    frames[:, 0, 2], frames[:, 2, 0] = np.sin(angle), -np.sin(angle)
    frames[:, 0, 3], frames[:, 2, 3] = base[0] + x, base[1] + z
    return frames


def finger(angles: tuple[float, float, float]) -> list[Link]:
    """Return the links of the paper's Table I with the joints flexed by `angles` [rad]."""
    sizes = [(0.045, 0.0216, 0.0139), (0.0253, 0.0139, 0.0102), (0.0236, 0.0102, 0.0087)]
    here, heading, links = np.zeros(3), 0.0, []
    for i, ((length, r_base, r_tip), angle) in enumerate(zip(sizes, angles, strict=True)):
        heading += angle
        tip = here + length * np.array([np.cos(heading), 0.0, -np.sin(heading)])
        links.append(Link(f"ph_{i + 1}", here, tip, r_base, r_tip))
        here = tip
    return links


def scene(flexion: float, arrow: float = 0.0) -> Scene:
    """Return a finger flexed by `flexion` in all with an exosuit over it."""
    frames = rod_frames(0.1, flexion / 0.1, (0.0, 0.0332))
    height = np.linspace(0.0116, 0.008, len(frames))
    chamber = frames[:, :3, 3] + height[:, None] * frames[:, :3, 2]
    links = finger((0.4 * flexion, 0.35 * flexion, 0.25 * flexion))
    contact_arrows = []
    if arrow:
        top = links[2].tip + np.array([0.0, 0.0, 0.0087])
        contact_arrows = [
            ContactArrow(top, np.array([0.0, 0.0, -arrow])),
            ContactArrow(top * 0.6, np.array([0.2, 0.0, -arrow / 2])),
        ]
    return Scene(
        rods=[Rod("exosuit", frames, height, height)],
        links=links,
        lines=[Line("chamber", chamber, "chamber")],
        contact_arrows=contact_arrows,
    )
