"""Any study comes back the same from its folder: settings, record, problem, and its run."""

from __future__ import annotations

import tempfile
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from flexor.study import Settings, Study, optimize, rerun, resume

METHODS: dict[str, dict[str, Any]] = {
    "pattern-search": {"starts": 2, "tolerance": 1e-2},
    "differential-evolution": {"population": 6},
    "cma-es": {},
    "direct": {},
    "dual-annealing": {},
    "levenberg-marquardt": {},
    "multistart-bfgs": {"starts": 2},
    "grid": {"points": 3},
}
OBJECTIVES = {"bending": True, "bending-contact": True, "tip-force": False}  # norms of vectors


@settings(
    deadline=None, max_examples=8, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@given(data=st.data())
def test_any_study_comes_back_from_its_folder(analytic: ModuleType, data: st.DataObject) -> None:
    draw = data.draw
    method = draw(st.sampled_from(list(METHODS)))
    names = [name for name, norm in OBJECTIVES.items() if norm or "leven" not in method]
    given: dict[str, Any] = {
        "parameters": draw(st.sampled_from(["L", "R01", "L+R01", "Rsc", "RLP", "L+RLP"])),
        "objective": draw(st.sampled_from(names)),
        "method": method,
        "method_options": METHODS[method],
        "seed": draw(st.integers(0, 2**63)),
        "force": draw(st.one_of(st.none(), st.just([0.0, 0.1, 4.7]), st.just([0.0, 1.0, 5.0]))),
        "budget": draw(st.integers(1, 40)),
        "start": draw(st.sampled_from([None, "random"])),
    }
    if given["parameters"].startswith("L"):
        given["bounds"] = {"L": draw(st.sampled_from([(0.061, 0.1401), (0.05, 0.2)]))}
    model = analytic.AnalyticModel()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name) / "s"
        made = optimize(model, folder=folder, **given)
        designs, outcomes = made.record.designs(), made.record.outcomes()
        read = Study.open(folder, model=model)
        assert read.settings == made.settings
        assert Settings.read(folder).values == made.settings.values
        assert read.finished == made.finished
        assert read.evaluations == made.evaluations <= given["budget"]
        assert read.record.designs().tobytes() == designs.tobytes()
        again = read.record.outcomes()
        for field in (
            "value",
            "joint_angles",
            "tip_force",
            "touching",
            "event_count",
            "total_iterations",
        ):
            assert getattr(again, field).tobytes() == getattr(outcomes, field).tobytes()
        one, other = made.problem, read.problem
        assert one.force.tobytes() == other.force.tobytes()
        for bound in ("lower", "upper"):
            limits = (getattr(each.parameters, bound) for each in (one, other))
            assert len({limit.tobytes() for limit in limits}) == 1
        anywhere = np.random.default_rng(0).uniform(one.parameters.lower, one.parameters.upper)
        values = [each.evaluate(anywhere[None, :]).value for each in (one, other)]
        assert values[0].tobytes() == values[1].tobytes()
        made.close()
        read.close()
        resumed = resume(folder, model=model)
        assert resumed.record.designs().tobytes() == designs.tobytes()
        resumed.close()
        assert rerun(folder, model=model).same
