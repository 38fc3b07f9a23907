"""Optimisers with a common interface, one per file."""

from __future__ import annotations

from flexor.optimizers.auto import Auto
from flexor.optimizers.budgeted_evaluator import BudgetedEvaluator, BudgetExhausted
from flexor.optimizers.cached_evaluator import CachedEvaluator
from flexor.optimizers.catalogue import Entry, available, canonical, entries, method, names
from flexor.optimizers.cma_es import CmaEs
from flexor.optimizers.direct import Direct
from flexor.optimizers.dual_annealing import DualAnnealing
from flexor.optimizers.grid import Grid, grid_axes, grid_designs
from flexor.optimizers.interface import (
    BatchFunction,
    Budget,
    DifferentiableFunction,
    DifferentiableVectorFunction,
    Progress,
    ProgressCallback,
    Search,
    SearchResult,
    SeveralFunction,
    VectorFunction,
    takes_several,
    uses_gradients,
)
from flexor.optimizers.levenberg_marquardt import LevenbergMarquardt
from flexor.optimizers.mads import Mads
from flexor.optimizers.method import Method, Run
from flexor.optimizers.multistart_bfgs import MultistartBfgs
from flexor.optimizers.pareto import Pareto, nondominated
from flexor.optimizers.pattern import PatternSearch
from flexor.optimizers.polished_pattern import PolishedPattern
from flexor.optimizers.population import DifferentialEvolution, GeneticAlgorithm, ParticleSwarm
from flexor.optimizers.starts import starting_designs
from flexor.optimizers.surrogate import Surrogate

__all__ = [
    "Auto",
    "BatchFunction",
    "Budget",
    "BudgetExhausted",
    "BudgetedEvaluator",
    "CachedEvaluator",
    "CmaEs",
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
    "Pareto",
    "ParticleSwarm",
    "PatternSearch",
    "PolishedPattern",
    "Progress",
    "ProgressCallback",
    "Run",
    "Search",
    "SearchResult",
    "SeveralFunction",
    "Surrogate",
    "VectorFunction",
    "available",
    "canonical",
    "entries",
    "grid_axes",
    "grid_designs",
    "method",
    "names",
    "nondominated",
    "starting_designs",
    "takes_several",
    "uses_gradients",
]
