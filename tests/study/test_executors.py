"""Executors without a cluster: threads, addresses, what is sent, and what workers refuse."""

from __future__ import annotations

import os
import pickle
import socket
import sys
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from dataclasses import replace
from functools import partial
from multiprocessing import get_context
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest

import flexor
from flexor.design import custom as custom_set
from flexor.design import parameter_set
from flexor.errors import ClusterError, InputError
from flexor.installing import install_command
from flexor.model import chunks
from flexor.objectives import custom, objective
from flexor.optimizers import Progress, method
from flexor.study import (
    Cluster,
    Pool,
    Problem,
    Record,
    RecordedEvaluator,
    Study,
    Threads,
    optimize,
    resume,
)
from flexor.study.comparison import compare
from flexor.study.executors import cluster, interface, task
from flexor.study.executors.cluster import local_workers
from flexor.study.executors.task import PickledProblem, dumps


def problem_of(model: Any, parameters: str = "R01") -> Problem:
    return Problem(model, parameter_set(parameters, model.design), objective("bending"))


@pytest.fixture(scope="module")
def finger() -> Problem:
    return problem_of(flexor.load("finger", "calibrated"))


@pytest.mark.parametrize("count", [0, 1, 7, 8, 20])
def test_parts_are_the_whole(analytic: ModuleType, monkeypatch: Any, count: int) -> None:
    monkeypatch.setattr(chunks, "SIZE", 7)
    model = analytic.AnalyticModel()
    problem = problem_of(model)
    designs = np.random.default_rng(1).uniform(0.0046, 0.012, size=(count, 2))
    sizes = [len(part) for part in Threads(1).parts(problem, designs)]
    assert sum(sizes) == count
    assert max(sizes, default=0) <= 7
    whole, joined = problem.evaluate(designs), Threads(1).evaluate(problem, designs)
    assert joined.value.tobytes() == whole.value.tobytes()
    assert joined.joint_angles.shape == whole.joint_angles.shape


def test_an_executor_needs_only_parts(analytic: ModuleType) -> None:
    class Counting(interface.DesignEvaluator):
        asked = 0

        def parts(self, problem: Problem, designs: Any, gradient: bool = False) -> Any:
            self.asked += len(designs)
            yield problem.evaluate(designs, 1, gradient)

    with Counting() as executor:
        study = optimize(analytic.AnalyticModel(), "L", budget=30, executor=executor)
        assert executor.asked == study.evaluations == 30
        assert (executor.slots, executor.remote) == (1, False)
        assert executor.call(study.problem, lambda problem, x: (problem, x), 3)[1] == 3


def test_a_grid_is_streamed_and_stops_at_its_budget(analytic: ModuleType) -> None:
    problem = problem_of(analytic.AnalyticModel())
    record = Record(None, (2, 6, 3))
    told: list[Progress] = []
    chosen = problem.parameters
    known = RecordedEvaluator(problem, record, Threads(1))
    known(np.array([[0.004, 0.004], [0.012, 0.012]]))  # the first and the last of the grid
    function = RecordedEvaluator(problem, record, Threads(1))
    result = method("grid", points=25).minimize(
        function, chosen.lower, chosen.upper, progress=told.append
    )
    assert result.evaluations == 625
    assert (function.evaluated, function.replayed) == (623, 2)
    assert [at.evaluations for at in told[:2]] == [chunks.SIZE + 1, 2 * chunks.SIZE + 1]
    assert [at.remaining for at in told[-2:]] == [0, 0]
    # The one known last comes with the others' last, and every value is where it belongs.
    again = RecordedEvaluator(problem, record, Threads(1))(record.designs())
    np.testing.assert_array_equal(again, record.outcomes().value)
    short = optimize(problem.model, "R01", method="grid", budget=300)
    assert short.evaluations == 300
    assert short.result is not None
    assert short.result.reason == "the budget of 300 evaluations is spent"


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("local:0", '"local:0" cannot be started: expected "local:N", N from 1 to 1024.'),
        ("local:-1", "N from 1 to 1024."),
        ("local:", "N from 1 to 1024."),
        ("local", "N from 1 to 1024."),
        ("local:99999", "N from 1 to 1024."),
        ("local:two", "N from 1 to 1024."),
        ("", '"" is not an address'),
        ("host:8786", "is not an address: give that of a Dask scheduler"),
        ("tcp://host", "is not an address"),
        ("tcp://:8786", "is not an address"),
        ("tcp//host:8786", "is not an address"),
        ("http://host:8786", "is not an address"),
        ("ucx://host:8786", "is not an address"),
        ("tcp://host:port", "is not an address"),
        ("tcp://host:0", "has port 0: ports are from 1 to 65535"),
        ("tcp://host:65536", "has port 65536"),
        ("tcp://ho st:8786", "is not an address"),
    ],
)
def test_an_address_that_is_none_is_refused(text: str, said: str) -> None:
    with pytest.raises(InputError) as refusal:
        Cluster(text)
    assert said in str(refusal.value)
    assert str(refusal.value).endswith(".")


