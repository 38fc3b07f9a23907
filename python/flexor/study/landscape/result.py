"""A landscape: objective and constraints on a grid over one or two parameters, and searches."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import minimum_filter

from flexor.constraints import INFEASIBLE, ranks
from flexor.display import Displayed
from flexor.errors import InputError
from flexor.optimizers import SearchResult, grid_axes, grid_designs
from flexor.store.files import csv_text, reason, replaced, write_text
from flexor.study.design import Design
from flexor.study.problem import FloatArray, Problem
from flexor.study.settings import LANDSCAPE, Settings
from flexor.study.study import Study


@dataclass(frozen=True, eq=False)
class Landscape(Displayed):
    """Values on a grid; every array has the grid's shape (n,) or (n, n), first axis first."""

    study: Study  # its record has the designs
    columns: tuple[int, ...]  # indices of the parameters that vary
    axes: tuple[FloatArray, ...]  # their values, (n,) each, SI
    designs: FloatArray  # (..., k), whole, SI
    value: FloatArray  # the objective; +inf where the design failed
    shown: FloatArray  # its quantity for display; NaN where the design failed
    joint_angles: FloatArray  # (..., j), at the last load [rad]; NaN where the design failed
    tip_force: FloatArray  # at the last load [N]; NaN where the design failed
    touching: NDArray[np.int32]  # spheres of the exosuit in contact at the last load
    events: NDArray[np.int64]  # snaps along the path
    constraint_values: FloatArray  # (..., c), worst along the path, SI
    excesses: FloatArray  # (..., c), by the bound; kept where not above 0, NaN where failed
    violation: FloatArray  # sum of what constraints are exceeded by; +inf where the design failed
    reason: NDArray[np.object_]  # of the failure; empty if there is none

    @classmethod
    def of(cls, study: Study) -> Landscape:
        """Read a landscape in the record of its study.

        InputError if that is not a grid over one or two parameters, or is not finished.
        """
        values, chosen = study.settings.values, study.problem.parameters
        options = values["method"]["options"]
        where = f"the {study.settings.kind.name}" + (f' "{study.folder}"' if study.folder else "")
        if values["method"]["name"] != "grid" or not values["start"]:
            raise InputError(f"{where} is not a landscape.")
        columns = tuple(options["columns"]) or tuple(range(chosen.size))
        if len(columns) > 2:
            raise InputError(f"{where} is a grid over {len(columns)} parameters: at most 2 show.")
        points, start = options["points"], np.array(values["start"][0])
        designs = grid_designs(chosen.lower, chosen.upper, start, points, columns)
        recorded, outcomes = study.record.designs(), study.record.outcomes()
        if len(recorded) < len(designs):
            done = f"{len(recorded):,} of {len(designs):,} designs"
            raise InputError(f"{where} has {done}: resume it.")
        if not np.array_equal(recorded, designs + 0.0):
            raise InputError(f"{where} is damaged: its record is not its grid.")
        shape = (points,) * len(columns)
        excess = study.problem.excesses(outcomes)
        excess[~np.isfinite(outcomes.value)] = np.nan
        return cls(
            study=study,
            columns=columns,
            axes=tuple(grid_axes(chosen.lower, chosen.upper, points, columns)),
            designs=designs.reshape(*shape, -1),
            value=outcomes.value.reshape(shape),
            shown=outcomes.shown.reshape(shape),
            joint_angles=outcomes.joint_angles[:, -1].reshape(*shape, -1),
            tip_force=outcomes.tip_force[:, -1].reshape(shape),
            touching=outcomes.touching[:, -1].reshape(shape),
            events=outcomes.event_count.reshape(shape),
            constraint_values=outcomes.constraint_values.reshape(*shape, -1),
            excesses=excess.reshape(*shape, -1),
            violation=outcomes.violation.reshape(shape),
            reason=outcomes.reason.reshape(shape),
        )

    @classmethod
    def open(cls, folder: str | Path) -> Landscape:
        """Read a finished landscape of any version from its folder; InputError if there is none."""
        Settings.read(Path(folder), LANDSCAPE)
        return cls.of(Study.open(folder))

    def close(self) -> None:
        """Close the record."""
        self.study.close()

    @property
    def problem(self) -> Problem:
        """Model, parameter set and objective."""
        return self.study.problem

    @property
    def labels(self) -> tuple[str, ...]:
        """Labels of the parameters that vary."""
        return tuple(self.problem.parameters.labels[i] for i in self.columns)

    @property
    def constraints(self) -> tuple[str, ...]:
        """The constraints as they are written, such as ``"overlap <= 1 mm"``."""
        problem = self.problem
        return tuple(each.text(problem.model) for each in problem.constraints)

    @property
    def failed(self) -> NDArray[np.bool_]:
        """Which designs failed."""
        return ~np.isfinite(self.value)

    @property
    def infeasible(self) -> NDArray[np.bool_]:
        """Which designs exceed a constraint."""
        return ~self.failed & (self.violation > 0.0)

    @property
    def rank(self) -> FloatArray:
        """Numbers that order the designs: feasible ones by value, then others by violation."""
        return ranks(self.value, self.violation)

    @property
    def minimum(self) -> Design:
        """Best design of the grid, the global minimum to its resolution.

        If none keeps the constraints, the one that exceeds them least. InputError if every design
        failed.
        """
        return self.study.best

    @property
    def minimum_index(self) -> tuple[int, ...]:
        """Indices of the best design."""
        index = np.unravel_index(int(np.argmin(self.rank)), self.value.shape)
        return tuple(int(i) for i in index)

    def local_minima(self) -> NDArray[np.intp]:
        """Find the indices (m, axes) of the points below all their neighbours, diagonal ones too.

        A measure of how rough the landscape is; it grows as the grid shows finer bumps. Only
        feasible designs count; neighbours that fail or are infeasible count as higher.
        """
        value = np.where(self.infeasible, np.inf, self.value)
        neighbours = np.ones((3,) * len(self.axes), dtype=bool)
        neighbours[(1,) * len(self.axes)] = False
        lowest = minimum_filter(value, footprint=neighbours, mode="constant", cval=np.inf)
        return np.argwhere(value < lowest)

    def save(self, folder: str | Path) -> list[Path]:
        """Write ``landscape.npz`` (every array) and ``landscape.csv`` (a row for each design).

        Returns the files; InputError if they cannot be written into the folder.
        """
        npz, csv = (Path(folder) / f"landscape.{ending}" for ending in ("npz", "csv"))
        names = (
            *("designs", "value", "shown", "joint_angles", "tip_force", "touching", "events"),
            *("constraint_values", "excesses", "violation"),
        )
        arrays: dict[str, Any] = {name: getattr(self, name) for name in names}
        arrays |= {f"axis_{i}": axis for i, axis in enumerate(self.axes)}
        arrays |= {"labels": self.problem.parameters.labels, "columns": self.columns}
        arrays |= {"constraints": np.array(self.constraints, dtype=str)}
        arrays |= {"reason": self.reason.astype(str), "force": self.problem.force}
        try:
            with replaced(npz) as draft:
                np.savez_compressed(draft, **arrays)
            write_text(csv, self._csv())
        except OSError as error:
            what = f'the landscape cannot be written into "{folder}"'
            raise InputError(f"{what}: {reason(error)}.") from error
        return [npz, csv]

    def _csv(self) -> str:
        chosen, objective = self.problem.parameters, self.problem.objective
        units = ["" if unit == "1" else f" [{unit}]" for unit in chosen.si_units]
        heads = [f"{label}{unit}" for label, unit in zip(chosen.labels, units, strict=True)]
        heads += [f"objective {objective.name}", f"{objective.quantity} [{objective.unit}]"]
        heads += [f"{joint} [rad]" for joint in self.problem.model.joints]
        heads += ["tip force [N]", "touching", "events"]
        # Heads of constraints are their texts; a row has what they bound, SI.
        heads += [*self.constraints, "violation", "failure"]
        rows: list[list[object]] = [[*heads]]
        for i in np.ndindex(*self.value.shape):
            values = ["", ""] if self.failed[i] else [float(self.value[i]), float(self.shown[i])]
            counts = self.touching[i], self.events[i]
            path = *self.joint_angles[i], self.tip_force[i], *counts
            kept = *self.constraint_values[i], "" if self.failed[i] else self.violation[i]
            rows.append([*self.designs[i], *values, *path, *kept, self.reason[i]])
        return csv_text(rows)


