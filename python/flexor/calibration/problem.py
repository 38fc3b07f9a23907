"""A calibration problem: models with free constants, the runs that observe them, and targets."""

from __future__ import annotations

import pathlib
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from itertools import accumulate

import numpy as np
from numpy.typing import NDArray

from flexor.calibration.constants import Constant, check_fields
from flexor.calibration.optimum_run import OptimumRun
from flexor.calibration.path_run import PathRun, merge
from flexor.calibration.schema import TargetsFile
from flexor.calibration.system import System
from flexor.calibration.targets import BoundTarget, bind, run_key
from flexor.errors import InputError, unknown_name
from flexor.model import Model, load

Array = NDArray[np.float64]
Run = PathRun | OptimumRun


@dataclass(frozen=True, eq=False)
class Problem:
    """Models, and what is observed of them.

    Attributes
    ----------
    constants : tuple of Constant
        The c constants to be fitted.
    systems : dict of System
        By the model's name; the model that is calibrated first.
    runs : tuple of PathRun or OptimumRun
        Cheap ones first.
    targets : tuple of BoundTarget
        In the order of the file.
    places : tuple of (int, slice)
        For each target its run, and where in the run's values it is.
    """

    constants: tuple[Constant, ...]
    systems: Mapping[str, System]
    runs: tuple[Run, ...]
    targets: tuple[BoundTarget, ...]
    places: tuple[tuple[int, slice], ...]

    @cached_property
    def fitted_runs(self) -> tuple[int, ...]:
        """Runs that the fit needs, cheap ones first."""
        needed = {self.places[i][0] for i, target in enumerate(self.targets) if target.fitted}
        return tuple(sorted(needed))

    @cached_property
    def path_runs(self) -> tuple[int, ...]:
        """Those of the fitted runs that are paths."""
        return tuple(run for run in self.fitted_runs if isinstance(self.runs[run], PathRun))

    @property
    def needs_optima(self) -> bool:
        """Whether the fit needs searches for optimal designs."""
        return self.path_runs != self.fitted_runs

    def x(self, u: Array) -> Array:
        """Return constants (n, c), SI, of points (n, c) of the unit cube."""
        return np.stack([c.value(u[:, i]) for i, c in enumerate(self.constants)], axis=1)

    def of_run(self, run: int) -> list[tuple[BoundTarget, slice]]:
        """Return the fitted targets that a run serves, and where in its values."""
        return [
            (target, part)
            for target, (index, part) in zip(self.targets, self.places, strict=True)
            if index == run and target.fitted
        ]


def bind_problem(file: TargetsFile, main: Model, source: str) -> Problem:
    """Bind a targets file to the model that is calibrated.

    Relative models in the file are looked for beside it; `source` is its name.

    Raises
    ------
    InputError
        If something that the file names does not exist.
    """
    constants = tuple(Constant.of(table, source) for table in file.constant)
    if main.name in file.models:
        raise InputError(f'{source}: models has "{main.name}", the name of the model calibrated.')
    files = {main.name: main.file}
    for name, given in file.models.items():
        beside = pathlib.Path(source).parent / given.file
        try:
            files[name] = load(beside if beside.is_file() else given.file, changes=given.set).file
        except InputError as error:
            raise InputError(f"{source}: {error}") from None
    check_fields(constants, files, source)
    systems = {name: System(name, each, constants, source) for name, each in files.items()}
    for system in systems.values():
        system.check_ranges()
    return _bound(file, constants, systems, main.name, source)


def _bound(
    file: TargetsFile,
    constants: tuple[Constant, ...],
    systems: Mapping[str, System],
    main: str,
    source: str,
) -> Problem:
    """Bind the targets, and merge runs of one model, design and loads."""
    targets, single, parts, keys = [], [], [], []
    for table in file.target:
        place = f'{source}: target "{table.name}"'
        name = main if table.model is None else table.model
        if name not in systems:
            raise InputError(f"{place}.model is the {unknown_name('model', name, systems)}.")
        target, run, part = bind(table, systems[name], place)
        targets.append(target)
        single.append(run)
        parts.append(part)
        keys.append((name, run_key(table)))
    joined: list[tuple[Run, dict[int, slice]]] = []
    for key in dict.fromkeys(keys):
        members = [i for i, each in enumerate(keys) if each == key]
        first, where = single[members[0]], {i: parts[i] for i in members}
        if isinstance(first, PathRun):
            # Paths are merged value by value; targets of an optimum share its values.
            ends = list(accumulate((single[i].size for i in members), initial=0))
            where = {i: slice(*ends[n : n + 2]) for n, i in enumerate(members)}
            first = merge([run for i in members if isinstance(run := single[i], PathRun)])
        joined.append((first, where))
    joined.sort(key=lambda entry: entry[0].cost)
    places = {
        i: (index, part) for index, (_, each) in enumerate(joined) for i, part in each.items()
    }
    return Problem(
        constants=constants,
        systems=systems,
        runs=tuple(run for run, _ in joined),
        targets=tuple(targets),
        places=tuple(places[i] for i in range(len(targets))),
    )
