"""Fig. 4: the landscape of f_b over base and tip radius, and two methods on it."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from flexor.model import load
from flexor.paper import published
from flexor.paper.context import FINGER, Context
from flexor.paper.default import target
from flexor.paper.fig4_searches import (
    LETTERS,
    NAMES,
    STARTS,
    searches_on_landscape,
    searches_table,
)
from flexor.paper.folder import Data
from flexor.paper.optimum import evaluated, true_optimum
from flexor.paper.section import Cell, Column, Compared, Picture, Section, Table, number
from flexor.study import Settings, StudyProgress
from flexor.study.landscape import Landscape, SearchPath, landscape

# How contact is modelled: the name of the landscape, and what to change in the model file. The
# paper's is spheres, which slide over each other in bumps; round cones are smooth.
PAPERS = "spheres"
CONTACTS: dict[str, Mapping[str, object]] = {
    PAPERS: {},
    "round-cones": {"contacts.skin.shape": "round-cones"},
}


def fig4(context: Context) -> Section:
    """Survey the landscape and send both methods over it.

    Parameters
    ----------
    context : Context
        Models, settings and folder.

    Returns
    -------
    Section
        Fig. 4.
    """
    surveys = {name: _landscape(context, name) for name in CONTACTS}
    searches = searches_on_landscape(context).data
    spheres = surveys[PAPERS]
    best = true_optimum(context, "R01")
    paths = [
        SearchPath(
            label=f"${LETTERS[method]}_{{{i + 1}}}$",
            method=method,
            designs=np.array(run["designs"]),
            values=np.array(run["values"]),
            evaluations=np.array(run["evaluations"], dtype=np.float64),
        )
        for method in STARTS
        for i, run in enumerate(searches[method])
    ]
    from flexor import plot

    pictures = [
        Picture(
            "fig4" if name == PAPERS else f"fig4-{name}",
            f"Objective f_b over base and tip radius ({survey.value.shape[0]} × "
            f"{survey.value.shape[1]} designs, contact by {said(name)}), in perspective and from "
            "above"
            + (", with the paths of the searches from start to end" if name == PAPERS else "")
            + ". Dots: the finger snaps on the way to 5 N.",
            plot.landscape(survey, paths if name == PAPERS else ()),
        )
        for name, survey in surveys.items()
    ]
    R_0, R_1 = (100.0 * value for value in best.design)
    published_minimum = published.GLOBAL_MINIMUM
    compared = tuple(
        Compared(f"global minimum, {label}", published_minimum.place, 100.0 * theirs, ours, "cm")
        for label, theirs, ours in zip(
            ("R_0", "R_1"), published_minimum.design, (R_0, R_1), strict=True
        )
    )
    return Section(
        name="fig4",
        title="Fig. 4: the landscape of f_b over base and tip radius",
        text=(
            *_text(context, spheres, searches, best.value, (R_0, R_1)),
            *(_beside(name, surveys[name], spheres) for name in surveys if name != PAPERS),
        ),
        compared=compared,
        tables=(searches_table(searches, target(context, best.value)), *_numbers(surveys)),
        pictures=tuple(pictures),
    )


def _landscape(context: Context, contact: str) -> Landscape:
    settings = context.settings
    place, begun = context.folder.study(f"landscape-{contact}")
    model = load(FINGER, constants=settings.constants, changes=CONTACTS[contact])

    def tell(at: StudyProgress) -> None:
        context.say(f"landscape, {at.evaluations:,} designs", at.evaluations / settings.grid**2)

    def compute() -> Data:
        landscape(model, "R01", "bending", grid=settings.grid, folder=place, resume=begun,
                  progress=tell, executor=context.executor)  # fmt: skip
        return {"settings": Settings.read(place).values["method"]}

    context.part(f"fig4-landscape-{contact}", compute)
    return Landscape.open(place)


def _text(
    context: Context, survey: Landscape, searches: Data, best: float, at: tuple[float, float]
) -> tuple[str, ...]:
    reached = target(context, best)
    found = {
        method: sum(run["values"][-1] <= reached for run in runs)
        for method, runs in searches.items()
    }
    low, high = (100.0 * bound for bound in published.SURVEYED)
    grid_best = survey.minimum
    inside = all(low + 0.011 < value < high - 0.011 for value in at)
    edge = "inside" if inside else "at the edge of"
    theirs = " and ".join(f"{100.0 * value:.2f}" for value in published.GLOBAL_MINIMUM.design)
    minima = len(survey.local_minima())
    snapping = float((survey.events > 0).mean())
    ends = ", ".join(
        f"{found[method]} of {len(searches[method])} {NAMES[method]} starts" for method in STARTS
    )
    return (
        f"The lowest f_b is {best:.4f} rad at R_0 = {at[0]:.3f} cm and R_1 = {at[1]:.3f} cm "
        f"({edge} the range surveyed). The paper has it at {theirs} cm (inside); there our f_b is "
        f"{_at_published(context):.4f} rad. The best of the grid is {grid_best.value:.4f} rad. The "
        f"landscape has {minima} local minim{'um' if minima == 1 else 'a'} on this grid, and "
        f"{100.0 * snapping:.0f} % of its designs snap at least once on the way to 5 N: a branch "
        "of equilibria ends and the finger jumps to another. Steps between neighbouring designs "
        "come from there.",
        "With 99 % of the minimum's gain over the default design, that is at "
        f"f_b ≤ {number(reached, 5)} rad, end {ends}.",
    )


def said(contact: str) -> str:
    """Return the name of a way to model contact as people read it."""
    return contact.replace("-", " ")


def largest_step(survey: Landscape) -> float:
    """Return the largest difference between neighbours on the grid, failed designs left out."""
    value = np.where(survey.failed, np.nan, survey.value)
    return max(float(np.nanmax(np.abs(np.diff(value, axis=axis)))) for axis in (0, 1))


def _beside(name: str, survey: Landscape, spheres: Landscape) -> str:
    """Say what another way to model contact changes."""
    best = survey.minimum
    R_0, R_1 = (100.0 * float(value) for value in best.vector)
    snapping, theirs = (100.0 * float((each.events > 0).mean()) for each in (survey, spheres))
    return (
        f"With contact by {said(name)} instead of spheres and the same constants, the best of the "
        f"grid is f_b = {best.value:.4f} rad at R_0 = {R_0:.2f} cm and R_1 = {R_1:.2f} cm; "
        f"{snapping:.0f} % of the designs snap instead of {theirs:.0f} %, the largest step between "
        f"neighbours is {largest_step(survey):.3f} rad instead of {largest_step(spheres):.3f}, and "
        f"there are {len(survey.local_minima())} local minima instead of "
        f"{len(spheres.local_minima())}."
    )


def _at_published(context: Context) -> float:
    """Return our f_b at the published minimum."""

    def compute() -> Data:
        return evaluated(context.problem("R01"), np.array(published.GLOBAL_MINIMUM.design))

    return float(context.part("published-minimum", compute).data["value"])


def _numbers(surveys: Mapping[str, Landscape]) -> tuple[Table, ...]:
    rows: list[tuple[Cell, ...]] = []
    for name, survey in surveys.items():
        best = survey.minimum
        rows.append(
            (
                said(name),
                survey.value.size,
                *(100.0 * float(value) for value in best.vector),
                best.value,
                best.bending,
                len(survey.local_minima()),
                largest_step(survey),
                100.0 * float((survey.events > 0).mean()),
                int(survey.failed.sum()),
            )
        )
    return (
        Table(
            name="fig4-landscape",
            caption="The landscape in numbers.",
            columns=(
                Column("contact by"),
                Column("designs"),
                Column("best of the grid: R_0", "cm", 3),
                Column("R_1", "cm", 3),
                Column("f_b", "rad", 5),
                Column("bending", "rad"),
                Column("local minima"),
                Column("largest step to a neighbour", "rad", 3),
                Column("designs that snap", "%", 3),
                Column("designs that fail"),
            ),
            rows=tuple(rows),
        ),
    )
