"""Bench measurements of a device: a table to fill in, and its comparison with what is predicted."""

from __future__ import annotations

import csv
from dataclasses import dataclass
from pathlib import Path as FilePath
from typing import TYPE_CHECKING

import numpy as np

from flexor.arrays import Array
from flexor.errors import InputError, unknown_name
from flexor.model.toml import is_special
from flexor.store.files import csv_text, reason

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from flexor.model import Model
    from flexor.model.geometry import Geometry, SlotValues

_LARGEST = 10_000_000  # bytes of a table


@dataclass(frozen=True, eq=False)
class Bench:
    """Measured and predicted angles at the same loads.

    Attributes
    ----------
    model : Model
        The model.
    loads : (n, inputs) array
        Loads of the rows [SI].
    joints : tuple of str
        Names of the joints that were measured, as in headings.
    measured, predicted : (n, joints) arrays
        Angles [rad]; NaN where there is none.
    """

    model: Model
    loads: Array
    joints: tuple[str, ...]
    measured: Array
    predicted: Array

    @property
    def deviations(self) -> Array:
        """Root mean square of measured less predicted, of each joint [rad]; (joints,)."""
        squares = (self.measured - self.predicted) ** 2
        count = np.isfinite(squares).sum(axis=0)
        with np.errstate(invalid="ignore"):
            return np.asarray(np.sqrt(np.nansum(squares, axis=0) / count))


def template(model: Model) -> str:
    """Return the table to fill in, as CSV: the loads of the evaluation, and a column a joint."""
    columns = [*_load_headings(model), *_joint_headings(model)]
    loads = model.evaluation_loads / _units(model)
    blank = [""] * len(_joint_headings(model))
    return csv_text([columns, *([f"{x:.6g}" for x in row] + blank for row in loads)])


def bench(model: Model, file: FilePath, design: Geometry | SlotValues | None = None) -> Bench:
    """Compare a table of measurements with what a model predicts.

    Parameters
    ----------
    model
        The model.
    file
        A table as `template` gives: loads may rise and fall, be repeated, and be other ones;
        columns of joints may be missing, and cells empty.
    design
        A design of the model; the model's own unless given.

    Raises
    ------
    InputError
        If the file is no such table, naming the row and the column.
    """
    headings, rows = _read(file)
    expected = [*_load_headings(model), *_joint_headings(model)]
    for heading in headings:
        if heading not in expected:
            raise InputError(f'"{file}" has the {unknown_name("column", heading, expected)}.')
    for heading in _load_headings(model):
        if heading not in headings:
            raise InputError(f'"{file}" has no column "{heading}".')
    values = np.array([_numbers(row, headings, file, line) for line, row in rows])
    column = {heading: values[:, index] for index, heading in enumerate(headings)}
    loads = np.stack([column[each] for each in _load_headings(model)], axis=1) * _units(model)
    if not np.isfinite(loads).all():
        line = rows[int(np.flatnonzero(~np.isfinite(loads).all(axis=1))[0])][0]
        raise InputError(f'"{file}" has no load in line {line}.')
    names = [
        joint
        for joint, heading in zip(model.angular_joints, _joint_headings(model), strict=True)
        if heading in headings
    ]
    labels = dict(zip(model.angular_joints, _joint_headings(model), strict=True))
    if not names:
        raise InputError(f'"{file}" has no column of a joint, such as "{expected[-1]}".')
    measured = np.radians(np.stack([column[labels[name]] for name in names], axis=1))
    steps = {name: loads[:, index].tolist() for index, name in enumerate(model.inputs)}
    path = model.equilibrium(steps if len(steps) > 1 else loads[:, 0].tolist(), design)
    found = np.where(path.converged[:, None], path.joint_angles, np.nan)
    places = [model.joints.index(name) for name in names]
    shown = tuple(model.joint_labels[name] for name in names)
    return Bench(model, loads, shown, measured, found[:, places])


def figure(found: Bench) -> Figure:
    """Plot measured angles against the load, with the predicted ones as lines."""
    from matplotlib.figure import Figure

    from flexor.plot.style import COLUMN, distinct, literal, style

    model = found.model
    with style():
        drawn = Figure(figsize=(COLUMN, 2.6), layout="constrained")
        axes = drawn.subplots()
        size, unit = model.load_unit()
        x = found.loads[:, 0] / size
        for index, (name, line) in enumerate(
            zip(found.joints, distinct(len(found.joints)), strict=True)
        ):
            label = literal(name)
            axes.plot(x, np.degrees(found.predicted[:, index]), **line)
            dots = np.degrees(found.measured[:, index])
            axes.plot(x, dots, "o", color=line["color"], markersize=3.5, label=label)
        axes.set_xlabel(f"{literal(model.load_name())} / {unit}")
        axes.set_ylabel("joint angle / °")
        axes.legend(title="measured (dots), predicted (lines)")
        return drawn


def _load_headings(model: Model) -> list[str]:
    return [f"{name} / {model.load_unit(i)[1]}" for i, name in enumerate(model.inputs)]


def _joint_headings(model: Model) -> list[str]:
    return [f"{model.joint_labels[name]} / deg" for name in model.angular_joints]


def _units(model: Model) -> Array:
    return np.array([model.load_unit(index)[0] for index in range(len(model.inputs))])


def _read(file: FilePath) -> tuple[list[str], list[tuple[int, list[str]]]]:
    """Return the headings, and the rows that are not empty with their line."""
    if is_special(file):
        raise InputError(f'"{file}" cannot be read: it is not a regular file.')
    try:
        if file.stat().st_size > _LARGEST:
            raise InputError(f'"{file}" is larger than {_LARGEST // 1_000_000} MB.')
        text = file.read_text(encoding="utf-8-sig")
    except OSError as error:
        raise InputError(f'"{file}" cannot be read: {reason(error)}.') from None
    except UnicodeDecodeError:
        raise InputError(f'"{file}" is not text in UTF-8.') from None
    try:
        lines = list(csv.reader(text.splitlines()))
    except csv.Error as error:
        raise InputError(f'"{file}" is not a CSV table: {error}.') from None
    headings = [cell.strip() for cell in lines[0]] if lines else []
    rows = [(i, row) for i, row in enumerate(lines[1:], start=2) if any(map(str.strip, row))]
    if not rows:
        raise InputError(f'"{file}" has no measurements.')
    if len(set(headings)) < len(headings):
        raise InputError(f'"{file}" has a column twice.')
    return headings, rows


def _numbers(row: list[str], headings: list[str], file: FilePath, line: int) -> list[float]:
    if len(row) > len(headings):
        raise InputError(
            f'"{file}" has {len(row)} cells in line {line}: it has {len(headings)} columns.'
        )
    found = []
    for heading, cell in zip(headings, [*row, *[""] * (len(headings) - len(row))], strict=True):
        try:
            value = float(cell) if cell.strip() else np.nan
        except ValueError:
            value = np.inf
        if np.isinf(value):
            raise InputError(f'"{file}" has "{cell}" in line {line}, {heading}: write a number.')
        found.append(value)
    return found
