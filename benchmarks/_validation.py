"""Model builders and reference rods that benchmarks share with `tests/validation/`."""

from __future__ import annotations

import sys
from pathlib import Path

sys.path.append(str(Path(__file__).resolve().parents[1] / "tests"))

from validation import systems
from validation import test_discrete_rod as discrete_rod

__all__ = ["discrete_rod", "systems"]
