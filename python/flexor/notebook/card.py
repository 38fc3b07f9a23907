"""A card: a title, a picture and tables, as HTML."""

from __future__ import annotations

import base64
import io
from collections.abc import Iterable, Sequence
from functools import singledispatch
from html import escape
from typing import TYPE_CHECKING

from flexor.plot.style import style

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_CELL = "padding:0.15em 0.8em;text-align:{align};border:0;background:none"
_MOST_ROWS = 24


@singledispatch
def html(shown: object) -> str:
    """Return an object of Flexor as HTML.

    Parameters
    ----------
    shown
        A `flexor.Model`, `Path`, `Study`, `Landscape` or `flexor.materials.Material`.

    Raises
    ------
    TypeError
        If it is something else.
    """
    raise TypeError(f"{type(shown).__name__} has no representation as HTML")


def card(title: str, subtitle: str, *parts: str) -> str:
    """Return a card; title and subtitle are texts, parts are HTML."""
    below = f'<div style="opacity:0.75">{escape(subtitle)}</div>' if subtitle else ""
    return (
        '<div class="flexor" style="max-width:56em">'
        f"<div><strong>{escape(title)}</strong></div>{below}{''.join(parts)}</div>"
    )


def table(headings: Sequence[str], rows: Iterable[Sequence[str]], left: int = 1) -> str:
    """Return a table of texts, the first columns aligned left; a long one without its middle."""
    every = [list(map(escape, row)) for row in rows]
    if len(every) > _MOST_ROWS:
        half = _MOST_ROWS // 2
        every = [*every[:half], ["⋮"] * len(headings), *every[-half:]]

    def line(kind: str, cells: Sequence[str]) -> str:
        shown = (
            f'<{kind} style="{_CELL.format(align="left" if i < left else "right")}">{cell}</{kind}>'
            for i, cell in enumerate(cells)
        )
        return f'<tr style="background:none">{"".join(shown)}</tr>'

    head = line("th", list(map(escape, headings)))
    body = "".join(line("td", row) for row in every)
    return (
        '<div style="overflow-x:auto"><table style="border-collapse:collapse;margin:0.5em 0">'
        f'<thead style="border-bottom:1px solid">{head}</thead><tbody>{body}</tbody></table></div>'
    )


def note(text: str) -> str:
    """Return a line of text."""
    return f"<div>{escape(text)}</div>"


def picture(figure: Figure, description: str) -> str:
    """Return a figure as an image on white; the description is for those who cannot see it."""
    drawn = io.BytesIO()
    with style():
        figure.savefig(drawn, format="svg", metadata={"Date": None})
    encoded = base64.b64encode(drawn.getvalue()).decode("ascii")
    return (
        f'<img alt="{escape(description)}" src="data:image/svg+xml;base64,{encoded}" '
        'style="max-width:100%;background:#ffffff;border-radius:4px;margin:0.5em 0"/>'
    )
