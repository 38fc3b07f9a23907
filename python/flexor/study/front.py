"""The front of a study with several objectives: what no other design is better than in all."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from flexor.errors import InputError
from flexor.objectives import Objective, Several
from flexor.optimizers import nondominated
from flexor.store import csv_text, write_text
from flexor.store.files import reason
from flexor.study.design import Design
from flexor.study.problem import FloatArray, Problem

if TYPE_CHECKING:
    from flexor.model.results import Paths
    from flexor.study.study import Study


# Nearer points of a front, as a share of its range in every objective, count as one.
NEAR = 1e-3
# Points that figures number and tables have at least.
NUMBERED = 5


@dataclass(frozen=True, eq=False)
class Front:
    """Feasible designs between several objectives, in the order of the first.

    Points that are all but the same, such as those of finite differences, are left out. Of a study
    with one objective it is the best design.
    """

    problem: Problem
    designs: FloatArray  # (p, k), SI
    values: FloatArray  # (p, m), of the objectives, to be minimised, SI
    outcomes: Paths  # of these designs, as recorded

    @classmethod
    def of(cls, study: Study) -> Front:
        """Find the front among everything that a study has evaluated; empty if none is feasible."""
        outcomes, problem = study.record.outcomes(), study.problem
        values = outcomes.objective_values
        if not problem.objective.count:
            values = outcomes.value[:, None]
        feasible = np.flatnonzero(np.isfinite(outcomes.value) & (outcomes.violation == 0.0))
        rows = feasible[nondominated(values[feasible])]
        rows = rows[_distinct(values[rows])]
        designs = study.record.designs()
        return cls(problem, designs[rows], values[rows], outcomes[rows])

    def __len__(self) -> int:
        return len(self.designs)

    def __getitem__(self, index: int) -> Design:
        return Design.of(self.problem, self.designs[index], self.outcomes, index)

    def point(self, number: int) -> Design:
        """Return a design by its number, from 1; InputError if there is none."""
        if not len(self):
            raise InputError("the front is empty: no design that was tried keeps the constraints.")
        if not 1 <= number <= len(self):
            raise InputError(f"point is {number}: the front has points 1 to {len(self)}.")
        return self[number - 1]

    def spread(self, count: int) -> list[int]:
        """Return so many rows spread over the front, or all; those with a number are among them."""
        if len(self) <= count:
            return list(range(len(self)))
        numbered, rows = (
            np.linspace(0, len(self) - 1, each).round().astype(int) for each in (NUMBERED, count)
        )
        return sorted({*numbered.tolist(), *(rows.tolist() if count > NUMBERED else ())})

    @property
    def objectives(self) -> tuple[Objective, ...]:
        """The objectives, m."""
        wanted = self.problem.objective
        return wanted.parts if isinstance(wanted, Several) else (wanted,)

    @property
    def shown(self) -> FloatArray:
        """Values in the units of `headings`, (p, m)."""
        columns = [
            each.displayed(column)
            for each, column in zip(self.objectives, self.values.T, strict=True)
        ]
        return np.stack(columns, axis=1)

    @property
    def headings(self) -> tuple[str, ...]:
        """Names of the objectives' quantities with their units, such as ``"mass / kg"``."""
        return tuple(
            f"{each.quantity} / {each.unit}".removesuffix(" / ") for each in self.objectives
        )

    def hypervolume(self, reference: ArrayLike, ideal: ArrayLike | None = None) -> float:
        """Return the volume between the front and a reference point (m,) that is worse in all.

        In SI units of values to be minimised; with the ``ideal`` point (m,) as a share of the box
        between the two.
        """
        from pymoo.indicators.hv import HV

        worst = np.asarray(reference, dtype=np.float64)
        best = worst - 1.0 if ideal is None else np.asarray(ideal, dtype=np.float64)
        points = (self.values - worst) / (worst - best)
        if not len(points):
            return 0.0
        return float(HV(ref_point=np.zeros(worst.size))(points))

    def table(self) -> dict[str, FloatArray]:
        """Every point, as columns.

        Returns
        -------
        dict of (p,) arrays
            ``point`` from 1, the objectives' quantities in their units, the parameters in SI. Ready
            for ``pandas.DataFrame``.
        """
        chosen = self.problem.parameters
        units = ["" if unit == "1" else f" / {unit}" for unit in chosen.si_units]
        labels = [f"{label}{unit}" for label, unit in zip(chosen.labels, units, strict=True)]
        return {
            "point": np.arange(1, len(self) + 1),
            **dict(zip(self.headings, self.shown.T, strict=True)),
            **dict(zip(labels, self.designs.T, strict=True)),
        }

    def save(self, folder: str | Path) -> Path:
        """Write ``front.csv``, a row for each point; return the file."""
        table = self.table()
        rows = zip(*(column.tolist() for column in table.values()), strict=True)
        file = Path(folder) / "front.csv"
        try:
            write_text(file, csv_text([list(table), *rows]))
        except OSError as error:
            raise InputError(f'"{file}" cannot be written: {reason(error)}.') from error
        return file

    def as_json(self) -> list[dict[str, Any]]:
        """Return every point with its objectives by name and its parameters, SI."""
        names = [each.name for each in self.objectives]
        signs = [getattr(each, "sign", 1.0) for each in self.objectives]
        return [
            {
                "point": number,
                "objectives": {
                    name: sign * value + 0.0
                    for name, sign, value in zip(names, signs, values.tolist(), strict=True)
                },
                "parameters": dict(
                    zip(self.problem.parameters.labels, design.tolist(), strict=True)
                ),
            }
            for number, (values, design) in enumerate(
                zip(self.values, self.designs, strict=True), start=1
            )
        ]

    def __repr__(self) -> str:
        return f"<Front of {self.problem.objective.name}: {len(self)} designs>"


def _distinct(values: FloatArray) -> list[int]:
    """Return rows of a front (p, m) that are apart from each other, with the best of each value."""
    if not len(values):
        return []
    apart = NEAR * np.ptp(values, axis=0)
    kept = list(dict.fromkeys(int(row) for row in np.argmin(values, axis=0)))
    for row in range(len(values)):
        if np.all(np.any(np.abs(values[kept] - values[row]) > apart, axis=1)):
            kept.append(row)
    return sorted(kept)
