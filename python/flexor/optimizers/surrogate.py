"""Efficient global optimisation with a Gaussian process, from egobox (an extra)."""

from __future__ import annotations

import os
from dataclasses import dataclass

import numpy as np

from flexor.optimizers.interface import FloatArray
from flexor.optimizers.method import Method, Run
from flexor.optimizers.options import at_least, option


@dataclass(frozen=True)
class Surrogate(Method):
    """Bayesian optimisation (EGO, Jones 1998) in a trust region (TREGO), for expensive models.

    Proposing a design takes from 10 ms to seconds, growing with the number of evaluations, so the
    method pays off only where a design takes longer than that. Failed designs are imputed with the
    model's prediction. With more than five parameters the process is fitted to three partial
    least-squares components (KPLS).

    Attributes
    ----------
    evaluations : int
        Evaluation limit if no budget is given.
    batch : int
        Number of designs proposed per iteration.
    """

    name = "surrogate"
    title = "surrogate (EGO)"
    aliases = ("ego", "bayesian")
    description = "Bayesian optimisation, for expensive models"
    packages = ("egobox",)

    evaluations: int = option(200, at_least(1))
    batch: int = option(1, at_least(1))

    def run(self, run: Run) -> str:
        """Evaluate the initial sample, then iterate EGO."""
        # Set before the import: egobox logs a stopped search as an error.
        os.environ.setdefault("EGOBOX_LOG", "off")
        import egobox

        k = run.size
        points = run.starts(2 * k + 2)
        values = run.values(points)
        run.step("initial sample")
        while np.count_nonzero(np.isfinite(values)) < k + 1:
            if len(points) >= self.evaluations:
                return "too few successful designs to fit a model"
            more = run.random.uniform(size=(2 * k + 2, k))
            points, values = np.concatenate((points, more)), np.append(values, run.values(more))
            run.step("initial sample")
        valid = np.isfinite(values)
        raised: list[BaseException] = []

        def evaluate(designs: FloatArray) -> FloatArray:
            try:
                result = run.values(designs)
                run.step("EGO")
            except BaseException as error:
                raised.append(error)  # egobox would wrap it in its own exception
                raise
            return np.where(np.isfinite(result), result, np.nan)[:, None]

        optimizer = egobox.Egor(
            [[0.0, 1.0]] * k,
            gp_config={"kpls_dim": 3} if k > 5 else None,
            qei_config={"batch": self.batch} if self.batch > 1 else None,
            x_doe=points[valid],
            y_doe=values[valid, None],
            trego=True,
            infill_n_start=10,
            failsafe_strategy=egobox.FailsafeStrategy.IMPUTATION,
            seed=run.seed,
        )
        iterations = max((self.evaluations - len(points)) // self.batch, 1)
        try:
            optimizer.minimize(evaluate, max_iters=iterations, stop_on_error=True)
        except Exception:
            if not raised:
                raise
        if raised:
            raise raised[0]
        return f"{run.function.evaluations} evaluations"
