"""Put the engine of a wheel built for AVX2 and FMA beside the package, for the wheel built next.

python .ci/add_engine.py WHEEL
"""

from __future__ import annotations

import sys
import zipfile
from pathlib import Path

PACKAGE = Path(__file__).resolve().parent.parent / "python" / "flexor"
BUILT = "flexor/_engine_baseline"


def add_engine(wheel: Path) -> Path:
    """Copy the compiled module out of a wheel, under the name for AVX2; return the copy."""
    with zipfile.ZipFile(wheel) as archive:
        (name,) = (name for name in archive.namelist() if name.startswith(BUILT))
        copy = PACKAGE / name.removeprefix("flexor/").replace("_baseline", "_avx2")
        copy.write_bytes(archive.read(name))
    return copy


if __name__ == "__main__":
    print(add_engine(Path(sys.argv[1])))
