"""Description of the machine, printed with every benchmark."""

from __future__ import annotations

import os
import platform

import flexor

BUSY = 0.5


def machine() -> str:
    """Return versions, system and cores."""
    return (
        f"Flexor {flexor.__version__}, Python {platform.python_version()}, "
        f"{platform.system()} {platform.machine()}, {os.cpu_count()} cores"
    )


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
