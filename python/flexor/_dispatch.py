"""Which build of the engine is used: the fastest that this processor can run.

A wheel has the engine as `_engine_baseline`, which runs everywhere, and on x86-64 also as
`_engine_avx2` (x86-64-v3: AVX2 and FMA) and `_engine_avx512` (x86-64-v4). ``./dev setup`` builds
`_engine_native` for the machine it runs on. The environment variable ``FLEXOR_ENGINE`` overrides
the choice. Results with and without FMA differ in the last bits.
"""

from __future__ import annotations

import os
from functools import cache
from importlib import import_module
from importlib.util import find_spec
from types import ModuleType

from flexor.errors import InputError, alternatives

__all__ = ["ENGINES", "engine_path", "load_engine"]

ENGINES = ("native", "avx512", "avx2", "baseline")
_VARIABLE = "FLEXOR_ENGINE"


@cache
def load_engine() -> ModuleType:
    """Import the build of the engine that suits this processor, or the one asked for.

    InputError if ``FLEXOR_ENGINE`` names no build, one that is not installed, or one that this
    processor cannot run; ImportError if no build is installed.
    """
    there = [name for name in ENGINES if find_spec(f"flexor._engine_{name}") is not None]
    runs = _running(there)
    if not runs:
        raise ImportError("flexor is installed without its compiled engine; install it again")
    name = os.environ.get(_VARIABLE) or runs[0]
    if name not in ENGINES:
        raise InputError(f"the environment variable {_VARIABLE} is {alternatives(name, ENGINES)}")
    if name not in there:
        raise InputError(
            f'the environment variable {_VARIABLE} is "{name}", a build of the engine that is not '
            f"installed here (there is: {', '.join(there)})"
        )
    if name not in runs:
        raise InputError(
            f'the environment variable {_VARIABLE} is "{name}", a build of the engine that this '
            f"processor cannot run (it runs: {', '.join(runs)})"
        )
    return _build(name)


def engine_path() -> str:
    """Return the code path in use, one of `ENGINES`.

    Two paths may differ in the last bits of their results.
    """
    engine = load_engine()
    name = engine.__name__.rpartition("_")[2]
    # A baseline that somebody compiled for more than the baseline.
    return "native" if name == "baseline" and engine.FUSED_MULTIPLY_ADD else name


def _running(there: list[str]) -> list[str]:
    """Return those of the builds that this processor can run."""
    safe = [name for name in there if name in ("native", "baseline")]
    fast = _build(safe[-1]).cpu_runs() if safe else []
    return [name for name in there if name in safe or name in fast]


def _build(name: str) -> ModuleType:
    """Import a build of the engine."""
    return import_module(f"flexor._engine_{name}")
