"""Every method as a study: killed and resumed it ends in the same record."""

from __future__ import annotations

from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest

from flexor import optimizers
from flexor.errors import InputError
from flexor.study import Study, optimize, resume


class Killed(BaseException):
    pass


def content(study: Study) -> tuple[Any, ...]:
    assert study.result is not None
    return (
        study.record.designs().tobytes(),
        study.record.outcomes().value.tobytes(),
        study.result.design.tobytes(),
        study.result.improvement_evaluations.tolist(),
        study.result.reason,
    )


# Several objectives, for which there is a method of its own, are in test_front.py.
@pytest.mark.parametrize(
    "name", [name for name in optimizers.names() if name not in ("grid", "pareto")]
)
def test_killed_and_resumed_it_ends_in_the_same_record(
    analytic: ModuleType, tmp_path: Path, name: str
) -> None:
    if name not in optimizers.available():
        pytest.skip(f"the library of {name} is not installed")
    given: dict[str, Any] = {
        "parameters": "L+R01",
        "method": name,
        "start": "random",
        "seed": 7,
        "budget": {"surrogate": 40, "auto": 400}.get(name, 120),
    }
    model = analytic.AnalyticModel()
    whole = optimize(model, folder=tmp_path / "whole", **given)
    # SQP of auto also asks for slopes at designs that its sample has evaluated.
    total = sum(model.calls)
    assert total == whole.evaluations if name != "auto" else total > whole.evaluations
    model = analytic.AnalyticModel()

    def kill(model: Any) -> None:
        if sum(model.calls) >= given["budget"] // 3:
            raise Killed

    model.before_batch = kill
    with pytest.raises(Killed):
        optimize(model, folder=tmp_path / "pieces", **given)
    done = sum(model.calls)
    assert 0 < done < whole.evaluations
    model = analytic.AnalyticModel()
    pieces = resume(tmp_path / "pieces", model=model)
    assert content(pieces) == content(whole)
    check = 1 if np.isfinite(whole.record.outcomes().value[:done]).any() else 0
    assert sum(model.calls) == total - done + check


def test_least_squares_needs_the_norm_of_a_vector(analytic: ModuleType) -> None:
    study = optimize(analytic.AnalyticModel(), "L", "f_b", "lm", method_options={"starts": 4})
    assert study.best.parameters["L"] == pytest.approx(0.11, abs=1e-6)
    contact = optimize(analytic.AnalyticModel(), "L", "f_bc", "lm")
    assert contact.best.value < contact.start.value
    with pytest.raises(InputError, match='objective "tip-force" is not the norm of a vector'):
        optimize(analytic.AnalyticModel(), "L", "f_exo", "lm")


def test_vectors_are_those_of_the_values(analytic: ModuleType) -> None:
    study = optimize(analytic.AnalyticModel(), "L+R01", "f_b", "de", budget=200)
    outcomes = study.record.outcomes()
    vectors = study.problem.residuals(outcomes)
    failed = ~np.isfinite(outcomes.value)
    assert 0 < failed.sum() < 200
    assert np.isnan(vectors[failed]).all()
    np.testing.assert_allclose(
        np.linalg.norm(vectors[~failed], axis=1), outcomes.value[~failed], rtol=1e-14
    )
