"""The paper's conclusions, tested one by one."""

from __future__ import annotations

from flexor.paper.conclusions_on_designs import on_designs, on_objectives
from flexor.paper.conclusions_on_searches import on_mechanics, on_searches
from flexor.paper.context import Context
from flexor.paper.optimum import true_optimum
from flexor.paper.section import Column, Section, Table
from flexor.paper.settings import OBJECTIVES, SETS


def conclusions(context: Context) -> Section:
    """Test the paper's conclusions.

    Parameters
    ----------
    context : Context
        Models, settings and folder.

    Returns
    -------
    Section
        Each with a yes or no and the numbers.
    """
    best = {name: true_optimum(context, name) for name in SETS}
    by_objective = {name: true_optimum(context, "L+R01", name) for name in OBJECTIVES}
    found = [
        *on_designs(context, best),
        *on_objectives(context, by_objective),
        *on_searches(context, best),
        *on_mechanics(context, best),
    ]
    held = sum(each.holds for each in found)
    return Section(
        name="conclusions",
        title="The paper's conclusions, one by one",
        text=(
            f"{held} of {len(found)} conclusions hold in our model with the constants "
            f'"{context.settings.constants}", {len(found) - held} do not.',
        ),
        tables=(
            Table(
                name="conclusions",
                caption="What the paper concludes, and what our model says.",
                columns=(Column("conclusion"), Column("place"), Column("holds"), Column("numbers")),
                rows=tuple((each.claim, each.place, each.holds, each.evidence) for each in found),
            ),
        ),
    )
