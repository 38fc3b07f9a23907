"""docs/measurements.md, written from all sets of measurements."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from ..page import draw_figure, write_page
from .measurement import Measurement

IMAGES = Path("images", "measurements")


def write(measurements: Sequence[Measurement], folder: Path) -> Path:
    """Write ``measurements.md`` and its figures into a folder; return the page."""
    figures = {}
    for each in measurements:
        figures[each.name] = (IMAGES / f"{each.name}.png").as_posix()
        draw_figure(each.draw, each.panels, 0.5, folder / figures[each.name])
    page = folder / "measurements.md"
    template = Path(__file__).with_name("measurements.md.jinja")
    write_page(template, page, sets=measurements, figures=figures)
    return page
