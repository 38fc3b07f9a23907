"""The interface of the search methods."""

from __future__ import annotations

from collections.abc import Callable, Generator
from dataclasses import dataclass
from typing import Protocol, runtime_checkable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from flexor.arguments import integer
from flexor.errors import InputError

FloatArray = NDArray[np.float64]

# Maps n designs (n, k) to their values (n,); +inf for designs that fail.
BatchFunction = Callable[[FloatArray], FloatArray]


class _Values(Protocol):
    def __call__(self, designs: FloatArray) -> FloatArray:
        """Map n designs (n, k) to their values (n,); +inf for designs that fail."""
        ...


@runtime_checkable
class VectorFunction(_Values, Protocol):
    """A batch function whose value is the norm of a residual vector, for least squares."""

    def residuals(self, designs: FloatArray) -> FloatArray:
        """Map n designs (n, k) to their residual vectors (n, r); NaN for designs that fail.

        InputError if the objective is not the norm of a vector.
        """
        ...


@runtime_checkable
class DifferentiableVectorFunction(VectorFunction, Protocol):
    """A vector function with an exact Jacobian; without one, methods use finite differences."""

    def jacobian(self, designs: FloatArray) -> FloatArray | None:
        """Map n designs (n, k) to their Jacobians (n, r, k); NaN for designs that fail.

        Called only for designs whose vectors have been evaluated. None if not available.
        """
        ...


@runtime_checkable
class DifferentiableFunction(_Values, Protocol):
    """A batch function with an exact gradient; without one, methods use finite differences."""

    def gradient(self, designs: FloatArray) -> FloatArray | None:
        """Map n designs (n, k) to the gradients of their values (n, k); NaN for designs that fail.

        Called only for designs whose values have been evaluated. None if not available.
        """
        ...


@runtime_checkable
class ConstrainedFunction(_Values, Protocol):
    """A batch function that ranks designs by feasibility first, with what it ranks by."""

    def constrained(self, designs: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Map n designs (n, k) to objective values (n,) and excesses over c constraints (n, c).

        Values of infeasible designs are those of the objective, not their ranks. +inf and NaN for
        designs that fail.
        """
        ...


Linearized = tuple[FloatArray, FloatArray, FloatArray, FloatArray]


@runtime_checkable
class LinearizedFunction(ConstrainedFunction, Protocol):
    """A constrained function with exact gradients of values and excesses."""

    def linearized(self, designs: FloatArray) -> Linearized | None:
        """Return what `constrained` does, and the gradients of both, (n, k) and (n, c, k).

        NaN for designs that fail. None if there are no gradients.
        """
        ...


@runtime_checkable
class SeveralFunction(_Values, Protocol):
    """A batch function of several objectives, with constraints."""

    def objectives(self, designs: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Map n designs (n, k) to m objectives (n, m) and excesses over c constraints (n, c).

        +inf and NaN for designs that fail.
        """
        ...


@runtime_checkable
class StreamingFunction(_Values, Protocol):
    """A batch function that can evaluate ahead while its first values are processed."""

    def stream(self, designs: FloatArray) -> Generator[FloatArray, None, None]:
        """Yield the values of n designs (n, k) in order, in chunks."""
        ...


@dataclass(frozen=True)
class Budget:
    """Limits of a search."""

    evaluations: int | None = None  # distinct designs
    seconds: float | None = None  # wall time [s]; makes a search irreproducible

    def __post_init__(self) -> None:
        """Raise InputError if a limit is not positive."""
        if self.evaluations is not None:
            object.__setattr__(self, "evaluations", integer("budget", self.evaluations, 1))
        if self.seconds is not None and not (
            isinstance(self.seconds, (int, float)) and self.seconds > 0.0
        ):
            raise InputError(f"budget is {self.seconds!r} s: it must be greater than zero.")


@dataclass(frozen=True)
class Progress:
    """State of a running search."""

    iteration: int  # iterations completed
    evaluations: int  # distinct designs evaluated
    design: FloatArray  # (k,), best design so far
    value: float  # its value; +inf if every design has failed
    detail: str  # method-specific state, for example ``"mesh 0.0625"``
    # Remaining evaluations if no further improvement is found, where the method knows.
    remaining: int | None = None


ProgressCallback = Callable[[Progress], None]


@dataclass(frozen=True)
class SearchResult:
    """Result of a search."""

    design: FloatArray  # (k,), best design evaluated
    value: float  # its value; +inf if every design failed
    evaluations: int  # distinct designs
    iterations: int  # of the method
    reason: str  # why it stopped
    improvement_evaluations: NDArray[np.int64]  # (i,), evaluations at each improvement
    improvement_values: FloatArray  # (i,), best value after each
    improvement_designs: FloatArray  # (i, k), best design after each


class Search(Protocol):
    """A method that minimises a batch function within bounds.

    Implementations are frozen dataclasses whose fields are the method's options. They are
    deterministic: the same arguments request the same designs in the same order, so that a study
    can be resumed by replaying it.
    """

    @property
    def name(self) -> str:
        """Name on the command line."""
        ...

    def minimize(
        self,
        function: BatchFunction,
        lower: FloatArray,
        upper: FloatArray,
        start: ArrayLike | None = None,
        seed: int = 0,
        budget: Budget | None = None,
        progress: ProgressCallback | None = None,
    ) -> SearchResult:
        """Minimise a function within bounds.

        Parameters
        ----------
        function : callable
            Maps n designs (n, k) to values (n,).
        lower, upper : (k,) arrays
            Bounds; no design outside them is requested.
        start : (k,) or (s, k) array, optional
            One or several starting designs; random by default.
        seed : int
            Random seed.
        budget : Budget, optional
            Limits of the search.
        progress : callable, optional
            Called after each iteration; may raise to stop the search.

        Returns
        -------
        SearchResult
            Best design and history of the search.

        Raises
        ------
        InputError
            If a start is outside the bounds.
        """
        ...


def uses_gradients(search: Search) -> bool:
    """Return whether a search declares, by an attribute ``gradients``, that it uses them."""
    return bool(getattr(search, "gradients", False))


def takes_several(search: Search) -> bool:
    """Return whether a search declares, by an attribute ``several``, that it takes objectives."""
    return bool(getattr(search, "several", False))
