"""Where a benchmark ran: one line to print above its table."""

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
    """Return how many processes have wanted a core in the last minute; NaN if unknown."""
    return os.getloadavg()[0] if hasattr(os, "getloadavg") else float("nan")


def warning(load: float) -> str:
    """Return a sentence if the machine was not quiet when a benchmark began, or nothing.

    Parameters
    ----------
    load
        What `others` gave before it.
    """
    if not load > BUSY:
        return ""
    return (
        f"In the minute before this began {load:.1f} processes wanted the machine's "
        f"{os.cpu_count()} cores. If they went on, processor times and ratios are disturbed, and "
        "wall times and speeds are worth nothing."
    )
