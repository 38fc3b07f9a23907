"""Running a case: what it found, or why it found nothing."""

from __future__ import annotations

import time
from dataclasses import dataclass

from flexor.validate.case import Case, Outcome, Unavailable


@dataclass(frozen=True)
class Result:
    """A case that was run.

    Attributes
    ----------
    case : Case
        Which one.
    outcome : Outcome or None
        What it found; None if it was skipped or broke down.
    reason : str
        Why it found nothing.
    skipped : bool
        Whether its reference is not at hand, which is no failure.
    seconds : float
        How long it took.
    """

    case: Case
    outcome: Outcome | None
    reason: str
    skipped: bool
    seconds: float

    @property
    def passed(self) -> bool:
        """Whether it ran and every comparison passed."""
        return self.outcome is not None and self.outcome.passed

    @property
    def failed(self) -> bool:
        """Whether it ran, or should have, and did not pass."""
        return not self.passed and not self.skipped

    @property
    def verdict(self) -> str:
        """One word: passed, failed or skipped."""
        return "skipped" if self.skipped else "passed" if self.passed else "failed"


def run(case: Case) -> Result:
    """Run a case; one that breaks down has failed and does not stop the others.

    Parameters
    ----------
    case
        What to run.
    """
    began = time.perf_counter()
    outcome, reason, skipped = None, "", False
    try:
        outcome = case.run()
    except Unavailable as missing:
        reason, skipped = str(missing), True
    except Exception as error:
        reason = f"{type(error).__name__}: {error}"
    return Result(case, outcome, reason, skipped, time.perf_counter() - began)
