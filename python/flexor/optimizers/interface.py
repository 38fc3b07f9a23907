"""What a search is: the interface behind which every optimiser lives."""

from __future__ import annotations

from collections.abc import Callable, Generator
from dataclasses import dataclass
from typing import Protocol, runtime_checkable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from flexor.errors import InputError

FloatArray = NDArray[np.float64]

# From n designs (n, k) to their values (n,); designs that failed have +inf.
BatchFunction = Callable[[FloatArray], FloatArray]


@runtime_checkable
class VectorFunction(Protocol):
    """A batch function whose value is the norm of a vector, which least squares needs to see."""

    def __call__(self, designs: FloatArray) -> FloatArray:
        """From n designs (n, k) to their values (n,); +inf where a design failed."""
        ...

    def residuals(self, designs: FloatArray) -> FloatArray:
        """From n designs (n, k) to their vectors (n, r); NaN where a design failed.

        Raises
        ------
        InputError
            If what is minimised is not the norm of a vector after all.
        """
        ...


@runtime_checkable
class DifferentiableVectorFunction(VectorFunction, Protocol):
    """A vector function that also knows its exact Jacobian; without it differences are taken."""

    def jacobian(self, designs: FloatArray) -> FloatArray | None:
        """From n designs (n, k) to the derivatives of their vectors, (n, r, k); NaN where failed.

        It is asked only for designs whose vectors have been asked for before. None if there are
        none after all.
        """
        ...


@runtime_checkable
class DifferentiableFunction(Protocol):
    """A batch function that also knows its exact gradient; without it differences are taken."""

    def __call__(self, designs: FloatArray) -> FloatArray:
        """From n designs (n, k) to their values (n,); +inf where a design failed."""
        ...

    def gradient(self, designs: FloatArray) -> FloatArray | None:
        """From n designs (n, k) to the gradients of their values, (n, k); NaN where failed.

        It is asked only for designs whose values have been asked for before. None if there are
        none after all.
        """
        ...


@runtime_checkable
class StreamingFunction(Protocol):
    """A batch function that can work ahead while its first values are looked at."""

    def __call__(self, designs: FloatArray) -> FloatArray:
        """From n designs (n, k) to their values (n,); +inf where a design failed."""
        ...

    def stream(self, designs: FloatArray) -> Generator[FloatArray, None, None]:
        """Yield the values of n designs (n, k) in order, some of them at a time."""
        ...


@dataclass(frozen=True)
class Budget:
    """When to stop a search that has not stopped by itself.

    Attributes
    ----------
    evaluations : int or None
        Distinct designs that may be evaluated.
    seconds : float or None
        Time that may pass. A search stopped by time is not repeatable; one stopped by
        evaluations is.
    """

    evaluations: int | None = None
    seconds: float | None = None

    def __post_init__(self) -> None:
        """Check the numbers.

        Raises
        ------
        InputError
            If one is not positive.
        """
        if self.evaluations is not None and self.evaluations < 1:
            raise InputError(f"the budget must be at least 1 evaluation, got {self.evaluations}.")
        if self.seconds is not None and not self.seconds > 0.0:
            raise InputError(f"the budget must be a positive time, got {self.seconds:g} s.")


@dataclass(frozen=True)
class Progress:
    """Where a search stands.

    Attributes
    ----------
    iteration : int
        Iterations done.
    evaluations : int
        Distinct designs evaluated.
    design : (k,) array
        Best design so far.
    value : float
        Its value; +inf while every design has failed.
    detail : str
        In the method's own words, for example ``"mesh 0.0625"``.
    remaining : int or None
        Evaluations still to come if nothing better is found any more, where the method knows.
    """

    iteration: int
    evaluations: int
    design: FloatArray
    value: float
    detail: str
    remaining: int | None = None


ProgressCallback = Callable[[Progress], None]


@dataclass(frozen=True)
class SearchResult:
    """What a search found.

    Attributes
    ----------
    design : (k,) array
        Best design evaluated.
    value : float
        Its value; +inf if every design failed.
    evaluations, iterations : int
        Distinct designs evaluated, and iterations of the method.
    reason : str
        Why it stopped.
    improvement_evaluations : (i,) int array
        After how many evaluations the best value improved.
    improvement_values : (i,) array
        To what.
    improvement_designs : (i, k) array
        By which design.
    """

    design: FloatArray
    value: float
    evaluations: int
    iterations: int
    reason: str
    improvement_evaluations: NDArray[np.int64]
    improvement_values: FloatArray
    improvement_designs: FloatArray


class Search(Protocol):
    """A method that minimises a batch function in a box.

    Implementations are frozen dataclasses whose fields are the method's options, and are
    deterministic: the same arguments ask for the same designs in the same order, which is what
    lets a study resume.
    """

    @property
    def name(self) -> str:
        """As written on the command line."""
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
        """Minimise.

        Parameters
        ----------
        function : callable
            From n designs (n, k) to values (n,).
        lower, upper : (k,) arrays
            Bounds; no design outside them is asked for.
        start : (k,) or (s, k) array, optional
            One start or several; drawn from the seed by default.
        seed : int
            Random seed.
        budget : Budget, optional
            When to stop at the latest.
        progress : callable, optional
            Called after each iteration; may raise to stop the search.

        Returns
        -------
        SearchResult
            Best design and how it was found.

        Raises
        ------
        InputError
            If a start is outside the bounds.
        """
        ...


def uses_gradients(search: Search) -> bool:
    """Tell whether a search asks for gradients or Jacobians where there are some.

    Parameters
    ----------
    search : Search
        It says so by an attribute ``gradients``.
    """
    return bool(getattr(search, "gradients", False))
