"""Solve the actuators that have no results yet, and write the page of them all.

`python -m tests.validation.finite_elements [NAME ...]`; an interrupted run continues.
"""

from __future__ import annotations

import argparse
import json
import sys
import time
from pathlib import Path

from . import page, results
from .actuators import ACTUATORS, MESHES, Fineness, build
from .results import Results
from .states import Path as Equilibria

ROOT = Path(__file__).resolve().parents[3]
UNFINISHED = ROOT / "out" / "finite-elements"


def solve(name: str, mesh: str, fineness: Fineness) -> Results:
    """Follow an actuator on a mesh."""
    UNFINISHED.mkdir(parents=True, exist_ok=True)
    file = UNFINISHED / f"{name}-{mesh}.npz"
    settings = json.dumps(results.settings(ACTUATORS[name]))
    model = build(ACTUATORS[name], fineness)
    listed = ACTUATORS[name].pressures
    path = Equilibria(model, listed if mesh == "coarse" else listed[1::2])
    path.resume(file, settings)
    start = time.process_time()
    new = 0
    for state in path.follow():
        new += 1
        path.save(file, settings)
        print(
            f"{name}, {mesh}: {state.pressure:g} kPa, {state.angle:.2f}°, {state.force:.3f} N "
            f"({time.process_time() - start:.0f} s)",
            flush=True,
        )
    seconds = (time.process_time() - start) / max(new, 1)
    return {
        "nodes": len(model.mesh.points),
        "elements": len(model.mesh.cells),
        "unknowns": model.equilibrium.size,
        "seconds_per_state": round(seconds, 2),
        "end": path.end,
        **results.table(path.states),
    }


def main() -> int:
    """Run the command."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("names", nargs="*", metavar="NAME", help=", ".join(ACTUATORS))
    parser.add_argument("--mesh", choices=MESHES, help="this mesh only")
    options = parser.parse_args()
    unknown = set(options.names) - set(ACTUATORS)
    if unknown:
        parser.error(f"no actuator is named {min(unknown)} (there are: {', '.join(ACTUATORS)})")
    meshes = [options.mesh] if options.mesh else list(MESHES)
    for mesh in meshes:
        for name in options.names or ACTUATORS:
            found = results.read(name)
            if mesh not in found:
                results.write(name, found | {mesh: solve(name, mesh, MESHES[mesh])})
    page.write(ROOT / "docs" / "finite-elements.md")
    return 0


if __name__ == "__main__":
    sys.exit(main())
