"""A study: a problem, its settings and everything that was evaluated."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from flexor.errors import InputError
from flexor.objectives import Objective
from flexor.optimizers import SearchResult
from flexor.study.design import Design
from flexor.study.problem import Problem
from flexor.study.record import Record
from flexor.study.settings import Settings

if TYPE_CHECKING:
    from flexor.design import ParameterSet
    from flexor.model import Model


@dataclass(frozen=True)
class Comparison:
    """One line of the comparison of the start with the best design, in display units."""

    label: str
    unit: str
    start: float
    best: float


class Study:
    """What was asked, and everything that was evaluated to answer it.

    Made by `flexor.optimize`, or opened for reading by `Study.open`. Pickled, a study in a folder
    is opened again for reading where it is, and one in memory takes its record along.

    Attributes
    ----------
    problem : Problem
        Model, parameter set and objective.
    settings : Settings
        Everything that decided the numbers.
    record : Record
        Every evaluation.
    folder : Path or None
        Where it is kept; None in memory.
    result : SearchResult or None
        What the search found, if it ran to its end in this process.
    """

    def __init__(
        self,
        problem: Problem,
        settings: Settings,
        record: Record,
        folder: Path | None = None,
        result: SearchResult | None = None,
    ) -> None:
        self.problem = problem
        self.settings = settings
        self.record = record
        self.folder = folder
        self.result = result

    @classmethod
    def open(
        cls,
        folder: str | Path,
        *,
        model: Model | None = None,
        parameters: ParameterSet | None = None,
        objective: Objective | None = None,
    ) -> Study:
        """Open a study for reading, also while another process runs it.

        Parameters
        ----------
        folder : path
            The study folder.
        model, parameters, objective : optional
            In place of those that the folder names; needed for a user's own.

        Raises
        ------
        InputError
            If the folder is not a study, is damaged, or names something that is not known.
        """
        from flexor.study.reopen import reopened, reopened_record

        place = Path(folder)
        settings = Settings.read(place)
        problem = reopened(place, settings, model, parameters, objective)
        return cls(problem, settings, reopened_record(place, problem), place)

    @property
    def evaluations(self) -> int:
        """Number of distinct designs evaluated."""
        return len(self.record)

    @property
    def finished(self) -> str | None:
        """Why the search ended; None if it has not."""
        said = self.record.noted("finished")
        return None if said is None else str(said)

    @property
    def best(self) -> Design:
        """Best design.

        Raises
        ------
        InputError
            If no design succeeded.
        """
        vector = self.record.best()
        if vector is None:
            reasons = self.record.failures()
            why = f": {next(iter(reasons))}" if reasons else ""
            raise InputError(f"no design of the study succeeded{why}.")
        return Design.of(self.problem, vector, self.record.outcomes(vector))

    @cached_property
    def start(self) -> Design:
        """The design the search began from; the parameter set's own start if it was drawn."""
        given = self.settings.values["start"]
        vector = np.array(given[0]) if given else self.problem.parameters.start + 0.0
        known = self.record.outcomes(vector)
        return Design.of(
            self.problem, vector, known if len(known) else self.problem.evaluate(vector[None, :])
        )

    def comparison(self) -> list[Comparison]:
        """Parameters, bending and objective, from the start to the best design.

        Returns
        -------
        list of Comparison
            In display units, for a table.
        """
        chosen, objective = self.problem.parameters, self.problem.objective
        start, best = self.start, self.best
        lines = [
            Comparison(label, unit, float(first), float(last))
            for label, unit, first, last in zip(
                chosen.labels,
                chosen.units,
                start.vector / chosen.scale,
                best.vector / chosen.scale,
                strict=True,
            )
        ]
        lines.append(Comparison("bending", "rad", start.bending, best.bending))
        if objective.quantity != "bending":
            lines.append(Comparison(objective.quantity, objective.unit, start.shown, best.shown))
        lines.append(Comparison(f"objective {objective.name}", "", start.value, best.value))
        return lines

    def table(self) -> dict[str, NDArray[Any]]:
        """Every evaluation in order, as columns.

        Returns
        -------
        dict of (n,) arrays
            The parameters by label (SI), ``value``, ``shown`` (NaN where failed), ``bending``
            [rad], ``tip_force`` [N] and ``touching`` at the last load, ``events``, ``iterations``
            and ``reason``. ``pandas.DataFrame(study.table())`` takes it as it is.
        """
        designs, outcomes = self.record.designs(), self.record.outcomes()
        columns: dict[str, NDArray[Any]] = {
            label: designs[:, i] for i, label in enumerate(self.problem.parameters.labels)
        }
        failed = ~np.isfinite(outcomes.value)
        columns["value"] = np.where(failed, np.nan, outcomes.value)
        columns["shown"] = outcomes.shown
        columns["bending"] = outcomes.joint_angles[:, -1].sum(axis=1)
        columns["tip_force"] = outcomes.tip_force[:, -1]
        columns["touching"] = outcomes.touching[:, -1]
        columns["events"] = outcomes.event_count
        columns["iterations"] = outcomes.total_iterations
        columns["reason"] = outcomes.reason
        return columns

    def close(self) -> None:
        """Close the record."""
        self.record.close()

    def __repr__(self) -> str:
        chosen, place = self.problem.parameters, self.folder or "memory"
        return (
            f"<Study of {chosen.name} for {self.problem.objective.name} in {place}: "
            f"{self.evaluations} designs>"
        )
