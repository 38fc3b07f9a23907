"""A thousand random designs of the strapped finger and 200 of each kind of section, made.

For each, the body and every part of its mould are written as STL and read again: each must be
watertight, consistently oriented and of positive volume; the body must have the volume of the
integral over its sections to 0.5 %; what is left free within the mould must be the body to 0.1 %;
and all of that must take less than 5 s of processor time. What cannot be made is refused in one
sentence, which is counted. The exit code is 1 if anything else happens.

A design depends on the seed, its kind and its number only. Each result is appended to `--state`,
and the same command resumes from there; `--first n --fingers 1 --rods 0` repeats the finger n.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import sys
import tempfile
import time
from collections import Counter
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import trimesh
from _random_solids import FINGER, KINDS, Finger, rod
from rich.progress import track

import flexor
from flexor.errors import InputError
from flexor.export import Body, Mould, body, mould, write_solid
from flexor.export.body import drills, void
from flexor.export.chambers import Chamber
from flexor.export.sheets import volumes
from flexor.export.solids import Solid, loft, rectangle, united

LONGEST = 5.0  # processor time of a design [s]
INTEGRAL, CAVITY = 5e-3, 1e-3
NOTHING = 1e-5  # of the body: the error of booleans of solids that touch


@dataclass
class Result:
    """What happened to one design."""

    refused: str | None = None  # the sentence
    seconds: float = 0.0
    integral: float = 0.0
    cavity: float = 0.0
    failures: list[str] = field(default_factory=list)


class Results:
    """The results so far, by seed, kind and number: one line of a file each."""

    def __init__(self, file: Path) -> None:
        self.file = file
        self.known: dict[tuple[int, str, int], Result] = {}
        written = file.read_bytes() if file.exists() else b""
        whole = written[: written.rfind(b"\n") + 1]
        if whole != written:  # a process was killed while it wrote
            file.write_bytes(whole)
        rows = [json.loads(line) for line in whole.splitlines()]
        code = {"code": fingerprint()}
        if not rows:
            self._append(code)
        elif rows[0] != code:
            sys.exit(f'error: "{file}" is of other code: choose another --state to start again.')
        for row in rows[1:]:
            of = tuple(row.pop("of"))
            self.known[of] = Result(**row)

    def add(self, of: tuple[int, str, int], result: Result) -> None:
        """Keep the result of one design."""
        self.known[of] = result
        self._append({"of": of, **asdict(result)})

    def _append(self, row: dict[str, Any]) -> None:
        with self.file.open("a", encoding="utf-8", newline="\n") as file:
            file.write(json.dumps(row) + "\n")


def fingerprint() -> str:
    """Return the version and the first digits of a hash of what makes and draws solids."""
    package = Path(flexor.__file__).parent
    files = [
        *(package / "export").glob("*.py"),
        *(package / "sections").glob("*.py"),
        *Path(__file__).parent.glob("*_solids.py"),
        package / "examples" / f"{FINGER}.toml",
    ]
    found = hashlib.sha256(b"".join(file.read_bytes() for file in sorted(files)))
    return f"{flexor.__version__}, {found.hexdigest()[:12]}"


def main() -> int:
    """Make the remaining designs and print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--fingers", type=int, default=1000)
    parser.add_argument("--rods", type=int, default=200, help="of each kind of section")
    parser.add_argument("--first", type=int, default=0, help="number of the first of each kind")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument(
        "--seconds", type=float, default=LONGEST, help="most processor time of a design"
    )
    parser.add_argument("--state", type=Path, default=Path("stress-solids.jsonl"))
    options = parser.parse_args()
    results = Results(options.state)
    finger = Finger()
    print(f"{options.fingers} fingers, {options.rods} rods of each section, seed {options.seed}")
    print("designs             made  refused  longest  volume  cavity - core")
    failures = []
    for index, kind in enumerate((FINGER, *KINDS)):
        designs = options.fingers if kind == FINGER else options.rods
        numbers = range(options.first, options.first + designs)
        for number in track(numbers, description=f"{kind:16s}", disable=designs < 50):
            if (options.seed, kind, number) not in results.known:
                random = np.random.default_rng([options.seed, index, number])
                results.add((options.seed, kind, number), examine(kind, random, finger))
        if designs:
            found = {n: results.known[options.seed, kind, n] for n in numbers}
            report(kind, list(found.values()))
            for number, each in found.items():
                slow = [f"{each.seconds:.1f} s"] if each.seconds > options.seconds else []
                failures += [f"{kind} {number}: {what}" for what in each.failures + slow]
    for failure in failures[:20]:
        print(failure)
    print(f"failures: {len(failures)}")
    return 1 if failures else 0


def report(kind: str, found: list[Result]) -> None:
    """Print the row of one kind, and the sentences with which its designs were refused."""
    refused = Counter(each.refused for each in found if each.refused)
    print(
        f"{kind:16s} {len(found) - refused.total():7d}  {refused.total():7d}  "
        f"{max(each.seconds for each in found):5.2f} s  "
        f"{max(each.integral for each in found):6.2%}  {max(each.cavity for each in found):8.3%}",
        flush=True,
    )
    for sentence, many in refused.most_common(4):
        print(f"  refused {many}: {sentence}")


def examine(kind: str, random: np.random.Generator, finger: Finger) -> Result:
    """Make one design and check it."""
    result = Result()
    began = time.process_time()
    try:
        device = finger(random) if kind == FINGER else rod(kind, random)
        began = time.process_time()
        made = body(device)
        made_mould = mould(device)
    except InputError as error:
        return Result(refused=shortened(error), seconds=time.process_time() - began)
    except Exception as error:
        return Result(failures=[f"{type(error).__name__}: {error}"])
    for part, solid in {"body": made.solid, **made_mould.printed()}.items():
        result.failures += [f"{part}: {what}" for what in faults(solid)]
    result.integral = abs(bare_volume(made) / (1e9 * sum(volumes(made).values())) - 1.0)
    result.cavity = abs(free_volume(made_mould) / made_mould.body.cast.volume() - 1.0)
    assembled = abs(assembled_volume(made) / made.solid.volume() - 1.0)
    shared = overlap(made_mould)
    result.seconds = time.process_time() - began
    if result.integral > INTEGRAL:
        result.failures.append(f"the volume is {result.integral:.2%} off the integral")
    if result.cavity > CAVITY:
        result.failures.append(f"cavity less core is {result.cavity:.3%} off the body")
    if assembled > CAVITY:
        result.failures.append(f"its pieces have another volume, by {assembled:.3%}")
    if shared > NOTHING:
        result.failures.append(f"parts of the mould overlap by {shared:.1e} of the body")
    return result


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


def overlap(made: Mould) -> float:
    """Largest volume that two parts of a mould, or one and the body, have in common.

    As a share of the body's volume.
    """
    parts = [made.lower, made.upper, *made.plates.values(), *(c.solid for c in made.cores)]
    parts.append(made.body.cast)
    whole = float(made.body.cast.volume())
    pairs = ((a, b) for i, a in enumerate(parts) for b in parts[:i])
    return max(common(a, b, NOTHING * whole) for a, b in pairs) / whole


def common(a: Solid, b: Solid, nothing: float) -> float:
    """Volume that two solids have in common [mm³]: the first below `nothing`, or the least.

    Of solids that touch in a face, each of these booleans may return a spurious piece.
    """
    least = abs(float((a ^ b).volume()))
    if least > nothing:
        least = min(least, abs(float((b ^ a).volume())))
    if least > nothing:
        least = min(least, abs(float(a.volume() - (a - b).volume())))
    return least


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
