"""A study: a problem, its settings and everything that was evaluated; and its progress."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from flexor.display import Displayed
from flexor.errors import InputError
from flexor.objectives import Objective
from flexor.optimizers import SearchResult
from flexor.store import open_record
from flexor.study.design import Design
from flexor.study.front import Front
from flexor.study.problem import FloatArray, Problem
from flexor.study.record import Record
from flexor.study.scenario_problem import ScenarioProblem
from flexor.study.settings import Settings, reopened, study_record

if TYPE_CHECKING:
    from xarray import Dataset

    from flexor.design import ParameterSet
    from flexor.model import Model


# What the record calls the search for the model as it is, before that over many scenarios.
NOMINAL = "nominal"


@dataclass(frozen=True)
class Comparison:
    """One line of the comparison of the start with the best design, in display units."""

    label: str
    unit: str
    start: float
    best: float


@dataclass(eq=False, repr=False)
class Study(Displayed):
    """A problem, its settings, and everything that was evaluated to solve it.

    Made by `flexor.optimize`, or opened for reading by `Study.open`. Pickled, a study in a folder
    is opened again for reading where it is, and one in memory takes its record along.
    """

    problem: Problem  # model, parameter set and objective
    settings: Settings  # everything that determines the results
    record: Record  # every evaluation
    folder: Path | None = None  # of the study; None in memory
    result: SearchResult | None = None  # of the search, if it was completed in this process
    evaluated: int = 0  # designs in this process, of all in the record
    _whole: Problem | None = None  # while the problem is that of the model as it is
    _best: Design | None = None  # as it was last asked for, with its path and verdict

    @classmethod
    def open(
        cls,
        folder: str | Path,
        *,
        model: Model | None = None,
        parameters: ParameterSet | None = None,
        objective: Objective | None = None,
    ) -> Study:
        """Open a study or a landscape for reading, also while another process runs it.

        Parameters
        ----------
        folder : path
            The study folder.
        model, parameters, objective : optional
            Override those named in the folder; required if they are user-defined.

        Raises
        ------
        InputError
            If the folder is not a study, is damaged, or names something that is not known.
        """
        place = Path(folder)
        settings = Settings.read(place)
        problem = reopened(place, settings, model, parameters, objective)
        database = open_record(settings.kind, place, write=False)
        record = study_record(settings.kind, place, problem, database)
        study = cls(problem, settings, record, place)
        study.take_round([np.array(each) for each in database.noted("rounds") or ()])
        return study

    def take_round(self, corners: Sequence[FloatArray]) -> None:
        """Take the problem and the record of a round; see `flexor.study.rounds`.

        Parameters
        ----------
        corners : sequence of (e, m) arrays
            Errors of this round and of those before it; none in the first.
        """
        if self._whole is not None:
            self.problem, self._whole = self._whole, None
        if isinstance(self.problem, ScenarioProblem):
            self.problem = self.problem.with_corners(corners[-1] if corners else np.zeros((0, 0)))
            self.record = Record(self.record.database, search=_search(corners))

    def take_nominal(self) -> None:
        """Take the problem for the model as it is, with a record of its own, before the rounds."""
        self.record.database.note("nominal", True)
        self._whole = self.problem
        self.problem = self.problem.nominal
        self.record = Record(self.record.database, search=NOMINAL)

    @property
    def records(self) -> tuple[Record, ...]:
        """The record of every round, of which there is one without tolerances."""
        database = self.record.database
        corners = [np.array(each) for each in database.noted("rounds") or ()]
        names = [NOMINAL] if database.noted("nominal") else []
        names += [_search(corners[:count]) for count in range(len(corners) + 1)]
        return tuple(Record(database, search=name) for name in names)

    @property
    def evaluations(self) -> int:
        """Number of distinct designs evaluated, in all rounds."""
        return sum(map(len, self.records))

    @property
    def finished(self) -> str | None:
        """Why the search ended; None if it has not."""
        reason = self.record.database.noted("finished")
        return None if reason is None else str(reason)

    @property
    def robust(self) -> bool | None:
        """Whether the best design keeps the constraints for every error within the tolerances.

        None without tolerances, and until a search has ended.
        """
        found = self.record.database.noted("robust")
        return None if found is None else bool(found)

    @property
    def best(self) -> Design:
        """Best design; InputError if none succeeded."""
        vector = self.record.best()
        if vector is None:
            reasons = self.record.failures()
            why = f": {next(iter(reasons))}" if reasons else ""
            raise InputError(f"no design of the study succeeded{why}.")
        known = self._best
        if known is None or known.problem is not self.problem or any(known.vector != vector):
            self._best = Design.of(self.problem, vector, self.record.outcomes(vector))
        assert self._best is not None
        return self._best

    @property
    def front(self) -> Front:
        """Designs that no other is better than in all of several objectives, as known by now."""
        return Front.of(self)

    @cached_property
    def start(self) -> Design:
        """The design the search began from; the parameter set's own start if it was drawn."""
        given = self.settings.values["start"]
        vector = np.array(given[0]) if given else self.problem.parameters.start + 0.0
        paths = self.record.outcomes(vector)
        if not len(paths):
            paths = self.problem.evaluate(vector[None, :])
        return Design.of(self.problem, vector, paths)

    def comparison(self) -> list[Comparison]:
        """Parameters and what is sought of the start and of the best design."""
        chosen, objective = self.problem.parameters, self.problem.objective
        start, best = self.start, self.best
        ends = [(design.vector / chosen.scale).tolist() for design in (start, best)]
        lines = list(map(Comparison, chosen.labels, chosen.units, *ends))
        if not objective.of_observable:
            lines.append(Comparison("bending", "rad", start.bending, best.bending))
        if objective.of_observable or self.problem.quantity != "bending":
            sought = self.problem.quantity, self.problem.unit
            lines.append(Comparison(*sought, start.shown, best.shown))
        if not objective.of_observable:
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
        outcomes = self.record.outcomes()
        designs = zip(self.problem.parameters.labels, self.record.designs().T, strict=True)
        return {
            **dict(designs),
            "value": np.where(np.isfinite(outcomes.value), outcomes.value, np.nan),
            "shown": outcomes.shown,
            "bending": outcomes.joint_angles[:, -1].sum(axis=1),
            "tip_force": outcomes.tip_force[:, -1],
            "touching": outcomes.touching[:, -1],
            "events": outcomes.event_count,
            "iterations": outcomes.total_iterations,
            "reason": outcomes.reason,
        }

    def to_xarray(self) -> Dataset:
        """Return every evaluation with names and units of axes; needs the extra ``xarray``.

        The dimensions are ``design``, ``step``, ``joint`` and those of constraints and objectives;
        parameters are variables. ``to_dataframe()`` of a variable is a table for pandas, and
        ``to_netcdf(FILE, engine="h5netcdf")`` writes a file.
        """
        from flexor.study.dataset import study_dataset

        return study_dataset(self)

    def close(self) -> None:
        """Close the record."""
        self.record.close()

    def __repr__(self) -> str:
        chosen, place = self.problem.parameters, self.folder or "memory"
        return (
            f"<Study of {chosen.name} for {self.problem.objective.name} in {place}: "
            f"{self.evaluations} designs>"
        )


