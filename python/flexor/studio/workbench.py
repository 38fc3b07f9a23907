"""What the studio computes: paths, landscapes and searches of designs that a request describes."""

from __future__ import annotations

import time
from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from flexor.arrays import Array
from flexor.constraints import chosen_constraints
from flexor.errors import InputError
from flexor.model import Model
from flexor.objectives import evaluate_objective
from flexor.optimizers import grid_designs
from flexor.scene import scene
from flexor.scene.stl import stl
from flexor.study.designed_model import designed_model
from flexor.study.problem import Problem
from flexor.viewer.blobs import Blobs
from flexor.viewer.page import page
from flexor.viewer.payload import Shown, design_payload
from flexor.viewer.share import problem_design, provenance

# Steps of a slider over its range, and how far beyond the file's load it goes.
STEPS, BEYOND = 200, 2.0
MAX_POINTS = 101  # along each axis of a landscape
_PIECE = 4  # rows of a landscape that are evaluated at once


@dataclass(frozen=True, eq=False)
class Workbench:
    """A model, and the design problem that it states.

    Attributes
    ----------
    model : Model
        The model.
    problem : Problem or None
        What varies and what is wanted; None if nothing varies.
    loads : (s, inputs) array
        Loads of the path, which sliders scale.
    source : str
        Where the model came from.
    """

    model: Model
    problem: Problem | None
    loads: Array
    source: str = ""

    def describe(self) -> dict[str, Any]:
        """Return the variables and loads with their ranges in units for display."""
        chosen = None if self.problem is None else self.problem.parameters
        variables = []
        if chosen is not None:
            columns = (chosen.labels, chosen.units, chosen.scale, chosen.lower, chosen.upper)
            for row in zip(*columns, chosen.start, strict=True):
                label, unit, scale, low, high, start = row
                inside = min(max(start, low), high)
                ends = [float(value / scale) for value in (low, high, inside)]
                shown = "" if unit == "1" else unit
                variables.append(_slider(label, shown, *ends))
        return {
            "title": self.model.title or self.model.name,
            "name": self.model.name,
            "variables": variables,
            "loads": [
                _slider(self.model.inputs[i], self._unit(i)[1], *self._range(i))
                for i in self._scaled
            ],
            "aim": "" if self.problem is None else self.problem.objective.name,
            "quantity": "" if self.problem is None else _quantity(self.problem),
            "provenance": provenance(self.model, None, self.source),
        }

    def solve(
        self, values: Sequence[float], loads: Sequence[float], known: Collection[str] = ()
    ) -> dict[str, Any]:
        """Follow the path of a design and return what a page shows of it.

        Parameters
        ----------
        values
            The design, in units for display.
        loads
            Last load of each input that is not zero in the file, likewise.
        known
            Keys of arrays that the page has.

        Raises
        ------
        InputError
            If values are missing, outside their bounds or no numbers.
        """
        began = time.perf_counter()
        design = self.design(values, loads)
        solved = time.perf_counter()
        blobs = Blobs(known)
        shown = design_payload(design, blobs)
        shown["aim"] = self._value(design)
        shown["seconds"] = [solved - began, time.perf_counter() - solved]
        return {"design": shown, "blobs": blobs.table}

    def design(self, values: Sequence[float], loads: Sequence[float], title: str = "") -> Shown:
        """Return a design with its path; see `solve`."""
        force = self.force(loads)
        if self.problem is None:
            paths = self.model.evaluate(self.model.own_design, force, 1)
            stated = self.model.file.design
            asked, without = (stated.subject_to, stated.without) if stated else ((), ())
            kept = chosen_constraints(asked, without, self.model)
            return Shown(title or self.model.name, paths, self.model.file, kept)
        return problem_design(self.problem, self.vector(values), title or "design", force)

    def vector(self, values: Sequence[float]) -> Array:
        """Return a design in SI units; InputError if it is none, or outside its bounds."""
        if self.problem is None:
            raise InputError("nothing varies in this model: give --vary, or a [design].")
        chosen = self.problem.parameters
        given = _numbers(values, chosen.size, "values") * chosen.scale
        # A slider's end in display units may round to a bit beyond the bound.
        slack = 1e-9 * (chosen.upper - chosen.lower)
        inside = np.clip(given, chosen.lower, chosen.upper)
        if (np.abs(inside - given) > slack).any():
            chosen.check_inside(given, "the design")
        return inside

    def force(self, loads: Sequence[float]) -> Array:
        """Return the loads of the path whose last are these, in units for display."""
        given = _numbers(loads, len(self._scaled), "loads")
        scaled = self.loads.copy()
        for value, i in zip(given, self._scaled, strict=True):
            largest = self.loads[np.argmax(np.abs(self.loads[:, i])), i]
            scaled[:, i] *= value * self._unit(i)[0] / largest
        return scaled

    def landscape(
        self, values: Sequence[float], loads: Sequence[float], axes: Sequence[int], points: int
    ) -> Iterator[dict[str, Any]]:
        """Yield rows of the objective over two variables, the others those of a design.

        Parameters
        ----------
        values, loads
            As for `solve`.
        axes
            Indices of the two variables: across, and up.
        points
            Along each axis.

        Yields
        ------
        dict
            ``row`` (its index, upwards), ``shown`` (None where a design fails) and ``broken``
            (whether constraints are exceeded) from left to right. Rows come in an order that
            covers the range early.
        """
        problem, vector = self._problem_at(loads), self.vector(values)
        chosen = problem.parameters
        if len(axes) != 2 or len({*axes}) != 2 or not all(0 <= a < chosen.size for a in axes):
            raise InputError(f"axes are {list(axes)}: choose two different variables.")
        if not 2 <= points <= MAX_POINTS:
            raise InputError(f"points is {points}: at least 2 and at most {MAX_POINTS}.")
        # Of a grid the last column varies fastest.
        first, second = sorted(axes)
        grid = grid_designs(chosen.lower, chosen.upper, vector, points, (first, second))
        grid = grid.reshape(points, points, -1)
        rows = grid if first == axes[1] else grid.transpose(1, 0, 2)
        order = sorted(range(points), key=_spread)
        for start in range(0, points, _PIECE):
            some = order[start : start + _PIECE]
            paths = problem.evaluate(rows[some].reshape(-1, chosen.size), 1)
            shown = paths.shown.reshape(len(some), points)
            broken = (paths.violation > 0.0).reshape(len(some), points)
            for k, row in enumerate(some):
                yield {
                    "row": row,
                    "shown": [v if np.isfinite(v) else None for v in shown[k].tolist()],
                    "broken": broken[k].tolist(),
                }

    def model_file(self, values: Sequence[float]) -> str:
        """Return the model file of a design."""
        if self.problem is None:
            return self.model.to_toml()
        return designed_model(self.problem, self.vector(values)).to_toml()

    def results(self, values: Sequence[float], loads: Sequence[float]) -> dict[str, Any]:
        """Return the path of a design as ``flexor simulate --json`` prints it."""
        return self.design(values, loads).path.to_dict()

    def stl(self, values: Sequence[float], loads: Sequence[float], step: int) -> bytes:
        """Return the rods of a design at a load step as STL."""
        design = self.design(values, loads)
        if not 0 <= step < len(design.path):
            raise InputError(f"step is {step}: the path has {len(design.path)} steps.")
        found = scene(design.path, design.file)
        return stl([each for each in found.objects if each.kind == "rod"], step)

    def share(self, designs: Sequence[tuple[str, Sequence[float], Sequence[float]]]) -> str:
        """Return designs, each with title, values and loads, as one page; see `share_page`."""
        blobs = Blobs(compressed=True)
        shown = [
            design_payload(self.design(values, loads, title), blobs)
            for title, values, loads in designs[:2]
        ]
        title = self.model.title or self.model.name
        data = {
            "title": title,
            "name": self.model.name,
            "designs": shown,
            "blobs": blobs.table,
            "provenance": provenance(self.model, None, self.source),
            "note": "",
        }
        return page(title, ["share.js"], data)

    def problem_at(self, loads: Sequence[float]) -> Problem:
        """Return the problem under other loads; InputError if nothing varies."""
        return self._problem_at(loads)

    def _problem_at(self, loads: Sequence[float]) -> Problem:
        if self.problem is None:
            raise InputError("nothing varies in this model: give --vary, or a [design].")
        force = self.force(loads)
        if np.array_equal(force, self.problem.loads):
            return self.problem
        return replace(self.problem, objective=self.problem.objective.at(force))

    def _value(self, design: Shown) -> str:
        if self.problem is None:
            return ""
        found = evaluate_objective(self.problem.objective, design.paths)
        if found.reason[0]:
            return str(found.reason[0])
        unit = self.problem.unit
        return f"{self.problem.quantity} {found.shown[0]:.4g} {unit}".rstrip()

    @property
    def _scaled(self) -> list[int]:
        """Inputs that are not zero all along."""
        return np.flatnonzero(np.abs(self.loads).max(axis=0) > 0.0).tolist()

    def _unit(self, index: int) -> tuple[float, str]:
        return self.model.load_unit(index)

    def _range(self, index: int) -> tuple[float, float, float]:
        column, size = self.loads[:, index], self._unit(index)[0]
        largest = float(column[np.argmax(np.abs(column))]) / size
        far = BEYOND * largest
        return min(0.0, far), max(0.0, far), largest


