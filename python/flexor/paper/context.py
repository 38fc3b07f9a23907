"""What every item of the study works with: models, settings, the folder, and who is told."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from flexor.design import Geometry, parameter_set
from flexor.model import load
from flexor.objectives import objective as named_objective
from flexor.paper.folder import Data, Folder, Part
from flexor.paper.settings import Settings
from flexor.study import Executor, Problem

if TYPE_CHECKING:
    from flexor.model import Model, Path

Array = NDArray[np.float64]

FINGER, TWO_LINKS, ALONE = "finger", "finger-2-links", "exosuit-alone"


@dataclass(frozen=True)
class Doing:
    """What a running reproduction is at.

    Attributes
    ----------
    item : str
        Name of the item.
    what : str
        In words.
    share : float or None
        Part of that which is done; None if it cannot be told.
    """

    item: str
    what: str
    share: float | None = None


Told = Callable[[Doing], None]


@dataclass(eq=False)
class Context:
    """What the items share.

    Attributes
    ----------
    settings : Settings
        What decides the numbers.
    folder : Folder
        Where parts are kept.
    told : callable
        Told what is being done.
    item : str
        Name of the item at work.
    executor : Executor or None
        Where designs are evaluated; in this process by default.
    prefix : str
        What the names of its parts begin with.
    """

    settings: Settings
    folder: Folder
    told: Told
    item: str = ""
    executor: Executor | None = None
    prefix: str = ""
    _models: dict[tuple[str, str], Model] = field(default_factory=dict, repr=False)

    def using(self, constants: str) -> Context:
        """Return the same study with another set of constants, its parts kept apart."""
        if constants == self.settings.constants:
            return self
        settings = replace(self.settings, constants=constants)
        return replace(self, settings=settings, prefix=f"{constants}-", _models=self._models)

    def model(self, name: str = FINGER, constants: str | None = None) -> Model:
        """Return a shipped model with the settings' constants, or with others."""
        key = name, constants or self.settings.constants
        if key not in self._models:
            self._models[key] = load(key[0], constants=key[1])
        return self._models[key]

    def problem(self, parameters: str, objective: str = "bending") -> Problem:
        """Return a problem of the paper: a parameter set and an objective on the finger."""
        model = self.model()
        chosen = parameter_set(parameters, model.design)
        return Problem(model, chosen, named_objective(objective))

    def path(self, problem: Problem, design: Array | None, force: Array | None = None) -> Path:
        """Follow a design (k,), the model's own if None, to the problem's loads or others [N]."""
        loads = problem.force if force is None else force
        geometry: Geometry | None = None
        if design is not None:
            geometry = problem.geometry(np.asarray(design, dtype=np.float64)[None, :])
        return problem.model.equilibrium(loads, design=geometry)

    def part(self, name: str, compute: Callable[[], Data]) -> Part:
        """Return a part of the computation, kept in the folder; see `Folder.part`."""
        return self.folder.part(self.prefix + name, compute)

    def say(self, what: str, share: float | None = None) -> None:
        """Tell what is being done."""
        if self.prefix:
            what = f"{what} ({self.settings.constants})"
        self.told(Doing(self.item, what, share))
