"""Fig. 3: the exosuit alone, on two links and on three, from 0 to 10 N."""

from __future__ import annotations

from math import degrees
from typing import TYPE_CHECKING

import numpy as np

from flexor.paper import published
from flexor.paper.context import ALONE, FINGER, TWO_LINKS, Context
from flexor.paper.folder import Data
from flexor.paper.scenes_figure import Layer, Panel, chamber_handle, draw_panels
from flexor.paper.section import Column, Compared, Picture, Section, Table
from flexor.plot.reading import read_scene
from flexor.plot.style import LINE, shades

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from flexor.model import Path

FORCES = np.arange(0.0, 10.1, 2.0)  # N
ROWS = {ALONE: "exosuit alone", TWO_LINKS: "two links", FINGER: "three links"}


def fig3(context: Context) -> Section:
    """Follow the three models and compare the sums of angles.

    Parameters
    ----------
    context : Context
        Models, settings and folder.

    Returns
    -------
    Section
        Fig. 3.
    """

    def compute() -> Data:
        context.say("three models, 0 to 10 N")
        paths = {name: context.model(name).equilibrium(FORCES) for name in ROWS}
        return {
            "tip_angle": [tip_angle(paths[ALONE], step) for step in range(len(FORCES))],
            **{
                name: {
                    "joint_angles": paths[name].joint_angles.tolist(),
                    "contacts": paths[name].touching.tolist(),
                    "events": [
                        sum(e.step == step for e in paths[name].events)
                        for step in range(len(FORCES))
                    ],
                }
                for name in (TWO_LINKS, FINGER)
            },
        }

    data = context.part("fig3", compute).data
    sums = {name: np.array(data[name]["joint_angles"]).sum(axis=1) for name in (TWO_LINKS, FINGER)}
    alone = float(data["tip_angle"][-1])
    two, three = float(sums[TWO_LINKS][-1]), float(sums[FINGER][-1])
    compared = tuple(
        Compared(each.what, each.place, each.value, ours, each.unit)
        for each, ours in ((published.TWO_LINKS, two), (published.THREE_LINKS, three))
    )
    text = (
        f"At 10 N the free exosuit turns its tip by {degrees(alone):.0f}°. On the finger with "
        f"three joints the joints bend by {three:.2f} rad in all (published "
        f"{published.THREE_LINKS.value}), on the finger with two by {two:.2f} rad (published "
        f"{published.TWO_LINKS.value}): "
        "the finger decides most of what the exosuit does, which is why it has to be in the model.",
    )
    return Section(
        name="fig3",
        title="Fig. 3: the exosuit alone, on two links and on three",
        text=text,
        compared=compared,
        tables=(_table(data),),
        pictures=(
            Picture(
                "fig3",
                "Exosuit and finger from 0 to 10 N in steps of 2 N, to scale: alone, on the finger "
                "with the first two phalanges merged, and on the finger with three joints.",
                _figure(context, alone, sums),
            ),
        ),
    )


def tip_angle(path: Path, step: int) -> float:
    """Return the angle by which the exosuit's tip has turned, whole turns counted [rad].

    Parameters
    ----------
    path : Path
        Of a model with a rod named exosuit.
    step : int
        A step of the path.
    """
    frames = path.frames(step)["exosuit"]
    headings = np.unwrap(-np.arctan2(frames[:, 2, 0], frames[:, 0, 0]))
    return float(headings[-1] - headings[0])


def _table(data: Data) -> Table:
    rows = []
    for step, force in enumerate(FORCES):
        two, three = (data[name]["joint_angles"][step] for name in (TWO_LINKS, FINGER))
        rows.append(
            (
                float(force),
                degrees(data["tip_angle"][step]),
                *(degrees(angle) for angle in two),
                sum(two),
                *(degrees(angle) for angle in three),
                sum(three),
                int(data[FINGER]["contacts"][step]),
                int(data[TWO_LINKS]["events"][step] + data[FINGER]["events"][step]),
            )
        )
    return Table(
        name="fig3",
        caption="Angles along the three paths. Flexion is positive.",
        columns=(
            Column("force", "N"),
            Column("tip, alone", "°"),
            *(Column(f"two links: joint {joint}", "°") for joint in (1, 2)),
            Column("two links: sum", "rad"),
            *(Column(f"three links: joint {joint}", "°") for joint in (1, 2, 3)),
            Column("three links: sum", "rad"),
            Column("spheres in contact"),
            Column("snaps"),
        ),
        rows=tuple(rows),
    )


def _figure(context: Context, alone: float, sums: dict[str, np.ndarray]) -> Figure:
    from matplotlib.patches import Patch

    colours = [tuple(shade) for shade in shades(len(FORCES))]
    titles = {
        ALONE: f"exosuit alone: tip turns {degrees(alone):.0f}°",
        **{name: f"{ROWS[name]}: {float(sums[name][-1]):.2f} rad" for name in sums},
    }
    panels = []
    for name in ROWS:
        path = context.model(name).equilibrium(FORCES)
        layers = [
            Layer(read_scene(path, step), colour, 0.9 if step == len(path) - 1 else 0.55)
            for step, colour in zip(range(len(path)), colours, strict=True)
        ]
        panels.append(Panel(titles[name], layers))
    handles = [
        Patch(facecolor=colour, edgecolor=LINE, linewidth=0.5, label=f"{force:g} N")
        for force, colour in zip(FORCES, colours, strict=True)
    ]
    return draw_panels(panels, 3, [*handles, chamber_handle(panels[0].layers[0].scene)])
