"""Studies on a real scheduler and two worker processes, some of which are killed on the way."""

from __future__ import annotations

import importlib.util
import json
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

import flexor
from flexor.cli.app import main
from flexor.errors import ClusterError, InputError
from flexor.objectives import custom
from flexor.study import Cluster, Pool, Study, StudyProgress, optimize
from flexor.study.comparison import compare
from flexor.study.executors import cluster as clusters
from flexor.study.executors import task
from flexor.study.landscape import resume_landscape

Client = pytest.importorskip("distributed").Client
pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="kills processes")
GRID: dict[str, Any] = {"method": "grid", "method_options": {"points": 20}}


@pytest.fixture(scope="module")
def processes(tmp_path_factory: Any) -> Iterator[Any]:
    path = Path(__file__).parent / "dask_cluster.py"
    spec = importlib.util.spec_from_file_location("dask_cluster", path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    running = module.DaskCluster(tmp_path_factory.mktemp("cluster"))
    try:
        yield running
    finally:
        running.stop()


@pytest.fixture
def cluster(processes: Any) -> Iterator[Cluster]:
    """An executor on the cluster."""
    processes.complete(1)
    with Cluster(processes.address) as executor:
        yield executor


def wait_for(executor: Cluster, slots: int) -> None:
    until = time.monotonic() + 60
    while executor.slots < slots:
        assert time.monotonic() < until, "the workers did not come"
        time.sleep(0.2)


@pytest.fixture(scope="module")
def local() -> Study:
    return optimize(flexor.load("finger", "calibrated"), "R01", **GRID)


def content(study: Study) -> list[bytes]:
    """Everything recorded but the time."""
    outcomes = study.record.outcomes()
    arrays = [study.record.designs(), outcomes.value, outcomes.shown, outcomes.joint_angles]
    arrays += [outcomes.tip_force, outcomes.touching, outcomes.converged, outcomes.stable]
    arrays += [outcomes.event_count, outcomes.total_iterations]
    return [array.tobytes() for array in arrays] + [repr(outcomes.reason.tolist()).encode()]


class AtFirst:
    """Does something at the first news of a study."""

    def __init__(self, action: Any) -> None:
        self.action, self.told = action, 0

    def __call__(self, at: StudyProgress) -> None:
        self.told += 1
        if self.told == 1:
            self.action()


def test_a_study_is_the_same_to_the_bit(cluster: Cluster) -> None:
    model = flexor.load("finger", "calibrated")
    given: dict[str, Any] = {"start": "random", "seed": 2, "budget": 60}
    for settings in ({"method": "bfgs"}, {"method": "ps", "method_options": {"starts": 3}}):
        here = optimize(model, "L+R01", "f_b", **settings, **given)
        there = optimize(model, "L+R01", "f_b", executor=cluster, **settings, **given)
        assert content(there) == content(here)
        for design in here.record.designs():
            one, two = here.record.derivatives(design), there.record.derivatives(design)
            assert (one is None) == (two is None) == (settings["method"] == "ps")
            if one is not None and two is not None:
                assert (one[0].tobytes(), one[1]) == (two[0].tobytes(), two[1])


def test_whole_searches_are_the_same_and_their_errors_come_back(cluster: Cluster) -> None:
    given: dict[str, Any] = {"parameters": "L,R01", "methods": "ps,lm", "seeds": 2, "budget": 15}
    model = flexor.load("finger", "calibrated")
    here, there = compare(model, **given), compare(model, executor=cluster, **given)
    for one, two in zip(here.runs, there.runs, strict=True):
        assert (one.method, one.parameters, one.seed) == (two.method, two.parameters, two.seed)
        assert one.result.design.tobytes() == two.result.design.tobytes()
        assert one.result.improvement_values.tobytes() == two.result.improvement_values.tobytes()
        assert one.result.reason == two.result.reason
    bad = custom("bad", lambda path: "high")  # type: ignore[arg-type,return-value]
    with pytest.raises(InputError, match='objective "bad" must give one number for a path'):
        optimize(model, "L", bad, executor=cluster, budget=3)


def test_the_command_gives_the_same_as_without(
    cluster: Cluster, processes: Any, tmp_path: Path, monkeypatch: Any, capsys: Any
) -> None:
    monkeypatch.chdir(tmp_path)
    told = []
    for more in ([], ["--cluster", processes.address]):
        with pytest.raises(SystemExit) as ended:
            main(["optimize", "finger", "-p", "R01", "--budget", "20", "--json", *more])
        assert ended.value.code == 0
        told.append(json.loads(capsys.readouterr().out))
    for key in ("start", "best", "evaluations", "sensitivity"):
        assert told[0][key] == told[1][key]


def test_another_version_on_a_worker_is_refused(cluster: Cluster, monkeypatch: Any) -> None:
    address = cluster.address
    worker = next(iter(cluster._client.run(str)))
    with pytest.raises(InputError, match=f'"{worker}" is the address of a worker, not of the'):
        Cluster(worker)
    here = clusters.decisive_versions()
    monkeypatch.setattr(clusters, "decisive_versions", lambda: {**here, "flexor": "9.9.9"})
    with pytest.raises(InputError) as refusal:
        Cluster(address)
    said = str(refusal.value)
    assert said.startswith("the worker tcp://127.0.0.1:")
    assert said.endswith(
        f'of the cluster "{address}" runs Flexor {flexor.__version__}, this is 9.9.9: '
        "install the same version."
    )
    monkeypatch.setattr(clusters, "decisive_versions", lambda: {**here, "engine": "0123"})
    with pytest.raises(InputError, match="runs another build of the engine than this process"):
        Cluster(address)
    # Those that come later are refused at their first task.
    monkeypatch.setattr(task, "decisive_versions", lambda: {**here, "engine": "0123"})
    with pytest.raises(InputError, match=r"a worker runs another build of the engine than this"):
        optimize(flexor.load("finger-2-links"), "L", executor=cluster, budget=3)


def test_dasks_own_executor_is_one_like_any_other(cluster: Cluster) -> None:
    model, given = flexor.load("finger"), {"parameters": "L+R01", "budget": 40}
    with Client(cluster.address, set_as_default=False) as client:
        there = optimize(model, **given, executor=client.get_executor())
        assert Pool(client.get_executor()).slots == cluster.slots
    assert content(there) == content(optimize(model, **given))


def test_a_killed_worker_costs_nothing_but_time(
    cluster: Cluster, processes: Any, local: Study
) -> None:
    processes.complete(2)
    wait_for(cluster, 2)
    killed = processes.workers[0]
    study = optimize(
        flexor.load("finger", "calibrated"),
        "R01",
        executor=cluster,
        progress=AtFirst(killed.kill),
        **GRID,
    )
    assert content(study) == content(local)


def test_a_lost_scheduler_is_told_and_the_study_resumes(
    cluster: Cluster,
    processes: Any,
    local: Study,
    tmp_path: Path,
    monkeypatch: Any,
    capsys: Any,
) -> None:
    monkeypatch.chdir(tmp_path)
    # In two parts, the last may have come back before the scheduler is killed.
    monkeypatch.setattr("flexor.model.chunks.SIZE", 20)
    monkeypatch.setattr(
        "flexor.cli.progress.SearchProgress.__call__", lambda *_: processes.scheduler.kill()
    )
    address = cluster.address
    with pytest.raises(SystemExit) as ended:
        job = ["landscape", "finger", "--constants", "calibrated", "--grid", "20", "--out", "l s"]
        main([*job, "--cluster", address])
    assert ended.value.code == 3
    said = capsys.readouterr()
    assert said.out == ""
    assert said.err.splitlines() == [
        f'error: the cluster "{address}" was lost: its scheduler no longer answers.',
        "Everything evaluated so far is saved. To resume:",
        "  flexor landscape --resume 'l s'",
    ]
    with pytest.raises(ClusterError, match=r"was lost: its scheduler no longer answers\.$"):
        cluster.evaluate(local.problem, local.record.designs()[:1])
    opened = Study.open(tmp_path / "l s")
    assert 0 < opened.evaluations < 400
    assert opened.finished is None
    opened.close()
    assert content(resume_landscape(tmp_path / "l s").study) == content(local)


def test_one_worker_of_its_own() -> None:
    with Cluster("local:1") as cluster:
        study = optimize(flexor.load("finger", "calibrated"), "L", budget=20, executor=cluster)
        with pytest.raises(InputError, match=r"executor is a Client: .* client\.get_executor\(\)"):
            optimize(study.problem.model, "L", executor=cluster._client)
    assert content(study) == content(optimize(flexor.load("finger", "calibrated"), "L", budget=20))
