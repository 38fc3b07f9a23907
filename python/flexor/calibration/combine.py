"""From a targets file and a model to the variants that are fitted."""

from __future__ import annotations

import pathlib
from collections.abc import Mapping, Sequence
from itertools import accumulate, product

from flexor.calibration.constants import Constant, check_fields, full
from flexor.calibration.follow import PathRun, merged
from flexor.calibration.goal import Goal, bound, run_key
from flexor.calibration.schema import Option, TargetsFile
from flexor.calibration.system import System
from flexor.calibration.variant import Run, Variant
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
            raise InputError(f'{source}: choice "{choice.name}" has an {what}.')
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
                raise InputError(f"{place} has an {unknown_name('constant', name, known)}.")
            held[name] = known[name].held(value, f"{place}.{name}")
    if len(held) == len(known):
        raise InputError(f"{source}: its options hold every constant: leave one to be found.")
    return held


def _files(file: TargetsFile, main: Model, options: Mapping[str, Option], source: str) -> Files:
    """Load the models, the options' own in place of the file's, with the options' changes."""
    given = dict(file.models)
    if main.name in given:
        raise InputError(f'{source}: models has "{main.name}", the name of the model calibrated.')
    for choice, option in options.items():
        for name, other in option.models.items():
            if name not in given:
                place = f'{source}: choice "{choice}", option "{option.name}", models'
                raise InputError(f"{place} has an {unknown_name('model', name, given)}.")
            given[name] = other
    files = {main.name: main.file}
    for name, each in given.items():
        beside = pathlib.Path(source).parent / each.file
        try:
            files[name] = load(beside if beside.is_file() else each.file, changes=each.set).file
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
    goals, single, parts, keys = [], [], [], []
    for target in file.target:
        place = f'{source}: target "{target.name}"'
        name = main if target.model is None else target.model
        if name not in systems:
            raise InputError(f"{place}.model is the {unknown_name('model', name, systems)}.")
        goal, run, part = bound(target, systems[name], place)
        goals.append(goal)
        single.append(run)
        parts.append(part)
        keys.append((name, run_key(target)))
    joined: list[tuple[Run, dict[int, slice]]] = []
    for key in dict.fromkeys(keys):
        members = [i for i, each in enumerate(keys) if each == key]
        first, where = single[members[0]], {i: parts[i] for i in members}
        if isinstance(first, PathRun):
            # Paths are joined value by value; of an optimum all look at the same values.
            ends = list(accumulate((single[i].size for i in members), initial=0))
            where = {i: slice(*ends[n : n + 2]) for n, i in enumerate(members)}
            first = merged(
                [run for run in (single[i] for i in members) if isinstance(run, PathRun)]
            )
        joined.append((first, where))
    joined.sort(key=lambda entry: entry[0].cost)
    places = {
        i: (index, part) for index, (_, where) in enumerate(joined) for i, part in where.items()
    }
    return (
        tuple(goals),
        tuple(run for run, _ in joined),
        tuple(places[i] for i in range(len(goals))),
    )
