"""Where a benchmark ran: one line to print above its table."""

from __future__ import annotations

import os
import platform

import flexor


def machine() -> str:
    """Return versions, system and cores."""
    return (
        f"Flexor {flexor.__version__}, Python {platform.python_version()}, "
        f"{platform.system()} {platform.machine()}, {os.cpu_count()} cores"
    )
