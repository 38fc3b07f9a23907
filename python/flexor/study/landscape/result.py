"""A landscape: the objective on a grid over one or two parameters."""

from __future__ import annotations

import csv
import io
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from flexor.errors import InputError
from flexor.optimizers import grid_axes, grid_designs
from flexor.store import replaced, write_text
from flexor.study.design import Design
from flexor.study.problem import FloatArray, Problem
from flexor.study.settings import Settings
from flexor.study.study import Study

_SI = {"cm": "m", "mm": "m", "deg": "rad"}


@dataclass(frozen=True, eq=False)
class Landscape:
    """Values on a grid; every array has the grid's shape (n,) or (n, n), first axis first.

    Attributes
    ----------
    study : Study
        Where every design of it is recorded.
    columns : tuple of int
        Which of the parameters vary, by their place in the set.
    axes : tuple of (n,) arrays
        Their values, SI.
    designs : (..., k) array
        Whole designs, SI.
    value : array
        Of the objective; +inf where the design failed.
    shown : array
        The objective's quantity for display; NaN where failed.
    joint_angles : (..., j) array
        At the last load [rad]; NaN where failed.
    tip_force : array
        At the last load [N].
    touching : array
        Spheres of the exosuit that touch, at the last load.
    events : array of int
        Snaps along the path.
    reason : array of str
        Empty, or why the design failed.
    """

    study: Study
    columns: tuple[int, ...]
    axes: tuple[FloatArray, ...]
    designs: FloatArray
    value: FloatArray
    shown: FloatArray
    joint_angles: FloatArray
    tip_force: FloatArray
    touching: NDArray[np.int32]
    events: NDArray[np.int64]
    reason: NDArray[np.object_]

    @classmethod
    def of(cls, study: Study) -> Landscape:
        """Read a landscape in the record of its study.

        Raises
        ------
        InputError
            If the study is not a grid over one or two parameters, or is not finished.
        """
        values = study.settings.values
        options = values["method"]["options"]
        chosen = study.problem.parameters
        where = f'the study "{study.folder}"' if study.folder else "the study"
        if values["method"]["name"] != "grid" or not values["start"]:
            raise InputError(f"{where} is not a landscape.")
        columns = tuple(options["columns"]) or tuple(range(chosen.size))
        if len(columns) > 2:
            raise InputError(f"{where} is a grid over {len(columns)} parameters: at most 2 show.")
        points, start = options["points"], np.array(values["start"][0])
        designs = grid_designs(chosen.lower, chosen.upper, start, points, columns)
        recorded, outcomes = study.record.designs(), study.record.outcomes()
        if len(recorded) < len(designs):
            raise InputError(
                f"{where} has {len(recorded):,} of {len(designs):,} designs: resume it."
            )
        if not np.array_equal(recorded, designs + 0.0):
            raise InputError(f"{where} is damaged: its record is not its grid.")
        shape = (points,) * len(columns)
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
            reason=outcomes.reason.reshape(shape),
        )

    @classmethod
    def check(cls, folder: str | Path) -> None:
        """Refuse a study folder that is not a landscape, finished or not.

        Raises
        ------
        InputError
            If it is none.
        """
        values = Settings.read(Path(folder)).values
        if values["method"]["name"] != "grid":
            method = values["method"]["name"]
            raise InputError(f'the study "{folder}" is not a landscape: its method is {method}.')

    @classmethod
    def open(cls, folder: str | Path) -> Landscape:
        """Read a finished landscape from its folder.

        Raises
        ------
        InputError
            If the folder holds no landscape, or one that is not finished.
        """
        return cls.of(Study.open(folder))

    @property
    def problem(self) -> Problem:
        """Model, parameter set and objective."""
        return self.study.problem

    @property
    def labels(self) -> tuple[str, ...]:
        """Of the parameters that vary."""
        return tuple(self.problem.parameters.labels[i] for i in self.columns)

    @property
    def failed(self) -> NDArray[np.bool_]:
        """Where the design failed."""
        return ~np.isfinite(self.value)

    @property
    def minimum(self) -> Design:
        """Best design of the grid, the global minimum to the resolution of the grid.

        Raises
        ------
        InputError
            If every design failed.
        """
        return self.study.best

    @property
    def minimum_index(self) -> tuple[int, ...]:
        """Where it is."""
        return tuple(int(i) for i in np.unravel_index(int(np.argmin(self.value)), self.value.shape))

    def local_minima(self) -> NDArray[np.intp]:
        """Find the indices (m, axes) of the points below all their neighbours, diagonal ones too.

        A measure of how rough the landscape is; it grows as the grid shows finer bumps. A failed
        neighbour counts as higher.
        """
        padded = np.pad(self.value, 1, constant_values=np.inf)
        inner = tuple(slice(1, -1) for _ in self.axes)
        lower = np.isfinite(self.value)
        for shift in np.ndindex(*(3,) * len(self.axes)):
            if any(step != 1 for step in shift):
                rolled = np.roll(padded, [1 - step for step in shift], tuple(range(padded.ndim)))
                lower &= self.value < rolled[inner]
        return np.argwhere(lower)

    def save(self, folder: str | Path) -> list[Path]:
        """Write ``landscape.npz`` (every array) and ``landscape.csv`` (a row for each design).

        Parameters
        ----------
        folder : path
            Where to; must exist.

        Returns
        -------
        list of Path
            The files.

        Raises
        ------
        InputError
            If they cannot be written.
        """
        place = Path(folder)
        arrays: dict[str, Any] = {
            name: getattr(self, name)
            for name in ("designs", "value", "shown", "joint_angles", "tip_force", "touching")
        }
        arrays |= {f"axis_{i}": axis for i, axis in enumerate(self.axes)}
        try:
            with replaced(place / "landscape.npz") as draft:
                np.savez_compressed(
                    draft,
                    labels=np.array(self.problem.parameters.labels),
                    columns=np.array(self.columns),
                    **arrays,
                    events=self.events,
                    reason=self.reason.astype(str),
                    force=self.problem.force,
                )
            write_text(place / "landscape.csv", self._csv())
        except OSError as error:
            why = (error.strerror or str(error)).lower()
            raise InputError(f'the landscape cannot be written into "{place}": {why}.') from error
        return [place / "landscape.npz", place / "landscape.csv"]

    def _csv(self) -> str:
        chosen, objective = self.problem.parameters, self.problem.objective
        units = [_SI.get(unit, unit) for unit in chosen.units]
        heads = [
            label if unit == "1" else f"{label} [{unit}]"
            for label, unit in zip(chosen.labels, units, strict=True)
        ]
        heads += [f"objective {objective.name}", f"{objective.quantity} [{objective.unit}]"]
        heads += [f"{joint} [rad]" for joint in self.problem.model.joints]
        heads += ["tip force [N]", "touching", "events", "failure"]
        out = io.StringIO()
        writer = csv.writer(out, lineterminator="\n")
        writer.writerow(heads)
        for i in np.ndindex(*self.value.shape):
            failed = bool(self.failed[i])
            writer.writerow(
                [
                    *self.designs[i].tolist(),
                    "" if failed else float(self.value[i]),
                    "" if failed else float(self.shown[i]),
                    *self.joint_angles[i].tolist(),
                    float(self.tip_force[i]),
                    int(self.touching[i]),
                    int(self.events[i]),
                    self.reason[i],
                ]
            )
        return out.getvalue()
