"""From a targets file and a model to the variants that are fitted."""

from __future__ import annotations

import pathlib
from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import product

from flexor.calibrate.constants import Constant, check_fields, full
from flexor.calibrate.follow import PathRun, merged
from flexor.calibrate.goal import Goal, bound, run_key
from flexor.calibrate.optimum import OptimumRun
from flexor.calibrate.schema import Option, TargetsFile
from flexor.calibrate.system import System
from flexor.calibrate.variant import Run, Variant
from flexor.errors import InputError, unknown_name
from flexor.model import Model, ModelFile, load

Files = dict[str, ModelFile]


def variants(
    file: TargetsFile, main: Model, source: str, chosen: Mapping[str, str] | None = None
) -> tuple[Variant, ...]:
    """Make every combination of options.

    Parameters
    ----------
    file
        A targets file.
    main
        The model that is calibrated.
    source
        The targets file's name, for messages; its relative models are looked for beside it.
    chosen
        Options by choice, where not all are wanted.

    Raises
    ------
    InputError
        If something that the file names is not there.
    """
    constants = tuple(Constant.of(table, source) for table in file.constant)
    made = []
    for options in product(*_wanted(file, source, chosen or {})):
        taken = {choice.name: option for choice, option in zip(file.choice, options, strict=True)}
        held = _held(constants, taken, source)
        files = _files(file, main, taken, source)
        check_fields(constants, files, source)
        systems = {
            name: System(name, each, constants, held, source) for name, each in files.items()
        }
        for system in systems.values():
            system.check_ranges()
        goals, runs, places = _goals(file, systems, main.name, source)
        named = {choice: option.name for choice, option in taken.items()}
        made.append(Variant(named, constants, held, systems, runs, goals, places))
    return tuple(made)


def _wanted(file: TargetsFile, source: str, chosen: Mapping[str, str]) -> list[tuple[Option, ...]]:
    names = [choice.name for choice in file.choice]
    for name in chosen:
        if name not in names:
            raise InputError(f"{source}: {unknown_name('choice', name, names)}.")
    wanted: list[tuple[Option, ...]] = []
    for choice in file.choice:
        options = {option.name: option for option in choice.option}
        if choice.name not in chosen:
            wanted.append(choice.option)
            continue
        name = chosen[choice.name]
        if name not in options:
            what = unknown_name("option", name, options)
            raise InputError(f'{source}: choice "{choice.name}" has the {what}.')
        wanted.append((options[name],))
    return wanted


def _held(
    constants: Sequence[Constant], options: Mapping[str, Option], source: str
) -> dict[str, float]:
    known = {constant.name: constant for constant in constants}
    held = {}
    for choice, option in options.items():
        place = f'{source}: choice "{choice}", option "{option.name}", hold'
        for name, value in option.hold.items():
            if name not in known:
                raise InputError(f"{place} has the {unknown_name('constant', name, known)}.")
            held[name] = known[name].held(value, f"{place}.{name}")
    if len(held) == len(known):
        raise InputError(f"{source}: its options hold every constant: leave one to be found.")
    return held


def _files(file: TargetsFile, main: Model, options: Mapping[str, Option], source: str) -> Files:
    """Load the models, the options' own in place of the file's, with the options' changes."""
    paths = dict(file.models)
    if main.name in paths:
        raise InputError(f'{source}: models has "{main.name}", the name of the model calibrated.')
    for choice, option in options.items():
        for name, path in option.models.items():
            if name not in paths:
                place = f'{source}: choice "{choice}", option "{option.name}", models'
                raise InputError(f"{place} has the {unknown_name('model', name, paths)}.")
            paths[name] = path
    files = {main.name: main.file}
    for name, path in paths.items():
        beside = pathlib.Path(source).parent / path
        try:
            files[name] = load(beside if beside.is_file() else path).file
        except InputError as error:
            raise InputError(f"{source}: {error}") from None
    return {name: _changed(name, files, options, source) for name in files}


def _changed(name: str, files: Files, options: Mapping[str, Option], source: str) -> ModelFile:
    """Put the options' values into the fields of one model, as far as it has them."""
    changes: dict[str, object] = {}
    for choice, option in options.items():
        for field, value in option.set.items():
            if all(full(field, each) is None for each in files.values()):
                bodies = ", ".join(dict.fromkeys(b for f in files.values() for b in f.bodies))
                place = f'{source}: choice "{choice}", option "{option.name}", set'
                raise InputError(f"{place}: no model has {field} (their bodies are {bodies}).")
            if full(field, files[name]) is not None:
                changes[field] = value
    try:
        return load(files[name], changes=changes).file if changes else files[name]
    except InputError as error:
        raise InputError(f"{source}: {error}") from None


def _goals(
    file: TargetsFile, systems: Mapping[str, System], main: str, source: str
) -> tuple[tuple[Goal, ...], tuple[Run, ...], tuple[tuple[int, slice], ...]]:
    """Bind the targets, and join the runs that are one."""
    goals, single, keys = [], [], []
    for target in file.target:
        place = f'{source}: target "{target.name}"'
        name = main if target.model is None else target.model
        if name not in systems:
            raise InputError(f"{place}.model is the {unknown_name('model', name, systems)}.")
        goal, run = bound(target, systems[name], place)
        goals.append(goal)
        single.append(run)
        # What is fitted and what is only predicted never share an optimum, which is dear.
        keys.append((not goal.fitted, name, run_key(target)))
    joined: list[tuple[Run, list[int]]] = []
    for key in dict.fromkeys(keys):
        members = [i for i, each in enumerate(keys) if each == key]
        joined.append((_joined([single[i] for i in members]), members))
    joined.sort(key=lambda entry: entry[0].cost)
    places: dict[int, tuple[int, slice]] = {}
    for index, (_, members) in enumerate(joined):
        first = 0
        for i in members:
            places[i] = (index, slice(first, first + single[i].size))
            first += single[i].size
    runs = tuple(run for run, _ in joined)
    return tuple(goals), runs, tuple(places[i] for i in range(len(goals)))


def _joined(runs: Sequence[Run]) -> Run:
    first = runs[0]
    if isinstance(first, PathRun):
        return merged([run for run in runs if isinstance(run, PathRun)])
    assert isinstance(first, OptimumRun)
    observed = [part for run in runs if isinstance(run, OptimumRun) for part in run.observed]
    return replace(first, observed=tuple(observed))
