"""Observables: quantities of paths by name, with their units and gradients."""

from __future__ import annotations

from flexor.observables.catalogue import kinds, observable, observables
from flexor.observables.observable import Observable

__all__ = ["Observable", "kinds", "observable", "observables"]
