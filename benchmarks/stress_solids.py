"""A thousand random designs of the strapped finger and 200 of each kind of section, made.

For each, the body and every part of its mould are written as STL and read again: each must be
watertight, consistently oriented and of positive volume; the body must have the volume of the
integral over its sections to 0.5 %; what is left free within the mould must be the body to 0.1 %;
and all of that must take less than 5 s of processor time. What cannot be made is refused in one
sentence, which is counted. The exit code is 1 if anything else happens.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
import time
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import trimesh
from _random_solids import FINGER, KINDS, Finger, rod
from rich.progress import track

from flexor.errors import InputError
from flexor.export import Body, Mould, body, mould, write_solid
from flexor.export.body import drills, void
from flexor.export.chambers import Chamber
from flexor.export.sheets import volumes
from flexor.export.solids import Solid, loft, rectangle, united

LONGEST = 5.0  # processor time of a design [s]
INTEGRAL, CAVITY = 5e-3, 1e-3


@dataclass
class Count:
    """What happened to the designs of one kind."""

    made: int = 0
    refused: Counter[str] = field(default_factory=Counter)
    seconds: list[float] = field(default_factory=list)
    integral: float = 0.0
    cavity: float = 0.0
    failures: list[str] = field(default_factory=list)


def main() -> int:
    """Make the designs and print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--fingers", type=int, default=1000)
    parser.add_argument("--rods", type=int, default=200, help="of each kind of section")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument(
        "--seconds", type=float, default=LONGEST, help="most processor time of a design"
    )
    options = parser.parse_args()
    finger = Finger()
    counts = {}
    for index, kind in enumerate((FINGER, *KINDS)):
        designs = options.fingers if kind == FINGER else options.rods
        if not designs:
            continue
        count = counts[kind] = Count()
        for number in track(range(designs), description=f"{kind:16s}", disable=designs < 50):
            random = np.random.default_rng([options.seed, index, number])
            examine(count, f"{kind} {number}", kind, random, finger, options.seconds)
    print(f"{options.fingers} fingers, {options.rods} rods of each section, seed {options.seed}")
    print("designs             made  refused  longest  volume  cavity - core")
    for kind, count in counts.items():
        print(
            f"{kind:16s} {count.made:7d}  {sum(count.refused.values()):7d}  "
            f"{max(count.seconds, default=0.0):5.2f} s  {count.integral:6.2%}  {count.cavity:8.3%}"
        )
        for sentence, many in count.refused.most_common(4):
            print(f"  refused {many}: {sentence}")
    failures = [failure for count in counts.values() for failure in count.failures]
    for failure in failures[:20]:
        print(failure)
    print(f"failures: {len(failures)}")
    return 1 if failures else 0


def examine(
    count: Count,
    name: str,
    kind: str,
    random: np.random.Generator,
    finger: Finger,
    longest: float,
) -> None:
    """Make one design and check it."""
    try:
        device = finger(random) if kind == FINGER else rod(kind, random)
    except InputError as error:  # its mechanics refuses it
        count.refused[shortened(error)] += 1
        return
    began = time.process_time()
    try:
        made = body(device)
        made_mould = mould(device)
    except InputError as error:
        count.refused[shortened(error)] += 1
        return
    except Exception as error:
        count.failures.append(f"{name}: {type(error).__name__}: {error}")
        return
    count.made += 1
    for part, solid in {"body": made.solid, **made_mould.printed()}.items():
        count.failures += [f"{name}, {part}: {what}" for what in faults(solid)]
    integral = abs(bare_volume(made) / (1e9 * sum(volumes(made).values())) - 1.0)
    cavity = abs(free_volume(made_mould) / made_mould.body.cast.volume() - 1.0)
    assembled = abs(assembled_volume(made) / made.solid.volume() - 1.0)
    overlap = overlaps(made_mould) / made_mould.body.cast.volume()
    seconds = time.process_time() - began
    count.integral, count.cavity = max(count.integral, integral), max(count.cavity, cavity)
    count.seconds.append(seconds)
    if integral > INTEGRAL:
        count.failures.append(f"{name}: the volume is {integral:.2%} off the integral")
    if cavity > CAVITY:
        count.failures.append(f"{name}: cavity less core is {cavity:.3%} off the body")
    if assembled > CAVITY:
        count.failures.append(f"{name}: its pieces have another volume, by {assembled:.3%}")
    if overlap > 1e-5:
        count.failures.append(f"{name}: parts of the mould overlap by {overlap:.1e} of the body")
    if seconds > longest:
        count.failures.append(f"{name}: {seconds:.1f} s")


