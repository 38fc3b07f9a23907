"""Studies and their designs as HTML."""

from __future__ import annotations

from flexor import plot
from flexor.design.drawn_file import drawn_file
from flexor.errors import InputError
from flexor.notebook.card import card, html, note, picture, table
from flexor.study import Study


@html.register
def _(study: Study) -> str:
    problem = study.problem
    title = f"{problem.model.name}: {problem.parameters.name} for {problem.objective.name}"
    done = study.finished or "not finished"
    subtitle = f"{study.evaluations:,} designs: {done}"
    try:
        best = study.best
    except InputError as error:
        return card(title, subtitle, note(str(error)))
    chosen, model = problem.parameters, problem.model
    first, last = (drawn_file(chosen, each.vector, model) for each in (study.start, best))
    figure = plot.designs(study.start.path, best.path, files=(first, last))
    drawn = picture(figure, "Start and best design, to scale")
    rows = [
        (
            f"{line.label} / {line.unit}".removesuffix(" / ").removesuffix(" / 1"),
            f"{line.start:.4g}",
            f"{line.best:.4g}",
        )
        for line in study.comparison()
    ]
    feasible = "" if not problem.constraints else "Feasible." if best.feasible else "NOT FEASIBLE."
    return card(title, subtitle, drawn, table(("", "start", "best"), rows), note(feasible))
