"""Scenarios: variants, tolerances and wearers under which designs are evaluated."""

from __future__ import annotations

from flexor.scenarios.aggregate import Aggregate, aggregate
from flexor.scenarios.population import wearer, wearers
from flexor.scenarios.scenario import Scenario, scenarios
from flexor.scenarios.stated import tolerances
from flexor.scenarios.tolerance import Tolerance

__all__ = [
    "Aggregate",
    "Scenario",
    "Tolerance",
    "aggregate",
    "scenarios",
    "tolerances",
    "wearer",
    "wearers",
]