@pytest.mark.parametrize(
    "text", ["tcp://10.0.0.1:8786", "tls://my-host.lab:1", "tcp://[::1]:8786/", " tcp://h:1 "]
)
def test_addresses_of_schedulers_are_read(text: str) -> None:
    assert local_workers(text.strip()) == 0
    assert local_workers("local:3") == 3


def test_without_dask_the_extra_is_named(monkeypatch: Any) -> None:
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(InputError) as refusal:
        Cluster("local:2")
    assert str(refusal.value) == (
        "a cluster needs the package dask[distributed], which is not installed: "
        f"{install_command('dask[distributed]')}."
    )


def test_an_unreachable_cluster_is_one_sentence(monkeypatch: Any, tmp_path: Any) -> None:
    pytest.importorskip("distributed")
    monkeypatch.setattr(cluster, "CONNECT_TIMEOUT", 0.2)
    with socket.socket() as closed:
        closed.bind(("127.0.0.1", 0))
        address = f"tcp://127.0.0.1:{closed.getsockname()[1]}"
        with pytest.raises(InputError) as refusal:
            optimize(
                flexor.load("finger", "calibrated"),
                "L",
                executor=address,
                folder=tmp_path / "study",
            )
    assert str(refusal.value) == (
        f'the cluster "{address}" cannot be reached: no Dask scheduler answers there within 0.2 s.'
    )
    assert not (tmp_path / "study").exists()


def test_a_server_that_is_no_scheduler_is_not_waited_for(monkeypatch: Any) -> None:
    pytest.importorskip("distributed")
    monkeypatch.setattr(cluster, "CONNECT_TIMEOUT", 0.3)
    with socket.create_server(("127.0.0.1", 0)) as silent:
        address = f"127.0.0.1:{silent.getsockname()[1]}"
        with pytest.raises(InputError, match=r"no Dask scheduler answers there within 0\.3 s"):
            Cluster(f"tcp://{address}")
        with pytest.raises(InputError, match="cannot be reached: "):
            Cluster(f"tls://{address}")  # without certificates


def test_a_model_is_pickled_as_its_description(finger: Problem) -> None:
    content = pickle.dumps(finger.model)
    assert len(content) < 6000
    copy = pickle.loads(content)
    assert copy.hash == finger.model.hash
    assert copy.file == finger.model.file
    rebuilt, (text, _) = finger.model.__reduce__()
    with pytest.raises(InputError, match=r"made by another version of Flexor: .* hash 0123 there"):
        rebuilt(text, "0123")


def evaluation(designs: Any, gradient: bool = False) -> bytes:
    return dumps((task.evaluate, (np.asarray(designs), gradient)))


def test_a_worker_does_what_it_is_sent(finger: Problem) -> None:
    pickled = PickledProblem.of(finger)
    assert len(pickled.content) < 8000
    designs = np.array([[0.007, 0.008], [0.0116, 0.008]])
    work = evaluation(designs, True)
    assert len(work) < 300
    found = task.run(pickled, work).result
    expected = finger.evaluate(designs, gradient=True)
    assert found.value.tobytes() == expected.value.tobytes()
    assert found.derivatives.tobytes() == expected.derivatives.tobytes()
    kept = task._unpickled(pickled)
    assert task.run(pickle.loads(pickle.dumps(pickled)), work).error is None
    assert task._unpickled(pickle.loads(pickle.dumps(pickled))) is kept
    assert isinstance(task.run(pickled, evaluation(designs[:, :1])).error, InputError)


def test_a_worker_refuses_another_version_engine_model_or_module(finger: Problem) -> None:
    pickled, work = PickledProblem.of(finger), evaluation([[0.007, 0.008]])

    def refusal(**changed: Any) -> str:
        reply = task.run(replace(pickled, **changed), work)
        assert isinstance(reply.error, InputError)
        return str(reply.error)

    here = flexor.__version__
    versions = dict(pickled.versions)
    said = refusal(versions=(*{**versions, "flexor": "0.0.1"}.items(),))
    assert said == f"a worker runs Flexor {here}, this is 0.0.1: install the same version."
    said = refusal(versions=(*{**versions, "engine": "0" * 16}.items(),))
    assert said.startswith("a worker runs another build of the engine than this process")
    known = finger.model.hash
    said = refusal(content=pickled.content.replace(known.encode(), b"0" * 64))
    assert 'the model "finger" was made by another version' in said
    assert f"the hash 000000000000 there and {known[:12]} here" in said
    said = refusal(content=b"cno_such_module\nthing\n.")
    assert said == "a worker cannot load the problem: No module named 'no_such_module'."


