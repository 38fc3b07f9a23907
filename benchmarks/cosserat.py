"""Experiments of cosseratbench, an independent suite of rod experiments, by Flexor and by others.

Errors are those of the suite's own metrics, with its resolution, and times are processor times of
one run after its warm-up. Its metric of `twist` is fitted to the growth of a disturbance in time.
Flexor, which is static, finds the twist where the straight rod becomes unstable instead, and
that is compared with the same reference. What a solver cannot do is said in its place.
"""

from __future__ import annotations

import argparse
import math
import sys
import time
from collections.abc import Callable, Sequence
from importlib.metadata import version
from typing import Any

import numpy as np
from _section import Missing, Section, table

from flexor.installing import install_command

SUITE = "cosseratbench"
# The suite describes ropes to MuJoCo as composites, which MuJoCo 4 no longer has.
PACKAGES = {"pyelastica": "pyelastica", "mujoco": "mujoco<4"}
EXPERIMENTS = ("cantilever", "catenary", "twist", "crossing", "capstan")
SOLVERS = ("flexor", "pyelastica", "mujoco")
UNITS = {"slide": "m"}  # others are relative


def main() -> int:
    """Run the benchmark and print its report."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--experiments", nargs="+", choices=EXPERIMENTS, default=EXPERIMENTS)
    parser.add_argument("--solvers", nargs="+", choices=SOLVERS, default=SOLVERS)
    arguments = parser.parse_args()
    try:
        section = measure(arguments.experiments, arguments.solvers)
    except Missing as missing:
        print(f"{missing} is not installed: install it with `{install_command(str(missing))}`.")
        return 1
    section.report()
    return 0


def measure(experiments: Sequence[str], solvers: Sequence[str]) -> Section:
    """Run experiments with solvers; return the report."""
    try:
        from cosseratbench.registry import load_experiment
    except ImportError:
        raise Missing(SUITE) from None
    section = Section("Independent suite", "./dev bench cosserat")
    runners, missing = dict[str, Any](), list[str]()
    for name in solvers:
        try:
            runners[name] = _solver(name)
        except ImportError:
            command = install_command(PACKAGES[name])
            missing.append(f"{name} is not installed and was skipped: install it with `{command}`.")
    columns = [f"{name} {solver.backend_version}" for name, solver in runners.items()]
    result = table("experiment", "metric", *columns, text=2)
    for name in experiments:
        experiment = load_experiment(name)
        tensions = (1.0, 10.0, 30.0) if name == "twist" else (None,)
        for tension in tensions:
            values = {} if tension is None else {"tension": tension}
            cells = [_cells(experiment, runner, values) for runner in runners.values()]
            metrics = [m for m in experiment.metrics if m != "settling_residual"]
            for metric in metrics:
                title = name if tension is None else f"{name}, tension {tension:g}"
                row = [cell(metric) for cell in cells]
                result.add_row(title, metric, *row)
    section.parts += [f"{SUITE} {version(SUITE)}", result, *missing]
    return section


def _solver(name: str) -> Any:
    if name == "flexor":
        from _cosserat_solver import Flexor

        return Flexor()
    from cosseratbench.registry import load_solver

    return load_solver(name)


def _cells(experiment: Any, solver: Any, values: dict[str, float]) -> Callable[[str], str]:
    """Run an experiment; return what to write for each metric."""
    from cosseratbench import run

    if solver.name == "flexor" and experiment.name == "twist":
        return _twist(experiment, values)
    if solver.name == "flexor" and experiment.name == "crossing":
        return _crossing(experiment)
    if solver.name == "flexor" and experiment.name == "capstan":
        return _capstan(experiment)
    timed = _Timed(solver)
    try:
        result = run(experiment, timed, values=values)
    except Exception as error:
        words = str(error).splitlines()[0]
        return lambda _: f"failed: {words}"
    if result.outcome != "completed":
        lacking = f"unsupported: {', '.join(result.missing)}".replace("_", " ")
        return lambda _: result.failure or lacking
    return lambda metric: _cell(result.metrics[metric], UNITS.get(metric, ""), timed.seconds)


def _twist(experiment: Any, values: dict[str, float]) -> Callable[[str], str]:
    from _cosserat_twist import critical_twist
    from cosseratbench.experiments import twist

    rod = experiment.scenario_for(**values).rods[-1]
    began = time.process_time()
    found = critical_twist(rod, experiment.n_elements)
    seconds = time.process_time() - began
    reference = twist.critical_twist(rod, values["tension"])
    return lambda _: _cell(abs(found / reference - 1.0), "", seconds)


def _crossing(experiment: Any) -> Callable[[str], str]:
    from _cosserat_crossing import crossed
    from _cosserat_model import placed

    scenario = experiment.scenario
    began = time.process_time()
    states, _ = crossed(*scenario.rods, scenario.gravity, experiment.n_elements)
    seconds = time.process_time() - began
    nodes = tuple(np.stack([placed(state)[0]]) for state in states)
    return lambda metric: _cell(_measured(experiment, metric, nodes), "", seconds)


def _capstan(experiment: Any) -> Callable[[str], str]:
    from _cosserat_capstan import laid
    from _cosserat_model import in_plane

    began = time.process_time()
    rope = laid(experiment.scenario, experiment.n_elements)
    seconds = time.process_time() - began
    if not rope.path.converged[0]:
        return lambda _: f"no equilibrium: {rope.path.status[0]}"
    nodes = (np.stack([rope.nodes, in_plane(rope.path[-1])]),)
    return lambda metric: _cell(_measured(experiment, metric, nodes), UNITS[metric], seconds)


def _measured(experiment: Any, metric: str, nodes: tuple[Any, ...]) -> float:
    """Return a metric of frames (T, n + 1, 3) of each rod."""
    from cosseratbench import Trajectory

    across = tuple(np.zeros_like(each[:, 1:]) for each in nodes)  # no metric here reads them
    times = np.arange(float(len(nodes[0])))
    return float(experiment.metrics[metric](experiment.scenario, Trajectory(times, nodes, across)))


def _cell(value: float, unit: str, seconds: float) -> str:
    if math.isnan(value):
        return f"not measurable, {seconds:.2g} s"
    number = f"{value:.2g} {unit}" if unit else f"{100.0 * value:.2g} %"
    return f"{number}, {seconds:.2g} s"


class _Timed:
    """A solver with the processor time of its last run."""

    def __init__(self, solver: Any) -> None:
        self._solver = solver
        self.name, self.capabilities = solver.name, solver.capabilities
        self.backend_version = solver.backend_version
        self.seconds = float("nan")

    def run(self, scenario: Any, *, n_elements: int, n_frames: int) -> Any:
        """Run it."""
        began = time.process_time()
        result = self._solver.run(scenario, n_elements=n_elements, n_frames=n_frames)
        self.seconds = time.process_time() - began
        return result


if __name__ == "__main__":
    sys.exit(main())
