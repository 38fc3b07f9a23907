"""A page of the documentation from a template beside the code that fills it, with its figures."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

from jinja2 import Environment, FileSystemLoader, StrictUndefined
from matplotlib.figure import Figure

from flexor.plot.style import PAGE, save, style


def draw_figure(draw: Callable[[Figure], None], panels: int, height: float, file: Path) -> None:
    """Save a figure, of one panel or of the page's width and a height as a fraction of it."""
    file.parent.mkdir(parents=True, exist_ok=True)
    with style():
        size = (4.8, 3.2) if panels == 1 else (PAGE, height * PAGE)
        figure = Figure(figsize=size, layout="constrained")
        draw(figure)
    save(figure, file)


def write_page(template: Path, page: Path, **values: Any) -> None:
    """Fill a template, in which every name must have a value."""
    environment = Environment(
        loader=FileSystemLoader(template.parent),
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    page.write_text(environment.get_template(template.name).render(**values), encoding="utf-8")
