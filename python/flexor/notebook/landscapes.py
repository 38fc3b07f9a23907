"""Landscapes as HTML."""

from __future__ import annotations

from flexor import plot
from flexor.errors import InputError
from flexor.notebook.card import card, html, note, picture
from flexor.study.landscape import Landscape


@html.register
def _(landscape: Landscape) -> str:
    problem, axes = landscape.problem, " and ".join(landscape.labels)
    title = f"{problem.model.name}: {problem.objective.name} over {axes}"
    failed = int(landscape.failed.sum())
    subtitle = f"{landscape.value.size:,} designs, {failed:,} of them failed"
    try:
        best = landscape.minimum
    except InputError as error:
        return card(title, subtitle, note(str(error)))
    drawn = picture(plot.landscape(landscape), f"{problem.objective.name} over {axes}")
    return card(title, subtitle, drawn, note(f"Best: {best.text}; {best.result}"))
