"""Convergence history of a search: every improvement, from its start to its end."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexor.optimizers import SearchResult
from flexor.study.problem import FloatArray
from flexor.study.study import Study


@dataclass(frozen=True, eq=False)
class SearchPath:
    """The best design of a search whenever it improved.

    Attributes
    ----------
    label : str
        What to call it in a figure, for example ``"L_1"``; may be empty.
    method : str
        Name of the method.
    designs : (m, k) array
        First the start (the first design that succeeded), last the end, SI.
    values : (m,) array
        Their values.
    evaluations : (m,) array
        After how many evaluations each was found.
    """

    label: str
    method: str
    designs: FloatArray
    values: FloatArray
    evaluations: FloatArray

    @classmethod
    def of(cls, result: SearchResult, method: str, label: str = "") -> SearchPath:
        """Read the history of a search from its result."""
        return cls(
            label=label,
            method=method,
            designs=result.improvement_designs,
            values=result.improvement_values,
            evaluations=result.improvement_evaluations.astype(np.float64),
        )

    @classmethod
    def from_study(cls, study: Study, label: str = "") -> SearchPath:
        """Read the history of a study's search from its record."""
        values = study.record.outcomes().value
        best = np.minimum.accumulate(values) if values.size else values
        better = np.isfinite(values) & (values < np.append(np.inf, best[:-1]))
        rows = np.flatnonzero(better)
        return cls(
            label=label,
            method=str(study.settings.values["method"]["name"]),
            designs=study.record.designs()[rows],
            values=values[rows],
            evaluations=(rows + 1).astype(np.float64),
        )
