"""Problems evaluate any number of designs in parts."""

from __future__ import annotations

import numpy as np

from flexor.design import parameter_set
from flexor.model import chunks
from flexor.objectives import objective
from flexor.study import Problem


def test_parts_leave_no_trace(analytic, monkeypatch) -> None:
    model = analytic.AnalyticModel()
    chosen = parameter_set("L+R01", model.design)
    unit = np.random.default_rng(0).uniform(size=(50, 3))
    designs = chosen.lower + unit * (chosen.upper - chosen.lower)
    designs[[3, 20, 21]] = -0.01  # a length that is not positive
    asked = Problem(model, chosen, objective("bending"))
    whole = asked.evaluate(designs)
    assert model.calls == [47]
    monkeypatch.setattr(chunks, "SIZE", 20)
    parts = asked.evaluate(designs)
    assert model.calls[1:] == [19, 18, 10]
    np.testing.assert_array_equal(parts.value, whole.value)
    np.testing.assert_array_equal(parts.joint_angles, whole.joint_angles)
    assert parts.reason.tolist() == whole.reason.tolist()
    assert "not positive" in parts.reason[20]
