"""Search: optimisers behind one interface, each in a file of its own."""

from __future__ import annotations

from flexor.search.catalogue import method, names
from flexor.search.counted import BudgetSpent, Counted
from flexor.search.interface import (
    BatchFunction,
    Budget,
    Progress,
    ProgressCallback,
    Search,
    SearchResult,
)
from flexor.search.pattern import PatternSearch
from flexor.search.starts import starting_designs

__all__ = [
    "BatchFunction",
    "Budget",
    "BudgetSpent",
    "Counted",
    "PatternSearch",
    "Progress",
    "ProgressCallback",
    "Search",
    "SearchResult",
    "method",
    "names",
    "starting_designs",
]