@dataclass(frozen=True, eq=False)
class SearchPath:
    """The best design of a search whenever it improved."""

    label: str  # in figures, for example ``"L_1"``; may be empty
    method: str  # its name
    designs: FloatArray  # (m, k), from the first that succeeded to the end, SI
    values: FloatArray  # (m,), of the objective; NaN where not known, as of infeasible designs
    evaluations: FloatArray  # (m,), until each was found

    @classmethod
    def of(cls, result: SearchResult, method: str, label: str = "") -> SearchPath:
        """Read the history of a search from its result."""
        return cls(
            label=label,
            method=method,
            designs=result.improvement_designs,
            values=np.where(
                result.improvement_values < INFEASIBLE, result.improvement_values, np.nan
            ),
            evaluations=result.improvement_evaluations.astype(np.float64),
        )

    @classmethod
    def from_study(cls, study: Study, label: str = "") -> SearchPath:
        """Read the history of a study's search from its record."""
        outcomes = study.record.outcomes()
        rank = study.problem.ranks(outcomes)
        best = np.minimum.accumulate(rank) if rank.size else rank
        rows = np.flatnonzero(np.isfinite(rank) & (rank < np.append(np.inf, best[:-1])))
        return cls(
            label=label,
            method=str(study.settings.values["method"]["name"]),
            designs=study.record.designs()[rows],
            values=outcomes.value[rows],
            evaluations=(rows + 1).astype(np.float64),
        )
