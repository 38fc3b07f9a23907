"""A model: a checked file and the engine built from it."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Mapping, Sequence
from functools import cached_property
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from flexor.arrays import Array
from flexor.display import Displayed
from flexor.errors import InputError
from flexor.model.derivatives import Derivatives, Differential, differentiate
from flexor.model.follow import follow as follow_loads
from flexor.model.follow import follow_branch
from flexor.model.geometry import Geometry, SlotValues
from flexor.model.loads import Forces, loads
from flexor.model.obstacle_passages import warn_about_passages
from flexor.model.reading import parse
from flexor.model.results import Path, Paths
from flexor.model.schema import ModelFile
from flexor.model.solver import solver_options
from flexor.model.start import Start, coordinates, read_start
from flexor.model.structure import Structure
from flexor.model.validation import describe
from flexor.model.written import Written

Force = Forces | Mapping[str, Forces]


class Model(Displayed, Structure):
    """A system of rods, links, contacts and actuators, built once and never changed.

    Parameters
    ----------
    file
        The checked model file.
    source
        Where it came from, for messages.
    written
        The text of the file, as its author wrote it.

    Raises
    ------
    InputError
        If the engine refuses the model.
    """

    def __init__(
        self, file: ModelFile, source: str | None = None, written: Written | None = None
    ) -> None:
        super().__init__(file, source)
        self.written = written
        try:
            self._start = Start(coordinates(file.start, self)) if file.start else None
            self._solver = solver_options(file.solver)
            if file.evaluation.loads:
                self._loads(None)
        except InputError as error:
            raise InputError(f"{source or file.name}: {error}") from None

    def __reduce__(self) -> tuple[Callable[[str, str], Model], tuple[str, str]]:
        # A few kilobytes of text, from which another process builds its own engine.
        return rebuilt, (self.file.to_toml(), self.hash)

    def __repr__(self) -> str:
        return f"<Model {self.name!r}: {self.dof} degrees of freedom, {self.hash[:12]}>"

    def to_toml(self) -> str:
        """Return the model as a model file.

        Where it was read from a file, this is the text of that file, comments and units included,
        with what has changed in its place; otherwise every value, as ``file.to_toml()``.
        """
        return self.file.to_toml() if self.written is None else self.written.toml(self.file)

    @cached_property
    def hash(self) -> str:
        """SHA-256 of its description for the engine, its start and its solver options."""
        found = hashlib.sha256(self._description.encode())
        if self._start is not None:
            found.update(self._start.q.tobytes())
        if self._solver:
            found.update(json.dumps(self._solver, sort_keys=True).encode())
        return found.hexdigest()

    def evaluate(
        self,
        geometry: Geometry | SlotValues,
        force: Force | None = None,
        threads: int = 0,
        *,
        gradient: bool = False,
        start: Any = None,
        **options: float,
    ) -> Paths:
        """Follow the equilibria of many designs, in parallel.

        Memory is what the `Paths` hold: 8 bytes for each design, step and degree of freedom, and
        a little more.

        Parameters
        ----------
        geometry
            Geometry of n designs at the points `X`, or values of the engine's parameters.
        force
            As for `equilibrium`, or those of each design in an array (n, steps, inputs).
        threads
            How many; 0 for one per core. Results do not depend on it.
        gradient
            Whether to differentiate the joints' coordinates and the tip force at the last step,
            exactly, with respect to the geometry: `Paths.gradient` and `Paths.regularity`, and
            `Paths.chained` with respect to the parameters of a set.
        start
            As for `equilibrium`.
        **options
            Settings of the engine's solver (`flexor._engine.SOLVER_OPTIONS`), such as
            ``max_seconds`` for each load step, in place of those of the file's ``[solver]``.

        Raises
        ------
        InputError
            If forces, geometry or options cannot be used.
        """
        batch, begin, loads = self._designs(geometry), self._begin(start), self._loads(force)
        return follow_loads(self, batch, loads, threads, self._options(options), gradient, begin)

    @property
    def own_design(self) -> SlotValues:
        """The model as it is, as one design for `evaluate`."""
        return SlotValues(np.zeros(0, dtype=np.intp), np.zeros((1, 0)))

    def equilibrium(
        self,
        force: Force | None = None,
        design: Geometry | SlotValues | None = None,
        *,
        start: Any = None,
        follow: Literal["load", "arc-length"] = "load",
        **options: float,
    ) -> Path:
        """Follow the equilibrium (9) through the given loads.

        Parameters
        ----------
        force
            Forces in N, texts with a unit, ``"start:stop:step"``, or a table of these by the name
            of the input; or an array (steps, inputs). They may rise, fall and be negative; the path
            starts without load even if its first force is not zero. Unless given, those of the
            file's ``[evaluation]``; no load if it has none for several inputs.
        design
            Geometry of the designed rod (n = 1), or values of the engine's parameters; the file's
            own unless given.
        start
            Where the path begins: a `State` or a `Path` (its last step), under the loads of that
            state; the name of a file that ``flexor simulate --json`` printed, likewise; or, without
            load, coordinates by name such as ``{"ph_1": "20 deg", "exosuit.bend_y": "90 deg"}``.
            The file's ``[start]`` unless given, and otherwise the reference state. The path's first
            equilibrium is the one that the energy leads to from there.
        follow
            ``"load"`` follows stable equilibria from load to load and jumps where they end.
            ``"arc-length"`` follows one branch through its limit points, stable or not, until it
            reaches the last load: the steps of the path are the points it takes, limit points and
            all equilibria at the given loads among them, with the loads found there.
        **options
            Settings of the engine's solver (`flexor._engine.SOLVER_OPTIONS`), such as
            ``max_seconds`` for each load step, in place of those of the file's ``[solver]``.

        Raises
        ------
        InputError
            If forces, geometry or options cannot be used.
        """
        batch = None if design is None else self._designs(design)
        if batch is not None and len(batch) != 1:
            raise InputError(f"design has {len(batch)} designs: give one, or use Model.evaluate.")
        begin, loads = self._begin(start), self._loads(force)
        if follow == "arc-length":
            return follow_branch(self, batch, loads, self._options(options), begin)[0]
        if follow != "load":
            raise InputError(f'follow is {describe(follow)}: expected "load" or "arc-length".')
        path = follow_loads(self, batch, loads, 1, self._options(options), start=begin)[0]
        warn_about_passages(path, np.zeros(self.engine.dof) if begin is None else begin.q)
        return path

    def differentiate(
        self,
        paths: Paths,
        rows: Sequence[Differential],
        slots: NDArray[np.intp],
        threads: int = 0,
    ) -> Derivatives:
        """Differentiate numbers of paths of designs; see `flexor.model.derivatives`."""
        return differentiate(paths, rows, slots, threads)

    def _designs(self, given: Geometry | SlotValues) -> Geometry | SlotValues:
        return given if isinstance(given, SlotValues) else self.design.checked(given)

    def _begin(self, start: Any) -> Start | None:
        return self._start if start is None else read_start(start, self)

    def _options(self, given: Mapping[str, float]) -> dict[str, float]:
        return {**self._solver, **given}

    def _loads(self, force: Force | None) -> Array:
        if isinstance(force, np.ndarray) and force.ndim == 3 and np.isfinite(force).all():
            return force
        if force is not None:
            return loads(force, self.input_dimensions)
        if len(self.inputs) != 1 and not self.file.evaluation.loads:
            return np.zeros((1, len(self.inputs)))
        return self.evaluation_loads


def rebuilt(text: str, hash: str) -> Model:
    """Rebuild a pickled model, and check that it is the same."""
    model = Model(parse(text))
    if model.hash != hash:
        raise InputError(
            f'the model "{model.name}" was made by another version of Flexor: its description has '
            f"the hash {hash[:12]} there and {model.hash[:12]} here."
        )
    return model
