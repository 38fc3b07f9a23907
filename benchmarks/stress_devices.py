"""Ten thousand random devices: rods of every section and law, with cavities under pressure.

As `stress_models`, with the same checks; devices that cannot be made are refused in one sentence,
which is counted.
"""

from __future__ import annotations

import sys

from _random_devices import Devices
from stress_models import main

if __name__ == "__main__":
    sys.exit(main(Devices, "devices"))
