"""The items of the study, by the names they are asked for with."""

from __future__ import annotations

from collections.abc import Callable, Iterable

from flexor.errors import InputError, unknown
from flexor.paper.conclusions import conclusions
from flexor.paper.constants import constants
from flexor.paper.context import Context
from flexor.paper.fig3 import fig3
from flexor.paper.fig4 import fig4
from flexor.paper.fig5 import fig5
from flexor.paper.fig6 import fig6
from flexor.paper.optimisers import optimisers
from flexor.paper.readings import readings
from flexor.paper.section import Section
from flexor.paper.table3 import table3
from flexor.paper.table4 import table4

ITEMS: dict[str, Callable[[Context], Section]] = {
    "constants": constants,
    "fig3": fig3,
    "fig4": fig4,
    "table3": table3,
    "fig5": fig5,
    "table4": table4,
    "fig6": fig6,
    "readings": readings,
    "optimisers": optimisers,
    "conclusions": conclusions,
}


def chosen(names: str | Iterable[str] | None) -> tuple[str, ...]:
    """Return items by name, in the order of the study.

    Parameters
    ----------
    names : str or iterable of str, optional
        Names, or a text that lists them with commas; all by default. Capitals, blanks and dots do
        not matter (``"Fig. 4"``).

    Raises
    ------
    InputError
        If one is not known (the nearest is suggested) or none is given.
    """
    if names is None:
        return tuple(ITEMS)
    listed = names.split(",") if isinstance(names, str) else list(names)
    wanted = []
    for name in listed:
        plain = "".join(sign for sign in name.lower() if sign.isalnum())
        if not plain:
            continue
        if plain not in ITEMS:
            raise unknown("item of the study", name.strip(), ITEMS)
        wanted.append(plain)
    if not wanted:
        raise InputError(f"no item of the study is named: give some of {', '.join(ITEMS)}.")
    return tuple(name for name in ITEMS if name in wanted)
