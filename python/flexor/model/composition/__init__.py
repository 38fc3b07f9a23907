"""Models made of others: a file whose parts are put in their place is a file like any other."""

from __future__ import annotations

from flexor.model.composition.expansion import MAX_DEPTH, MAX_PARTS, expanded

__all__ = ["MAX_DEPTH", "MAX_PARTS", "expanded"]
