"""A calibration problem: models with free constants, the runs that observe them, and targets."""

from __future__ import annotations

import pathlib
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from flexor.arrays import Array
from flexor.calibration.constants import Constant, check_fields
from flexor.calibration.optimum_run import OptimumRun
from flexor.calibration.path_run import PathRun
from flexor.calibration.schema import TargetsFile
from flexor.calibration.system import System
from flexor.calibration.targets import BoundTarget, bind, run_key
from flexor.errors import InputError, unknown_name
from flexor.model import Model, load

Run = PathRun | OptimumRun


@dataclass(frozen=True, eq=False)
class Problem:
    """Models and their observables."""

    constants: tuple[Constant, ...]
    systems: Mapping[str, System]  # by name; the model that is calibrated first
    runs: tuple[Run, ...]  # cheap ones first
    targets: tuple[BoundTarget, ...]  # in the order of the file
    places: tuple[tuple[int, slice], ...]  # of each target: its run, and where in its values

    def __str__(self) -> str:
        return f'the calibration of "{next(iter(self.systems))}"'

    @cached_property
    def fitted_runs(self) -> tuple[int, ...]:
        """Runs that the fit needs, cheap ones first."""
        needed = {self.places[i][0] for i, target in enumerate(self.targets) if target.fitted}
        return tuple(sorted(needed))

    @cached_property
    def path_runs(self) -> tuple[int, ...]:
        """Fitted runs that are paths."""
        return tuple(run for run in self.fitted_runs if isinstance(self.runs[run], PathRun))

    @property
    def needs_optima(self) -> bool:
        """Whether the fit needs searches for optimal designs."""
        return self.path_runs != self.fitted_runs

    @cached_property
    def packages(self) -> set[str]:
        """Packages whose versions decide the results: SciPy fits, methods search for optima."""
        searches = [run.method for run in self.runs if isinstance(run, OptimumRun)]
        return {"scipy", *(name for each in searches for name in getattr(each, "packages", ()))}

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
    targets: list[BoundTarget] = []
    runs: dict[tuple[str, str], Run] = {}
    parts: list[tuple[tuple[str, str], slice]] = []
    for table in file.target:
        place = f'{source}: target "{table.name}"'
        name = main.name if table.model is None else table.model
        if name not in systems:
            raise InputError(f"{place}.model is the {unknown_name('model', name, systems)}.")
        target, run, part = bind(table, systems[name], place)
        key = name, run_key(table)
        shared = runs.setdefault(key, run)
        if shared is not run and isinstance(shared, PathRun) and isinstance(run, PathRun):
            # Targets of a path add values to it; those of an optimum share its values.
            part = slice(shared.size, shared.size + run.size)
            runs[key] = replace(shared, observed=shared.observed + run.observed)
        targets.append(target)
        parts.append((key, part))
    order = sorted(runs, key=lambda key: runs[key].cost)
    return Problem(
        constants=constants,
        systems=systems,
        runs=tuple(runs[key] for key in order),
        targets=tuple(targets),
        places=tuple((order.index(key), part) for key, part in parts),
    )
