"""Every validation case, in the order of the report."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from importlib import import_module

from flexor.errors import unknown
from flexor.validate.case import Case

# A new family is one file with its `CASES` and one word here.
_MODULES = (
    *("bending", "sections", "chambers", "cantilever", "elastica", "contact", "joint_limits"),
    *("rigid_trees", "strong_form", "discrete_rod", "variable_strain"),
    *("convergence", "toolbox"),
)


@cache
def cases() -> tuple[Case, ...]:
    """Return every case."""
    modules = [import_module(f"flexor.validate.{name}") for name in _MODULES]
    return tuple(case for module in modules for case in module.CASES)


def chosen(names: Sequence[str]) -> tuple[Case, ...]:
    """Return the cases with these names, in the order of the report; all without names.

    Parameters
    ----------
    names
        Names of cases.

    Raises
    ------
    InputError
        If there is no such case.
    """
    known = {case.name: case for case in cases()}
    for name in names:
        if name not in known:
            raise unknown("case", name, known)
    return tuple(case for case in cases() if not names or case.name in names)
