"""Repeat the calibration under alternative assumptions that the paper leaves open.

    python reproduction/choices.py [--out DIR] [NAME ...]

Each choice is one calibration of a targets file in this folder, with a separate results folder; it
is resumed if that exists. All of them take ten minutes on two cores. The table of constants,
angles and held-out optima is written to `choices.md`.
"""

from __future__ import annotations

import argparse
import re
import sys
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

import tomli_w

import flexor
from flexor.calibration import Calibration, calibrate
from flexor.errors import InputError
from flexor.model import Model
from flexor.model.toml import tables
from flexor.store import write_text

HERE = Path(__file__).resolve().parent
DESIGN, OPTIMUM = "paper-targets.toml", "paper-optimum-targets.toml"


@dataclass(frozen=True)
class Choice:
    """Targets, changes of both models and of each finger, and constants that are not fitted."""

    targets: str
    both: Mapping[str, object] = field(default_factory=dict)
    three: Mapping[str, object] = field(default_factory=dict)
    two: Mapping[str, object] = field(default_factory=dict)
    fixed: tuple[str, ...] = ()


AXIS = {"exosuit.placement.reference": "axis", "exosuit.placement.z": "3.32 cm"}
LIMITS = {f"ph_{i}.joint.limit_stiffness": "0.05 N*m/rad" for i in (1, 2, 3)}
LAST_MERGED = {
    "ph_12.length": "4.5 cm",
    "ph_12.radius": {"base": "2.16 cm", "tip": "1.39 cm"},
    "ph_3.length": "4.89 cm",
    "ph_3.radius": {"base": "1.39 cm", "tip": "0.87 cm"},
    "ph_3.joint.stiffness": "0.03 N*m/rad",
}
CHOICES = {
    "printed-design": Choice(DESIGN),
    "printed-design, base stays at 3.32 cm": Choice(DESIGN, both=AXIS),
    "printed-design, last two phalanges merged": Choice(DESIGN, two=LAST_MERGED),
    "optimum": Choice(OPTIMUM),
    "chamber on the surface": Choice(OPTIMUM, both={"chamber.lever": 1.0}, fixed=("lever",)),
    "base stays at 3.32 cm": Choice(OPTIMUM, both=AXIS),
    "base 1 cm along the finger": Choice(
        OPTIMUM, both={"exosuit.placement.x": "1 cm", "exosuit.placement.z": "1.99 cm"}
    ),
    "base 2 cm along the finger": Choice(
        OPTIMUM, both={"exosuit.placement.x": "2 cm", "exosuit.placement.z": "1.82 cm"}
    ),
    "base 1 cm behind the finger": Choice(OPTIMUM, both={"exosuit.placement.x": "-1 cm"}),
    "soft joint limits": Choice(
        OPTIMUM,
        three=LIMITS,
        two={f"ph_{i}.joint.limit_stiffness": "0.05 N*m/rad" for i in (12, 3)},
    ),
    "two joints: 0.03 N m/rad at the base": Choice(
        OPTIMUM, two={"ph_12.joint.stiffness": "0.03 N*m/rad"}
    ),
}


def prepare(name: str, choice: Choice, out: Path) -> tuple[Model, Path]:
    """Write the targets file of a choice into `out`; return the changed model and the file."""
    document = tables((HERE / choice.targets).read_text(encoding="utf-8"), choice.targets)
    document["title"] = f"{document['title']}: {name}"
    document["constant"] = [c for c in document["constant"] if c["name"] not in choice.fixed]
    document["models"] = {
        "finger-2-links": {"file": "finger-2-links", "set": {**choice.both, **choice.two}}
    }
    targets = out / f"{slug(name)}.toml"
    out.mkdir(parents=True, exist_ok=True)
    write_text(targets, tomli_w.dumps(document))
    return flexor.load("finger", changes={**choice.both, **choice.three}), targets


def slug(name: str) -> str:
    """Return a name as a file name."""
    return re.sub(r"\W+", "-", name)


def run(name: str, choice: Choice, out: Path) -> Calibration:
    """Calibrate with a choice in a subfolder of `out`, resuming it if it exists."""
    model, targets = prepare(name, choice, out)
    folder = out / slug(name)
    return calibrate(model, targets, folder=folder, resume=(folder / "settings.json").is_file())


def table(found: Mapping[str, Calibration]) -> str:
    """Return a Markdown table of constants, angles and held-out optima."""
    lines = [
        "| Choice | constants | the three angles | L+R01: L, R_0, R_1 | f_bc: L, R_0, R_1 |",
        "|---|---|---|---|---|",
    ]
    for name, calibration in found.items():
        best = calibration.best
        constants = ", ".join(
            f"{c.name} {c.shown(best.constants[c.name], 4)}" for c in best.problem.constants
        )
        values = {
            target.table.name: target.unit.shown(float(value[-1]), 3).split()[0]
            for target, value in zip(best.problem.targets, best.values, strict=True)
        }
        angles = ", ".join(
            f"{value[-1]:.3f}"
            for target, value in zip(best.problem.targets, best.values, strict=True)
            if target.hard
        )
        optima = [
            ", ".join(values[f"{of}: {part}"] for part in ("length", "base radius", "tip radius"))
            if best.met
            else ""
            for of in ("L+R01", "f_bc")
        ]
        met = "met: " if best.met else ""
        lines.append(f"| {name} | {constants} | {met}{angles} | {optima[0]} | {optima[1]} |")
    return "\n".join(lines) + "\n"


def main() -> int:
    """Run the choices named on the command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("names", nargs="*", metavar="NAME", help="choices (default: all)")
    parser.add_argument("--out", type=Path, default=Path("out/choices"), help="folder of results")
    options = parser.parse_args()
    unknown = [name for name in options.names if name not in CHOICES]
    if unknown:
        parser.error(f'unknown choice "{unknown[0]}"; expected one of: {", ".join(CHOICES)}')
    found = {}
    for name in options.names or CHOICES:
        print(name, file=sys.stderr, flush=True)
        try:
            found[name] = run(name, CHOICES[name], options.out)
        except InputError as error:
            print(f"error: {error}", file=sys.stderr)
            return 2
    text = table(found)
    write_text(options.out / "choices.md", text)
    print(text, end="")
    return 0


if __name__ == "__main__":
    sys.exit(main())
