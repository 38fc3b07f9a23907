"""Finding a search method by its name."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, fields
from typing import Any

from flexor.errors import InputError, shortened, unknown
from flexor.optimizers.cma_es import CmaEs
from flexor.optimizers.differential_evolution import DifferentialEvolution
from flexor.optimizers.direct import Direct
from flexor.optimizers.dual_annealing import DualAnnealing
from flexor.optimizers.extras import missing
from flexor.optimizers.genetic_algorithm import GeneticAlgorithm
from flexor.optimizers.grid import Grid
from flexor.optimizers.interface import Search
from flexor.optimizers.levenberg_marquardt import LevenbergMarquardt
from flexor.optimizers.mads import Mads
from flexor.optimizers.multistart_bfgs import MultistartBfgs
from flexor.optimizers.particle_swarm import ParticleSwarm
from flexor.optimizers.pattern import PatternSearch
from flexor.optimizers.polished_pattern import PolishedPattern
from flexor.optimizers.surrogate import Surrogate


@dataclass(frozen=True)
class Entry:
    """A method that is known by name.

    Attributes
    ----------
    recipe : type
        A frozen dataclass whose fields are the method's options.
    title : str
        As people write it, for figures and tables.
    aliases : tuple of str
        Other names for it.
    about : str
        What it is, in a line.
    """

    recipe: Callable[..., Search]
    title: str
    aliases: tuple[str, ...]
    about: str

    @property
    def options(self) -> dict[str, Any]:
        """Options and their defaults."""
        return {field.name: field.default for field in fields(self.recipe)}  # type: ignore[arg-type]


# One entry for each method.
_METHODS: dict[str, Entry] = {
    "pattern-search": Entry(
        PatternSearch, "pattern search", ("ps", "gps"), "the paper's PS: polls along every axis"
    ),
    "levenberg-marquardt": Entry(
        LevenbergMarquardt,
        "Levenberg-Marquardt",
        ("lm", "ls", "least-squares"),
        "the paper's LS: least squares on the objective's vector; local",
    ),
    "multistart-bfgs": Entry(
        MultistartBfgs,
        "multi-start BFGS",
        ("bfgs", "l-bfgs-b"),
        "quasi-Newton steps by the exact gradient, from several starts",
    ),
    "pattern-search+polish": Entry(
        PolishedPattern,
        "polished pattern search",
        ("ps+polish", "polish"),
        "pattern search on a coarse mesh, then descents by the exact gradient",
    ),
    "genetic-algorithm": Entry(
        GeneticAlgorithm, "genetic algorithm", ("ga",), "evolution by crossover and mutation"
    ),
    "differential-evolution": Entry(
        DifferentialEvolution, "differential evolution", ("de",), "evolution by differences"
    ),
    "particle-swarm": Entry(
        ParticleSwarm, "particle swarm", ("pso",), "a swarm drawn to the best it has found"
    ),
    "cma-es": Entry(
        CmaEs, "CMA-ES", ("cma", "cmaes"), "evolution that learns the valley, with restarts"
    ),
    "direct": Entry(Direct, "DIRECT", (), "divides the box into ever smaller ones; no chance"),
    "dual-annealing": Entry(
        DualAnnealing, "dual annealing", ("annealing", "da"), "annealing with local searches"
    ),
    "mads": Entry(Mads, "MADS", ("nomad",), "polls in ever more directions, quadratic models"),
    "surrogate": Entry(
        Surrogate, "surrogate (EGO)", ("ego", "bayesian"), "Bayesian, for expensive models"
    ),
    "grid": Entry(Grid, "grid", (), "every combination of evenly spaced values"),
}
_ALIASES = {alias: name for name, entry in _METHODS.items() for alias in entry.aliases}


def names() -> tuple[str, ...]:
    """Names that `method` knows, besides their aliases."""
    return tuple(_METHODS)


def entries() -> dict[str, Entry]:
    """Return what there is to know of each method, by name."""
    return dict(_METHODS)


def available() -> tuple[str, ...]:
    """Names of the methods whose libraries are installed."""
    return tuple(name for name in _METHODS if missing(name) is None)


def canonical(name: str) -> str:
    """Return the name of a method, given that or an alias of it in any spelling.

    Raises
    ------
    InputError
        If it is not known; the nearest is suggested.
    """
    plain = name.strip().casefold().replace("_", "-").replace(" ", "-")
    plain = _ALIASES.get(plain, plain)
    if plain not in _METHODS:
        raise unknown("method", name.strip(), _METHODS)
    return plain


def method(name: str, **options: Any) -> Search:
    """Make a search by its name.

    Parameters
    ----------
    name : str
        For example ``"pattern-search"``, or an alias such as ``"ps"``.
    **options
        The method's options, for example ``starts=8``.

    Returns
    -------
    Search
        The method with these options.

    Raises
    ------
    InputError
        If the method or an option is not known (the nearest is suggested), an option is not a
        number in its range, or the method's library is not installed.
    """
    plain = canonical(name)
    entry = _METHODS[plain]
    kinds = {option: type(default) for option, default in entry.options.items()}
    for option, value in options.items():
        if option not in kinds:
            raise unknown(f"option of {plain}", option, kinds)
        options[option] = _read(plain, option, value, kinds[option])
    return entry.recipe(**options)


def _read(method: str, option: str, value: Any, wanted: type) -> Any:
    refused = f"option {option} of {method} must be"
    got = f"got {shortened(repr(value))}."
    if wanted is tuple:
        if isinstance(value, (list, tuple)):
            return tuple(value)
        raise InputError(f"{refused} a list, {got}")
    if wanted is bool:
        if value in (0, 1):
            return bool(value)
        raise InputError(f"{refused} 1 (yes) or 0 (no), {got}")
    number = isinstance(value, (int, float)) and not isinstance(value, bool)
    if number and wanted is int:
        number = isinstance(value, int) or value.is_integer()  # infinities and NaN are not
    if not number:
        raise InputError(f"{refused} {'a whole number' if wanted is int else 'a number'}, {got}")
    return wanted(value)
