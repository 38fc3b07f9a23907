"""Search: optimisers behind one interface, each in a file of its own."""

from __future__ import annotations

from flexor.search.catalogue import Entry, available, canonical, entries, method, names
from flexor.search.cma_es import CmaEs
from flexor.search.counted import BudgetSpent, Counted
from flexor.search.differential_evolution import DifferentialEvolution
from flexor.search.direct import Direct
from flexor.search.dual_annealing import DualAnnealing
from flexor.search.genetic_algorithm import GeneticAlgorithm
from flexor.search.grid import Grid, grid_axes, grid_designs
from flexor.search.interface import (
    BatchFunction,
    Budget,
    DifferentiableFunction,
    DifferentiableVectorFunction,
    Progress,
    ProgressCallback,
    Search,
    SearchResult,
    VectorFunction,
    uses_gradients,
)
from flexor.search.levenberg_marquardt import LevenbergMarquardt
from flexor.search.mads import Mads
from flexor.search.method import Method, Run
from flexor.search.multistart_bfgs import MultistartBfgs
from flexor.search.particle_swarm import ParticleSwarm
from flexor.search.pattern import PatternSearch
from flexor.search.polished_pattern import PolishedPattern
from flexor.search.starts import starting_designs
from flexor.search.surrogate import Surrogate

__all__ = [
    "BatchFunction",
    "Budget",
    "BudgetSpent",
    "CmaEs",
    "Counted",
    "DifferentiableFunction",
    "DifferentiableVectorFunction",
    "DifferentialEvolution",
    "Direct",
    "DualAnnealing",
    "Entry",
    "GeneticAlgorithm",
    "Grid",
    "LevenbergMarquardt",
    "Mads",
    "Method",
    "MultistartBfgs",
    "ParticleSwarm",
    "PatternSearch",
    "PolishedPattern",
    "Progress",
    "ProgressCallback",
    "Run",
    "Search",
    "SearchResult",
    "Surrogate",
    "VectorFunction",
    "available",
    "canonical",
    "entries",
    "grid_axes",
    "grid_designs",
    "method",
    "names",
    "starting_designs",
    "uses_gradients",
]