def workbench(
    model: Model, problem: Problem | None = None, loads: Array | None = None, source: str = ""
) -> Workbench:
    """Return the workbench of a model.

    Parameters
    ----------
    model
        The model.
    problem
        What varies and what is wanted.
    loads : (s, inputs) array
        Loads of the path; those of the problem or of the model unless given.
    source
        Where the model came from.

    Raises
    ------
    InputError
        If the model's loads are not defined, or it has no path under these.
    """
    if loads is None:
        loads = model.evaluation_loads if problem is None else problem.loads
    bench = Workbench(model, problem, np.array(loads, dtype=float), source)
    # Now rather than when the first slider moves: it prepares the map from fields to the engine.
    described = bench.describe()
    bench.solve(*([each["start"] for each in described[key]] for key in ("variables", "loads")))
    return bench


def _quantity(problem: Problem) -> str:
    return f"{problem.quantity} / {problem.unit}" if problem.unit else problem.quantity


def _slider(name: str, unit: str, low: float, high: float, start: float) -> dict[str, Any]:
    return {
        "name": name,
        "unit": unit,
        "low": low,
        "high": high,
        "start": start,
        "step": (high - low) / STEPS,
    }


def _numbers(values: Sequence[float], count: int, what: str) -> Array:
    try:
        given = np.array(values, dtype=float)
    except (TypeError, ValueError, OverflowError):
        raise InputError(f"{what} are no numbers.") from None
    if given.shape != (count,) or not np.isfinite(given).all():
        raise InputError(f"{what} are {count} finite numbers, but got {values!r:.80}.")
    return given


def _spread(row: int) -> int:
    """Order of rows that bisects what is left: by their bits reversed."""
    return int(f"{row:08b}"[::-1], 2)
