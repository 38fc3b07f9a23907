"""The paper's conclusions, tested one by one."""

from __future__ import annotations

from flexor.paper.brief import brief
from flexor.paper.conclusion import Conclusion
from flexor.paper.conclusions_on_designs import on_designs, on_objectives
from flexor.paper.conclusions_on_searches import on_mechanics, on_searches
from flexor.paper.context import Context
from flexor.paper.optimum import Optimum, true_optimum
from flexor.paper.section import Cell, Column, Section, Table
from flexor.paper.settings import OBJECTIVES, SETS, other_reading


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
    other = context.using(other_reading(context.settings.constants))
    found = [*_on_model(context), *on_searches(context, _best(context))]
    also = {each.claim: each for each in _on_model(other)}
    held = sum(each.holds for each in found)
    held_also = sum(each.holds for each in also.values())
    return Section(
        name="conclusions",
        title="The paper's conclusions, one by one",
        text=(
            f"{held} of {len(found)} conclusions hold in our model with the constants "
            f'"{context.settings.constants}", {len(found) - held} do not. With '
            f'"{other.settings.constants}", the other reading of what the paper leaves open, '
            f"{held_also} of {len(also)} hold; those on searches are tested with the former only.",
            *brief(context, other, _best(context), _best(other)),
        ),
        tables=(
            Table(
                name="conclusions",
                caption="What the paper concludes, and what our model says.",
                columns=(
                    Column("conclusion"),
                    Column("place"),
                    Column("holds"),
                    Column("numbers"),
                    Column(f"holds, {other.settings.constants}"),
                    Column(f"numbers, {other.settings.constants}"),
                ),
                rows=tuple(_row(each, also.get(each.claim)) for each in found),
            ),
        ),
    )


def _best(context: Context) -> dict[str, Optimum]:
    return {name: true_optimum(context, name) for name in SETS}


def _on_model(context: Context) -> list[Conclusion]:
    """Test what needs no comparison of searches."""
    by_objective = {name: true_optimum(context, "L+R01", name) for name in OBJECTIVES}
    return [
        *on_designs(context, _best(context)),
        *on_objectives(context, by_objective),
        *on_mechanics(context, _best(context)),
    ]


def _row(each: Conclusion, also: Conclusion | None) -> tuple[Cell, ...]:
    beside = (None, None) if also is None else (also.holds, also.evidence)
    return (each.claim, each.place, each.holds, each.evidence, *beside)