def shortened(error: InputError) -> str:
    """Return a message without its numbers, so that equal ones are counted together."""
    return " ".join("#" if any(c.isdigit() for c in word) else word for word in str(error).split())


def faults(solid: Solid) -> list[str]:
    """Return what is wrong with a solid as it is in a file, which has coordinates of 32 bits."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "part.stl"
        write_solid(solid, file)
        mesh = trimesh.load_mesh(file)
    found = []
    if not mesh.is_watertight:
        found.append("not watertight")
    if not mesh.is_winding_consistent:
        found.append("not consistently oriented")
    if not mesh.volume > 0.0:
        found.append(f"volume {mesh.volume:g} mm³")
    if abs(mesh.volume / solid.volume() - 1.0) > 1e-4:
        found.append("another volume in the file")
    return found


def bare_volume(made: Body) -> float:
    """Volume of the body without caps, ears, inlets and walls between chambers [mm³]."""
    outside = sum(loft(part.x, part.outer).volume() for part in made.parts)
    inside = 0.0
    for part in made.parts:
        for name in part.cavities:
            whole = Chamber(name, float(part.x[0]), float(part.x[-1]), None)
            inside += sum(each.volume() for each in void(whole, [part]))
    return float(outside - inside)


def free_volume(made: Mould) -> float:
    """Volume within the closed mould that no part fills, between its end plates [mm³]."""
    room = []
    for part in made.body.parts:
        low, high = part.outer.min(axis=1), part.outer.max(axis=1)
        boxes = [rectangle((a[0], b[0]), (a[1], b[1])) for a, b in zip(low, high, strict=True)]
        room.append(loft(part.x, np.array(boxes)))
    region = united([*room, *(ear.solid for ear in made.body.ears)])
    filled = [made.lower, made.upper, *(core.solid for core in made.cores)]
    filled.append(made.holes - made.body.full)
    # Not by differences: where faces coincide, those of solids that touch leave spurious pieces.
    return float(region.volume() - sum((region ^ each).volume() for each in filled))


def overlaps(made: Mould) -> float:
    """Largest volume that two parts of a mould, or one and the body, have in common [mm³]."""
    parts = [made.lower, made.upper, *made.plates.values(), *(c.solid for c in made.cores)]
    parts.append(made.body.cast)
    return max(common(a, b) for i, a in enumerate(parts) for b in parts[:i])


def common(a: Solid, b: Solid) -> float:
    """Volume that two solids have in common [mm³], the least by three booleans.

    Of solids that touch in a face, each of these may return a spurious piece.
    """
    found = ((a ^ b).volume(), (b ^ a).volume(), a.volume() - (a - b).volume())
    return min(abs(float(volume)) for volume in found)


def assembled_volume(made: Body) -> float:
    """Volume of a body from the volumes of what it is made of [mm³]."""
    outer = united([loft(part.x, part.outer) for part in made.parts])
    total = outer.volume() + sum(cap.volume() for cap in made.caps.values())
    before = outer
    for ear in made.ears:
        total += ear.solid.volume() - (ear.solid ^ before).volume()
        before = before + ear.solid
    total -= sum((ear.slots ^ before).volume() for ear in made.ears)
    hollow = [piece for each in made.chambers for piece in void(each, made.parts)]
    total -= sum(piece.volume() for piece in hollow)
    for hole in drills(made):
        total -= (hole ^ united([outer, *made.caps.values()])).volume()
        total += sum((hole ^ piece).volume() for piece in hollow)
    return float(total)


if __name__ == "__main__":
    sys.exit(main())
