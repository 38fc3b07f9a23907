"""Efficient global optimisation on a Gaussian process, of egobox (an extra)."""

from __future__ import annotations

import os
from dataclasses import dataclass

import numpy as np

from flexor.optimizers.extras import need
from flexor.optimizers.interface import FloatArray
from flexor.optimizers.method import Method, Run
from flexor.optimizers.options import require


@dataclass(frozen=True)
class Surrogate(Method):
    """Bayesian optimisation (EGO, Jones 1998) in a trust region (TREGO), for expensive models.

    The Gaussian process takes from 10 ms to seconds for each design it proposes, more the more it
    has seen: worth it where a design takes longer than that. A failed design counts as predicted.
    Above five parameters it looks at three combinations of them (kriging by partial least squares).

    Attributes
    ----------
    evaluations : int
        It ends after so many if no budget ends it before.
    batch : int
        Designs proposed at a time.
    """

    evaluations: int = 200
    batch: int = 1

    def __post_init__(self) -> None:
        """Check the options and that egobox is installed.

        Raises
        ------
        InputError
            If one is out of its range or egobox is missing.
        """
        require(self.name, "evaluations", self.evaluations, self.evaluations >= 1, "at least 1")
        require(self.name, "batch", self.batch, self.batch >= 1, "at least 1")
        need(self.name)

    @property
    def name(self) -> str:
        """``"surrogate"``."""
        return "surrogate"

    def run(self, run: Run) -> str:
        """Sample, then propose and learn."""
        # Before the import: it logs a search that is stopped as if that were an error.
        os.environ.setdefault("EGOBOX_LOG", "off")
        import egobox

        k = run.size
        random = np.random.default_rng(run.seed)
        points = run.starts(2 * k + 2, random)
        known = run.values(points)
        run.step("sampling")
        while np.count_nonzero(np.isfinite(known)) < k + 1:
            if len(points) >= self.evaluations:
                return "too few designs succeed to learn from"
            more = random.uniform(size=(2 * k + 2, k))
            points, known = np.concatenate((points, more)), np.append(known, run.values(more))
            run.step("sampling")
        good = np.isfinite(known)
        stopped: list[BaseException] = []

        def values(asked: FloatArray) -> FloatArray:
            try:
                found = run.values(asked)
                run.step("learning")
            except BaseException as error:
                stopped.append(error)  # what is raised here, egobox would put in words of its own
                raise
            return np.where(np.isfinite(found), found, np.nan)[:, None]

        optimizer = egobox.Egor(
            [[0.0, 1.0]] * k,
            gp_config={"kpls_dim": 3} if k > 5 else None,
            qei_config={"batch": self.batch} if self.batch > 1 else None,
            x_doe=points[good],
            y_doe=known[good, None],
            trego=True,
            infill_n_start=10,
            failsafe_strategy=egobox.FailsafeStrategy.IMPUTATION,
            seed=run.seed,
        )
        rounds = max((self.evaluations - len(points)) // self.batch, 1)
        try:
            optimizer.minimize(values, max_iters=rounds, stop_on_error=True)
        except Exception:
            if not stopped:
                raise
        if stopped:
            raise stopped[0]
        return f"{run.function.evaluations} evaluations"
