"""Smoke test of an installed wheel: `python .ci/smoke.py [PATH]`, the expected engine build."""

from __future__ import annotations

import sys
from pathlib import Path

import flexor
from flexor._dispatch import engine_path

# Angles [rad] of the finger's joints at 5 N: `flexor simulate finger --constants calibrated`.
ANGLES = (0.3253484598804443, 0.1773547344754639, 0.039661380266032185)


def main() -> int:
    """Simulate, and compare with the numbers above."""
    checkout = Path(__file__).resolve().parent.parent
    if checkout in Path(flexor.__file__).parents and "site-packages" not in flexor.__file__:
        print(f"error: this is not an installed wheel: {flexor.__file__}", file=sys.stderr)
        return 1
    wanted = sys.argv[1] if len(sys.argv) > 1 else engine_path()
    if engine_path() != wanted:
        print(f"error: the engine is {engine_path()}, not {wanted}", file=sys.stderr)
        return 1
    path = flexor.load("finger", "calibrated").equilibrium(force=[0, 1, 2, 3, 4, 5])
    error = max(abs(path.joint_angles[-1] - ANGLES))
    if not path.stable.all() or not error < 1e-9:
        print(f"error: joint angles are off by {error:.1e} rad", file=sys.stderr)
        return 1
    print(f"flexor {flexor.__version__}, {engine_path()} engine: angles within {error:.1e} rad")
    return 0


if __name__ == "__main__":
    sys.exit(main())
