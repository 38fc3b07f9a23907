"""Mesh adaptive direct search, from NOMAD (an extra)."""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from typing import IO, Any

import numpy as np

from flexor.optimizers.method import Method, Run
from flexor.optimizers.options import FRACTION, option

# The budget is enforced by BudgetedEvaluator, not by NOMAD.
UNLIMITED = 10_000_000


@dataclass(frozen=True)
class Mads(Method):
    """Mesh adaptive direct search (Audet and Dennis 2006), as implemented in NOMAD 4.

    Polls along an asymptotically dense set of directions, with quadratic-model searches between
    polls. Each run uses a separate process.

    Attributes
    ----------
    models : bool
        Use quadratic models, which costs a few milliseconds per design.
    mesh : float
        Stop when the mesh size, as a fraction of the ranges, falls below this.
    """

    name = "mads"
    title = "MADS"
    aliases = ("nomad",)
    description = "mesh adaptive direct search with quadratic models"
    packages = ("PyNomadBBO",)

    models: bool = True
    mesh: float = option(1e-7, FRACTION)

    def run(self, run: Run) -> str:
        """Poll until the mesh reaches its tolerance."""
        starts = run.starts(1)
        start = starts[int(np.argmin(run.values(starts)))]
        run.step("start")
        parameters = [
            "BB_OUTPUT_TYPE OBJ",
            "DISPLAY_DEGREE 0",
            f"MAX_BB_EVAL {UNLIMITED}",
            f"SEED {run.seed % 2**31}",
            f"MIN_MESH_SIZE * {self.mesh:g}",
            f"BB_MAX_BLOCK_SIZE {max(2 * run.size, 2)}",
            "NB_THREADS_PARALLEL_EVAL 1",
        ]
        # The simple model search is more than twice as fast as the default and as effective.
        parameters += ["QUAD_MODEL_SEARCH no"] + (
            ["QUAD_MODEL_SEARCH_SIMPLE_MADS yes", "DIRECTION_TYPE ORTHO N+1 NEG"]
            if self.models
            else ["DIRECTION_TYPE ORTHO 2N"]
        )
        with _nomad_process() as (process, stderr):
            _send(process, {"start": start.tolist(), "parameters": parameters})
            assert process.stdout is not None
            for line in process.stdout:
                message = json.loads(line)
                if "ended" in message:
                    return f"the mesh is below {self.mesh:g}"
                values = run.values(np.array(message["points"]))
                _send(process, [v if np.isfinite(v) else None for v in values.tolist()])
                run.step("polling")
            stderr.seek(0)
            message = stderr.read().decode(errors="replace").strip()
        raise RuntimeError(f"NOMAD exited unexpectedly: {message or 'no error message'}")


@contextmanager
def _nomad_process() -> Iterator[tuple[subprocess.Popen[str], IO[bytes]]]:
    """Run a NOMAD process for the duration of the context; yield it and its stderr."""
    with tempfile.TemporaryFile() as stderr:
        process = subprocess.Popen(
            [sys.executable, "-m", "flexor.optimizers.mads_process"],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=stderr,
            text=True,
            encoding="ascii",
        )
        try:
            yield process, stderr
        finally:
            process.kill()
            for pipe in (process.stdin, process.stdout):
                with suppress(OSError):
                    pipe.close()  # type: ignore[union-attr]
            process.wait()


def _send(process: subprocess.Popen[str], message: Any) -> None:
    assert process.stdin is not None
    # A dead process is detected when its reply is missing.
    with suppress(BrokenPipeError):
        process.stdin.write(json.dumps(message) + "\n")
        process.stdin.flush()