def test_ones_own_functions_are_sent_and_those_that_cannot_be_are_named(finger: Problem) -> None:
    pytest.importorskip("cloudpickle")
    scale = 2.0
    wanted = custom("mine", lambda path: -scale * float(path.joint_angles[-1, 0]))
    bulge = custom_set("bulge", ["R"], [0.005], [0.012], [0.008], lambda p, X: p[0] + 0.0 * X)
    own = Problem(finger.model, bulge.on(finger.model.design), wanted)
    found = task.run(PickledProblem.of(own), evaluation([[0.008]])).result
    assert found.value[0] == -2.0 * found.joint_angles[0, -1, 0]
    with socket.socket() as held:
        stuck = custom("stuck", lambda path: float(held.fileno()))
        with pytest.raises(InputError, match=r'"stuck" cannot be sent to other processes: .*'):
            PickledProblem.of(replace(own, objective=stuck))


def bits(study: Study) -> list[bytes]:
    outcomes = study.record.outcomes()
    arrays = [study.record.designs(), outcomes.value, outcomes.joint_angles, outcomes.stable]
    slopes = [study.record.derivatives(design) for design in study.record.designs()]
    return [array.tobytes() for array in arrays] + [repr(slopes).encode()]


@pytest.mark.parametrize("kind", [ThreadPoolExecutor, ProcessPoolExecutor])
def test_standard_executors_give_the_same_bits(kind: Any) -> None:
    pytest.importorskip("cloudpickle")  # for the function at the end
    model = flexor.load("finger")
    searches: list[dict[str, Any]] = [
        {"method": "grid", "method_options": {"points": 20}},
        {"method": "ps", "method_options": {"starts": 3}, "start": "random", "budget": 60},
        {"method": "bfgs", "budget": 20},
    ]
    given: dict[str, Any] = {"parameters": "L", "methods": "ps,lm", "seeds": 2, "budget": 12}
    # Not forked: the engine has threads of its own here.
    more = {"mp_context": get_context("spawn")} if kind is ProcessPoolExecutor else {}
    with kind(2, **more) as pool:
        assert Pool(pool).slots == 2
        assert Pool(pool).remote == (kind is ProcessPoolExecutor)
        for search in searches:
            there = optimize(model, "R01", executor=pool, **search)
            assert bits(there) == bits(optimize(model, "R01", **search))
        runs = [compare(model, executor=where, **given).runs for where in (pool, None)]
        for one, other in zip(*runs, strict=True):
            assert one.result.improvement_designs.tobytes() == (
                other.result.improvement_designs.tobytes()
            )
        bad = custom("f", lambda path: "high")  # type: ignore[arg-type,return-value]
        with pytest.raises(InputError, match='"f" must give one number for a path'):
            optimize(model, "L", bad, executor=pool, budget=3)


def test_a_pool_whose_process_dies_is_lost_and_the_study_resumes(
    finger: Problem, tmp_path: Path
) -> None:
    pytest.importorskip("cloudpickle")
    pool = ProcessPoolExecutor(1, mp_context=get_context("spawn"))
    kill = partial(Pool(pool).call, finger, lambda problem: os._exit(9))
    asked: list[int] = []

    def break_it(at: Any) -> None:
        asked.append(at.evaluations)
        if len(asked) == 2:
            with pytest.raises(ClusterError, match=r"^the executor was lost: .*"):
                kill()

    given: dict[str, Any] = {"parameters": "R01", "budget": 30}
    with pool, pytest.raises(ClusterError, match=r"^the executor was lost: "):
        optimize(finger.model, **given, executor=pool, folder=tmp_path / "s", progress=break_it)
    went_on = resume(tmp_path / "s")
    assert bits(went_on) == bits(optimize(finger.model, **given))


def test_what_is_no_executor_is_refused(finger: Problem) -> None:
    with pytest.raises(InputError, match=r"executor is a int: give a concurrent.futures.Executor"):
        optimize(finger.model, "L", executor=4)  # type: ignore[arg-type]
