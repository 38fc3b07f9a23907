"""Profile of the engine: samples of `perf` by part of the engine.

Requires Linux with `perf` and `addr2line`. A build of the engine with symbols (in `target/profile`;
a few minutes the first time) evaluates the finger on one thread. Each sample is attributed to the
innermost function that belongs to a specific part; small products and group operations count for
their callers.
"""

from __future__ import annotations

import argparse
import re
import shutil
import statistics
import subprocess
import sys
import tempfile
from collections import Counter
from collections.abc import Iterator
from importlib.machinery import ExtensionFileLoader
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path

from _section import Missing, Section, table
from _timing import progress

ROOT = Path(__file__).resolve().parents[1]
TARGET = ROOT / "target" / "profile"
FREQUENCY = 2_000  # Hz
# Elements of the exosuit, and numbers of designs that take about the same time.
LOADS = ((10, 4_000), (80, 400), (320, 60))
QUICK_LOADS = ((10, 1_500), (80, 100))
# Part, file, function: the first match counts, from the innermost inlined function outward.
PARTS: tuple[tuple[str, str, str], ...] = (
    ("geometry of designs", "forces/", "update_design"),
    ("contact", "forces/contact/", ""),
    ("actuator", "forces/actuator/", ""),
    ("elasticity, joints and other potentials", "forces/", "::add"),
    ("solutions with the factor", "linalg/cholesky.rs", "solve"),
    ("solutions with the factor", "linalg/chain.rs", "solve"),
    ("factorisation", "linalg/cholesky.rs", ""),
    ("factorisation", "linalg/chain.rs", ""),
    ("kinematics", "kinematics.rs", ""),
    ("residual: wrenches pulled back to coordinates", "assembly/motions.rs", "pull_back"),
    ("tangent: columns and curvature of each motion", "assembly/motions.rs", "expand"),
    ("tangent: pairs of coordinates", "assembly/accumulate.rs", ""),
    ("tangent: symmetry", "assembly/mod.rs", "symmetrise"),
    ("tangent: contact between bodies", "assembly/mod.rs", "carry_couplings"),
    ("tangent: contact between bodies", "assembly/mod.rs", "keep_jacobians"),
    ("assembly: the rest", "assembly/", ""),
    ("geometry of designs", "design.rs", ""),
    ("geometry of designs", "geometry.rs", ""),
    ("solver: trust region, prediction, tests", "equilibrium/", ""),
    ("gathering of results", "batch.rs", ""),
    ("small products and groups, not inlined", "linalg/", ""),
    ("small products and groups, not inlined", "lie/", ""),
)


CLEARING = -1  # in place of an address


