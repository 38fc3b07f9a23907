"""Tensile tests: reading them from CSV files."""

from __future__ import annotations

import csv
import math
import os
import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from flexor.arrays import Array
from flexor.errors import InputError, shortened

_MAX_BYTES = 10_000_000
_STRESS_UNITS = {
    "pa": 1.0,
    "kpa": 1e3,
    "mpa": 1e6,
    "gpa": 1e9,
    "n/mm^2": 1e6,
    "n/mm2": 1e6,
    "psi": 6894.757293168361,
}
_STRAIN_UNITS = {"": 1.0, "-": 1.0, "mm/mm": 1.0, "m/m": 1.0, "%": 0.01, "percent": 0.01}
_COLUMNS = (
    'expected a column "strain" or "stretch" and a column "stress" with a unit, such as '
    '"strain (%)" and "stress (kPa)"'
)


@dataclass(frozen=True)
class TensileTest:
    """A specimen pulled once.

    Parameters
    ----------
    name
        Of the specimen, for messages and legends.
    stretch : (n,) array
        λ, increasing.
    stress : (n,) array
        Nominal stress (force per unstrained area) [Pa].
    """

    name: str
    stretch: Array
    stress: Array


@dataclass(frozen=True)
class _Column:
    index: int
    factor: float
    true: bool
    stretch: bool = False


def read_test(path: str | os.PathLike[str]) -> TensileTest:
    """Read a tensile test from a CSV file.

    Parameters
    ----------
    path
        Comma, semicolon or tab separated. The first line that names a strain (or stretch) and a
        stress is the header; lines before it are skipped. The unit stands in parentheses or
        brackets, or after an underscore: ``strain (%)``, ``stress [MPa]``, ``stress_kPa``; a strain
        without a unit is a number. ``true strain`` and ``true stress`` are converted, and used only
        if there are no engineering values. Loading is read up to the largest stress.

    Raises
    ------
    InputError
        If the file cannot be read, or has no such columns or fewer than five valid rows.
    """
    path = Path(path)
    try:
        if path.exists() and not path.is_file():
            raise InputError(f'"{path}" is not a file: expected the CSV file of a tensile test.')
        if path.stat().st_size > _MAX_BYTES:
            raise InputError(f'"{path}" has more than {_MAX_BYTES // 1_000_000} MB.')
        text = path.read_text(encoding="utf-8-sig")
    except UnicodeDecodeError:
        raise InputError(f'"{path}" is not a text file in UTF-8.') from None
    except OSError as error:
        reason = (error.strerror or str(error)).lower()
        raise InputError(f'cannot read the tensile test "{path}": {reason}.') from None
    lines = iter(enumerate(text.splitlines(), 1))
    for _, line in lines:
        delimiter = next((each for each in ";\t" if each in line), ",")
        cells = next(csv.reader([line], delimiter=delimiter), [])
        strain, stress = _strain_column(cells, path), _stress_column(cells, path)
        if strain is not None and stress is not None:
            break
    else:
        raise InputError(f'"{path}" has no header of a tensile test: {_COLUMNS}.')
    values = []
    for number, line in lines:
        row = next(csv.reader([line], delimiter=delimiter), [])
        if any(cell.strip() for cell in row):
            values.append([_number(row, column.index, path, number) for column in (strain, stress)])
    if len(values) < 5:
        raise InputError(f'"{path}" has {len(values)} rows of values: expected at least 5.')
    first, second = np.array(values).T * [[strain.factor], [stress.factor]]
    stretch = np.exp(first) if strain.true else first + (0.0 if strain.stretch else 1.0)
    nominal = second / stretch if stress.true else second
    return _loading(path, stretch, nominal)


def _loading(path: Path, stretch: Array, stress: Array) -> TensileTest:
    end = int(np.argmax(stress)) + 1
    stretch, stress = stretch[:end], stress[:end]
    keep = stretch > np.maximum.accumulate(np.concatenate([[0.0], stretch[:-1]]))
    stretch, stress = stretch[keep], stress[keep]
    if stretch.size < 5 or stretch[0] <= 0.0 or stress[-1] <= 0.0 or stretch[-1] <= 1.0:
        raise InputError(
            f'"{path}" is no tensile test: expected a strain that increases to a positive stress.'
        )
    return TensileTest(path.stem, stretch, stress)


def _number(row: Sequence[str], index: int, path: Path, line: int) -> float:
    cell = row[index].strip() if index < len(row) else ""
    try:
        value = float(cell)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise InputError(f'"{path}", line {line}: expected a number, found "{shortened(cell)}".')
    return value


def _split(cell: str) -> tuple[str, str]:
    """Return the words of a heading, and its unit."""
    name = cell.strip().lower()
    unit = re.search(r"[(\[]\s*([^)\]]*?)\s*[)\]]\s*$", name)
    if unit:
        return name[: unit.start()].strip(), unit.group(1)
    known = "|".join(map(re.escape, (*_STRESS_UNITS, "%", "percent")))
    tail = re.search(rf"[_ /]({known})$", name)
    return (name[: tail.start()], tail.group(1)) if tail else (name, "")


def _strain_column(cells: Sequence[str], path: Path) -> _Column | None:
    found = []
    for index, cell in enumerate(cells):
        name, unit = _split(cell)
        if "strain" in name or "stretch" in name:
            stretch = "stretch" in name
            if unit not in _STRAIN_UNITS or (stretch and _STRAIN_UNITS[unit] != 1.0):
                allowed = ", ".join(f'"{each}"' for each in _STRAIN_UNITS if each)
                raise InputError(
                    f'"{path}" has the column "{shortened(cell.strip())}" with the unit '
                    f'"{shortened(unit)}": expected none or one of {allowed}.'
                )
            found.append(_Column(index, _STRAIN_UNITS[unit], "true" in name, stretch))
    return min(found, key=lambda column: column.true, default=None)


def _stress_column(cells: Sequence[str], path: Path) -> _Column | None:
    found = []
    for index, cell in enumerate(cells):
        name, unit = _split(cell)
        if "stress" in name:
            if unit not in _STRESS_UNITS:
                raise InputError(
                    f'"{path}" has the column "{shortened(cell.strip())}": expected a stress with '
                    'a unit, such as "stress (kPa)", one of Pa, kPa, MPa, GPa, N/mm^2 and psi.'
                )
            found.append(_Column(index, _STRESS_UNITS[unit], "true" in name))
    return min(found, key=lambda column: column.true, default=None)
