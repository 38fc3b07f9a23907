"""Write docs/measurements.md: `./dev measurements`."""

from __future__ import annotations

import sys
from pathlib import Path

from . import composite_strips, helical_robot, pneumatic_segment, silicone_beam, tentacle
from .page import write

SETS = (composite_strips, silicone_beam, tentacle, helical_robot, pneumatic_segment)


def main() -> int:
    """Compute every set and write the page."""
    folder = Path(sys.argv[1] if len(sys.argv) > 1 else "docs")
    measurements = []
    for module in SETS:
        found = module.run()
        for group in found.groups:
            print(f"{found.title}: {group.name}: mean {group.mean:.1%}, rms {group.rms:.2f}")
        measurements.append(found)
    print(f"written: {write(measurements, folder)}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
