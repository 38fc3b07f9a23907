"""Searches by procedures that call a function, side by side: what they ask for is one batch.

Each search is in a thread of its own, of which one runs at a time, in a fixed order: everything is
as reproducible as one after the other.
"""

from __future__ import annotations

import threading
from collections.abc import Callable, Generator, Iterable, Sequence
from typing import Generic, TypeVar

from flexor.optimizers.interface import FloatArray

Answer = TypeVar("Answer")
# From a start (k,) and a function of points to where the search ends (k,).
Procedure = Callable[[FloatArray, Callable[[FloatArray], Answer]], FloatArray]


class _Ended(BaseException):
    """Raised in a search that is no longer wanted."""


class _Turns(Generic[Answer]):
    """One search, which runs until it asks for something or ends."""

    def __init__(self, procedure: Procedure[Answer], start: FloatArray) -> None:
        self.asked: FloatArray | None = None  # None once it has ended
        self.end: FloatArray | None = None
        self._procedure, self._start = procedure, start
        self._answer: Answer | None = None
        self._error: BaseException | None = None
        self._unwanted = False
        self._go, self._stands = threading.Semaphore(0), threading.Semaphore(0)
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()
        self._wait()

    def go_on(self, answer: Answer) -> None:
        """Answer what was asked for, and wait until something else is."""
        self._answer = answer
        self._go.release()
        self._wait()

    def stop(self) -> None:
        """End it before it has asked for more."""
        self._unwanted = True
        self._go.release()
        self._thread.join()

    def _wait(self) -> None:
        self._stands.acquire()
        if self._error is not None:
            raise self._error

    def _run(self) -> None:
        try:
            self.end = self._procedure(self._start, self._ask)
        except _Ended:
            pass
        except BaseException as error:  # raised where it is waited for
            self._error = error
        self.asked = None
        self._stands.release()

    def _ask(self, point: FloatArray) -> Answer:
        self.asked = point
        self._stands.release()
        self._go.acquire()
        if self._unwanted:
            raise _Ended
        assert self._answer is not None
        return self._answer


def side_by_side(
    procedure: Procedure[Answer],
    starts: Iterable[FloatArray],
    answers: Callable[[list[FloatArray]], Sequence[Answer]],
    at_once: int,
) -> Generator[FloatArray, None, None]:
    """Search from points (k,), some at once; yield where each search ends (k,), as it does.

    Those that are still searching when the generator is closed are given up.

    Parameters
    ----------
    procedure
        A search; it is given its start and a function of points (k,).
    starts
        Where they begin; the next is taken when there is room for it.
    answers
        The values of that function at several points, in one batch.
    at_once
        Number of searches side by side.
    """
    left, running = iter(starts), list[_Turns[Answer]]()
    try:
        while True:
            while len(running) < at_once and (start := next(left, None)) is not None:
                running.append(_Turns(procedure, start))
            if not running:
                return
            asking = [each for each in running if each.asked is not None]
            points = [each.asked for each in asking if each.asked is not None]
            if points:
                for each, answer in zip(asking, answers(points), strict=True):
                    each.go_on(answer)
            for each in [each for each in running if each.asked is None]:
                running.remove(each)
                assert each.end is not None
                yield each.end
    finally:
        for each in running:
            if each.asked is not None:
                each.stop()
