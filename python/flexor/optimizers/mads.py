"""Mesh adaptive direct search, of NOMAD (an extra)."""

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

from flexor.optimizers.extras import need
from flexor.optimizers.method import Method, Run
from flexor.optimizers.options import require

# NOMAD counts failed designs too; ours is the budget that counts.
UNLIMITED = 10_000_000


@dataclass(frozen=True)
class Mads(Method):
    """Mesh adaptive direct search (Audet and Dennis 2006) by its authors' NOMAD 4.

    Polls in directions that grow dense, and searches on quadratic models between polls. Each run
    is a process of its own.

    Attributes
    ----------
    models : bool
        Whether to search on quadratic models, which takes some milliseconds for each design.
    mesh : float
        It ends when the mesh, as a fraction of the ranges, falls below this.
    """

    models: bool = True
    mesh: float = 1e-7

    def __post_init__(self) -> None:
        """Check the options and that NOMAD is installed.

        Raises
        ------
        InputError
            If one is out of its range or NOMAD is missing.
        """
        require(self.name, "mesh", self.mesh, 0.0 < self.mesh < 1.0, "between 0 and 1")
        need(self.name)

    @property
    def name(self) -> str:
        """``"mads"``."""
        return "mads"

    def run(self, run: Run) -> str:
        """Poll until the mesh is fine."""
        starts = run.starts(1, np.random.default_rng(run.seed))
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
        # The simple search on models takes less than half the time of the default, for as much.
        parameters += ["QUAD_MODEL_SEARCH no"] + (
            ["QUAD_MODEL_SEARCH_SIMPLE_MADS yes", "DIRECTION_TYPE ORTHO N+1 NEG"]
            if self.models
            else ["DIRECTION_TYPE ORTHO 2N"]
        )
        with _process() as (process, complaints):
            _say(process, {"start": start.tolist(), "parameters": parameters})
            assert process.stdout is not None
            for line in process.stdout:
                message = json.loads(line)
                if "ended" in message:
                    return f"the mesh is below {self.mesh:g}"
                values = run.values(np.array(message["points"]))
                _say(process, [v if np.isfinite(v) else None for v in values.tolist()])
                run.step("polling")
            complaints.seek(0)
            said = complaints.read().decode(errors="replace").strip()
        raise RuntimeError(f"NOMAD ended before it was done: {said or 'it did not say why'}")


@contextmanager
def _process() -> Iterator[tuple[subprocess.Popen[str], IO[bytes]]]:
    """Keep a NOMAD process, and what it writes to stderr, while in use."""
    with tempfile.TemporaryFile() as complaints:
        process = subprocess.Popen(
            [sys.executable, "-m", "flexor.optimizers.mads_process"],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=complaints,
            text=True,
            encoding="ascii",
        )
        try:
            yield process, complaints
        finally:
            process.kill()
            for pipe in (process.stdin, process.stdout):
                with suppress(OSError):
                    pipe.close()  # type: ignore[union-attr]
            process.wait()


def _say(process: subprocess.Popen[str], message: Any) -> None:
    assert process.stdin is not None
    # If it is gone, that is seen where its answer is missing.
    with suppress(BrokenPipeError):
        process.stdin.write(json.dumps(message) + "\n")
        process.stdin.flush()
