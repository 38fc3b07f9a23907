"""docs/measurements.md, written from all sets of measurements."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from jinja2 import Environment, FileSystemLoader, StrictUndefined
from matplotlib.figure import Figure

from flexor.plot.style import PAGE, save, style

from .measurement import Measurement

IMAGES = Path("images", "measurements")


def write(measurements: Sequence[Measurement], folder: Path) -> Path:
    """Write ``measurements.md`` and its figures into a folder; return the page."""
    (folder / IMAGES).mkdir(parents=True, exist_ok=True)
    figures = {}
    for each in measurements:
        figures[each.name] = (IMAGES / f"{each.name}.png").as_posix()
        with style():
            size = (4.8, 3.2) if each.panels == 1 else (PAGE, 0.5 * PAGE)
            figure = Figure(figsize=size, layout="constrained")
            each.draw(figure)
        save(figure, folder / figures[each.name])
    environment = Environment(
        loader=FileSystemLoader(Path(__file__).parent),
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    page = folder / "measurements.md"
    template = environment.get_template("measurements.md.jinja")
    page.write_text(template.render(sets=measurements, figures=figures), encoding="utf-8")
    return page