def main() -> int:
    """Run the benchmark and print its report."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--runs", type=int, default=3, help="number of runs; medians are reported")
    parser.add_argument("--quick", action="store_true", help="shorter runs")
    parser.add_argument("--load", nargs=3, help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.load:
        follow(Path(options.load[0]), int(options.load[1]), int(options.load[2]))
        return 0
    try:
        section = measure(options.runs, quick=options.quick)
    except Missing as missing:
        print(f"error: {missing}", file=sys.stderr)
        return 2
    section.report()
    return 0


def measure(runs: int, *, quick: bool) -> Section:
    """Profile all sizes; return the report."""
    for tool in ("perf", "addr2line", "cargo"):
        if shutil.which(tool) is None:
            raise Missing(f"{tool} is required to profile the engine, but not installed.")
    loads = QUICK_LOADS if quick else LOADS
    with tempfile.TemporaryDirectory() as folder:
        engine = build_with_symbols(Path(folder))
        samples = dict[int, list[Counter[int]]]()
        with progress() as bar:
            for elements, designs in loads:
                turns = bar.track(range(runs), description=f"profile, {elements} elements")
                samples[elements] = [sample(engine, elements, designs) for _ in turns]
        shares = list(part_shares(engine, samples))
    made = table("part", *(f"{2 * elements + 5} DOF" for elements, _ in loads))
    order = {name for share in shares for name in share}
    for part in sorted(order, key=lambda part: -shares[0].get(part, 0.0)):
        if any(share.get(part, 0.0) >= 0.002 for share in shares):
            made.add_row(part, *(f"{share.get(part, 0.0):.1%}" for share in shares))
    section = Section("Profile", "./dev bench hotspots" + " --quick" * quick)
    section.parts += [
        "Samples of processor time (`perf`) by component of the engine, for random designs of "
        "finger and exosuit from 0 to 5 N on one thread, with the paper's discretisation and finer "
        "ones:",
        made,
    ]
    return section


def build_with_symbols(folder: Path) -> Path:
    """Build the engine with symbols, and return the extension module."""
    build = ("build", "--quiet", "--release", "--locked", "--package", "flexor-bindings")
    symbols = ("--config", "profile.release.debug='line-tables-only'")
    options = ("--target-dir", str(TARGET), "--config", "profile.release.strip=false", *symbols)
    if subprocess.run(["cargo", *build, *options], cwd=ROOT, check=False).returncode:
        raise Missing("cargo could not build the engine with symbols.")
    module = folder / "_engine_native.abi3.so"
    shutil.copy(TARGET / "release" / "lib_engine.so", module)
    return module


def follow(module: Path, elements: int, designs: int) -> None:
    """Evaluate random designs with the engine in a file: the sampled program."""
    name = "flexor._engine_native"
    spec = spec_from_file_location(name, module, loader=ExtensionFileLoader(name, str(module)))
    assert spec is not None and spec.loader is not None
    engine = module_from_spec(spec)
    spec.loader.exec_module(engine)
    sys.modules["flexor._engine"] = engine
    from _random_designs import random_designs
    from _rods import finger

    model = finger(elements)
    model.evaluate(random_designs(model, designs), threads=1)


def sample(module: Path, elements: int, designs: int) -> Counter[int]:
    """Sample one run; return the count of each address of the engine (`CLEARING`: of libc)."""
    data = module.parent / "samples"
    command = [sys.executable, __file__, "--load", str(module), str(elements), str(designs)]
    record = ["perf", "record", "-q", "-e", "cpu-clock:u", "-F", str(FREQUENCY), "-o", str(data)]
    done = subprocess.run([*record, *command], capture_output=True, text=True, check=False)
    if done.returncode:
        raise Missing(f"perf could not record: {done.stderr.strip() or 'no message'}")
    fields = ["perf", "script", "-i", str(data), "-F", "ip,sym,dso", "--show-mmap-events"]
    lines = subprocess.run(fields, capture_output=True, text=True, check=True).stdout.splitlines()
    code = re.compile(r"\[0x(\w+)\(0x\w+\) @ (?:0x)?(\w+) .*r-xp .*_engine_native\.abi3\.so")
    base, addresses = 0, Counter[int]()
    for line in lines:
        if "PERF_RECORD_MMAP" in line:
            mapped = code.search(line)
            if mapped:
                base = int(mapped[1], 16) - virtual(module, int(mapped[2], 16))
        elif "_engine_native.abi3.so" in line:
            addresses[int(line.split()[0], 16) - base] += 1
        elif re.search(r"\b__mem(set|move|cpy)", line):
            addresses[CLEARING] += 1
    return addresses


def part_shares(module: Path, samples: dict[int, list[Counter[int]]]) -> Iterator[dict[str, float]]:
    """Yield, for each size, the share of every part (median of the runs)."""
    seen = {address for runs in samples.values() for run in runs for address in run}
    part_of = {a: part(stack) for a, stack in stacks(module, sorted(seen - {CLEARING})).items()}
    part_of[CLEARING] = "clearing and copying of memory"
    for runs in samples.values():
        shares = []
        for run in runs:
            counts = Counter[str]()
            for address, count in run.items():
                counts[part_of[address]] += count
            shares.append({name: count / sum(run.values()) for name, count in counts.items()})
        names = {name for share in shares for name in share}
        yield {n: statistics.median(share.get(n, 0.0) for share in shares) for n in names}


def virtual(module: Path, offset: int) -> int:
    """Return the virtual address of an offset in the file."""
    listed = subprocess.run(
        ["readelf", "-lW", str(module)], capture_output=True, text=True, check=True
    ).stdout
    for line in listed.splitlines():
        words = line.split()
        if words[:1] == ["LOAD"]:
            start, address, size = (int(word, 16) for word in (words[1], words[2], words[4]))
            if start - 4096 < offset <= start + size and "E" in words[6:-1]:
                return address + offset - start
    raise Missing("the engine's file has no code at the address that perf reports.")


def stacks(module: Path, addresses: list[int]) -> dict[int, list[tuple[str, str]]]:
    """Return functions and files of every address, from the innermost inlined function outward."""
    requests = "\n".join(f"{address:#x}" for address in addresses)
    command = ["addr2line", "-a", "-f", "-i", "-C", "-e", str(module)]
    output = subprocess.run(
        command, input=requests, capture_output=True, text=True, check=True
    ).stdout
    found: dict[int, list[tuple[str, str]]] = {}
    lines = iter(output.splitlines())
    for line in lines:
        if re.fullmatch(r"0x[0-9a-f]+", line):
            address = int(line, 16)
            found[address] = []
        else:
            found[address].append((line, next(lines)))
    return found


def part(stack: list[tuple[str, str]]) -> str:
    """Return the name of the part of the engine that a stack belongs to."""
    small = ("linalg/fixed.rs", "lie/")
    for function, file in stack:
        if "engine/src/" not in file or any(name in file for name in small):
            continue
        for name, where, what in PARTS:
            if f"engine/src/{where}" in file and what in function:
                return name
    if any("engine/src/" in file for _, file in stack):
        return "small products and groups, not inlined"
    return "the rest"


if __name__ == "__main__":
    sys.exit(main())
