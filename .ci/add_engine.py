"""Put the engine of a wheel beside the package, for the wheel that is built next.

python .ci/add_engine.py avx2 WHEEL
"""

from __future__ import annotations

import sys
import zipfile
from pathlib import Path

PACKAGE = Path(__file__).resolve().parent.parent / "python" / "flexor"
BUILT = "flexor/_engine_baseline"


def add_engine(build: str, wheel: Path) -> Path:
    """Copy the compiled module out of a wheel, under the name of a build; return the copy."""
    with zipfile.ZipFile(wheel) as archive:
        (name,) = (name for name in archive.namelist() if name.startswith(BUILT))
        copy = PACKAGE / name.removeprefix("flexor/").replace("_baseline", f"_{build}")
        copy.write_bytes(archive.read(name))
    return copy


if __name__ == "__main__":
    print(add_engine(sys.argv[1], Path(sys.argv[2])))
