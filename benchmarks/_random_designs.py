"""Reproducible random designs."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from flexor.design import Geometry, parameter_set
from flexor.model import Model


def random_vectors(model: Model, count: int, seed: int = 1) -> NDArray[np.float64]:
    """Draw designs of L+R01 from the whole of the search bounds, (count, 3) [m]."""
    chosen = parameter_set("L+R01", model.design)
    unit = np.random.default_rng(seed).uniform(size=(count, chosen.size))
    return chosen.lower + unit * (chosen.upper - chosen.lower)


def geometry(model: Model, vectors: NDArray[np.float64]) -> Geometry:
    """Geometry of designs of L+R01."""
    return parameter_set("L+R01", model.design).geometry(vectors, model.X)


def random_designs(model: Model, count: int, seed: int = 1) -> Geometry:
    """Geometry of random designs."""
    return geometry(model, random_vectors(model, count, seed))
