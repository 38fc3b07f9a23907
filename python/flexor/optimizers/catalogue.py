"""Registry of the search methods."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, fields
from typing import Any

from flexor.errors import InputError, shortened, unknown
from flexor.optimizers.auto import Auto
from flexor.optimizers.cma_es import CmaEs
from flexor.optimizers.direct import Direct
from flexor.optimizers.dual_annealing import DualAnnealing
from flexor.optimizers.extras import missing_package
from flexor.optimizers.grid import Grid
from flexor.optimizers.interface import Search
from flexor.optimizers.levenberg_marquardt import LevenbergMarquardt
from flexor.optimizers.mads import Mads
from flexor.optimizers.multistart_bfgs import MultistartBfgs
from flexor.optimizers.pareto import Pareto
from flexor.optimizers.pattern import PatternSearch
from flexor.optimizers.polished_pattern import PolishedPattern
from flexor.optimizers.population import DifferentialEvolution, GeneticAlgorithm, ParticleSwarm
from flexor.optimizers.surrogate import Surrogate


@dataclass(frozen=True)
class Entry:
    """A registered method."""

    factory: Callable[..., Search]  # a frozen dataclass whose fields are the method's options
    title: str  # for figures and tables
    aliases: tuple[str, ...]
    description: str  # in one line

    @property
    def options(self) -> dict[str, Any]:
        """Options and their defaults."""
        return {field.name: field.default for field in fields(self.factory)}  # type: ignore[arg-type]


_CLASSES = (
    PatternSearch,
    Auto,
    LevenbergMarquardt,
    MultistartBfgs,
    PolishedPattern,
    GeneticAlgorithm,
    DifferentialEvolution,
    ParticleSwarm,
    CmaEs,
    Direct,
    DualAnnealing,
    Mads,
    Surrogate,
    Pareto,
    Grid,
)
_METHODS = {each.name: Entry(each, each.title, each.aliases, each.description) for each in _CLASSES}
_ALIASES = {alias: name for name, entry in _METHODS.items() for alias in entry.aliases}


def names() -> tuple[str, ...]:
    """Return the names of the methods, without aliases."""
    return tuple(_METHODS)


def entries() -> dict[str, Entry]:
    """Return the registered methods by name."""
    return dict(_METHODS)


def available() -> tuple[str, ...]:
    """Return the names of the methods whose libraries are installed."""
    return tuple(name for name in _METHODS if missing_package(name) is None)


def canonical(name: str) -> str:
    """Return the canonical name of a method, given its name or an alias.

    Case, underscores and spaces are ignored. InputError, with the closest match, if it is unknown.
    """
    key = name.strip().casefold().replace("_", "-").replace(" ", "-")
    key = _ALIASES.get(key, key)
    if key not in _METHODS:
        raise unknown("method", name.strip(), _METHODS)
    return key


def method(name: str, **options: Any) -> Search:
    """Construct a search method by name.

    Parameters
    ----------
    name : str
        For example ``"pattern-search"``, or an alias such as ``"ps"``.
    **options
        Options of the method, for example ``starts=8``.

    Returns
    -------
    Search
        The method with these options.

    Raises
    ------
    InputError
        If the method or an option is unknown (the closest match is suggested), an option is
        invalid, or the method's library is not installed.
    """
    key = canonical(name)
    entry = _METHODS[key]
    types = {option: type(default) for option, default in entry.options.items()}
    for option, value in options.items():
        if option not in types:
            raise unknown(f"option of {key}", option, types)
        options[option] = _convert_option(key, option, value, types[option])
    return entry.factory(**options)


def _convert_option(method: str, option: str, value: Any, target: type) -> Any:
    prefix = f"option {option} of {method} must be"
    got = f"got {shortened(repr(value))}."
    if target is tuple:
        if isinstance(value, (list, tuple)):
            return tuple(value)
        raise InputError(f"{prefix} a list, {got}")
    if target is bool:
        if value in (0, 1):
            return bool(value)
        raise InputError(f"{prefix} 1 (yes) or 0 (no), {got}")
    valid = isinstance(value, (int, float)) and not isinstance(value, bool)
    if valid and target is int:
        valid = isinstance(value, int) or value.is_integer()  # infinities and NaN are not
    if not valid:
        raise InputError(f"{prefix} {'an integer' if target is int else 'a number'}, {got}")
    return target(value)
