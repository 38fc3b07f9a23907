"""Description of the machine, printed with every benchmark."""

from __future__ import annotations

import os
import platform
from pathlib import Path

import flexor

BUSY = 0.5


def machine() -> str:
    """Return versions, system, cores and processor."""
    return (
        f"Flexor {flexor.__version__}, Python {platform.python_version()}, "
        f"{platform.system()} {platform.machine()}, {os.cpu_count()} cores{_processor()}"
    )


def _processor() -> str:
    """Return the name of the processor in brackets; nothing where it is not known."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        return ""
    names = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    return f" ({names[0]})" if names else ""


def others() -> float:
    """Return the load average of the last minute; NaN if unknown."""
    return os.getloadavg()[0] if hasattr(os, "getloadavg") else float("nan")


def warning(load: float) -> str:
    """Return a warning if the machine was busy when a benchmark began, or an empty string.

    Parameters
    ----------
    load
        Result of `others` before the benchmark.
    """
    if not load > BUSY:
        return ""
    return (
        f"The load average before the start was {load:.1f} on {os.cpu_count()} cores. If other "
        "processes continued, processor times and ratios are disturbed, and wall times and speeds "
        "are meaningless."
    )