def _search(corners: Sequence[FloatArray]) -> str:
    """Return what the record calls a round, by its errors: with another budget these are others."""
    if not corners:
        return ""
    digest = hashlib.sha256(np.asarray(corners[-1], dtype="<f8").tobytes()).hexdigest()
    return f"round {len(corners)} {digest[:12]}"


@dataclass(frozen=True, eq=False)
class StudyProgress:
    """Progress of a running study."""

    best: Design | None  # best design so far; None while every design has failed
    evaluations: int  # distinct designs the search has asked for
    evaluated: int  # in this run
    replayed: int  # known from an earlier run
    iteration: int  # of the method
    seconds: float  # time since the study began or was resumed [s]
    # Evaluations to the end of the budget, or to convergence without further improvement,
    # whichever is fewer; None if neither is known.
    remaining: int | None
    detail: str  # status message of the method
    # Of several rounds, which one: what its best design is the best of; see `flexor.study.rounds`.
    stage: str = ""

    @property
    def rate(self) -> float:
        """Designs evaluated per second."""
        return self.evaluated / self.seconds if self.seconds > 0.0 else 0.0

    @property
    def seconds_left(self) -> float | None:
        """Estimated remaining time [s]; None if unknown."""
        if self.remaining is None or self.rate == 0.0:
            return None
        return self.remaining / self.rate


StudyCallback = Callable[[StudyProgress], None]
