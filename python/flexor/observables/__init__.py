"""Observables: quantities of paths by name, with their units and gradients."""

from __future__ import annotations

from flexor.observables.catalogue import custom, kinds, observable, observables
from flexor.observables.observable import Observable

__all__ = ["Observable", "custom", "kinds", "observable", "observables"]
