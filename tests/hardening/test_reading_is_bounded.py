"""Files that would take a time or memory out of proportion to their size."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from pathlib import Path

import pytest

import flexor
from flexor.calibration import read as read_targets
from flexor.errors import InputError
from flexor.exchange.xml import read_xml
from flexor.export.bench import bench
from flexor.model.toml import MAX_BYTES, MAX_DEPTH, tables


def chain(links: int) -> str:
    bodies = [
        f'[bodies.b{i}]\nkind = "link"\nlength = "1 cm"\nradius = "1 mm"\n'
        + (f'parent = "b{i - 1}"\n' if i else "")
        for i in range(links)
    ]
    return 'name = "chain"\n' + "".join(bodies)


ROD = """
name = "rod"
[bodies.{name}]
kind = "rod"
length = "10 cm"
radius = "1 cm"
young_modulus = "1 MPa"
poisson_ratio = 0.5
elements = {elements}
gauss_points = {points}
strain = {{ bend_y = "nodal_linear" }}
[spheres.s]
bodies = ["{name}"]
"""
TOUCHING = '[contacts.c]\nfirst = "s"\nsecond = "s"\nstiffness = "10 N/m"\nskip = 2\n'


def refusal(tmp_path: Path, text: str) -> str:
    file = tmp_path / "m.toml"
    file.write_text(text)
    began = time.process_time()
    with pytest.raises(InputError) as caught:
        flexor.load(file)
    assert time.process_time() - began < 20.0
    return str(caught.value)


@pytest.mark.parametrize(
    "key",
    ["a" + ".a" * 49_000, "a" + " . 'a.b'" * 9_000, 'x = {a = """b"""", c' + ".d" * 4_000],
    ids=["bare", "quoted", "after a multi-line string"],
)
def test_a_long_dotted_key_is_refused_at_once(tmp_path: Path, key: str) -> None:
    said = refusal(tmp_path, f'name = "x"\n{key} = 1')
    assert "line 2: a dotted key has more than 30 parts" in said


@pytest.mark.parametrize(
    "text",
    [
        'x = "' + "a." * 100 + '"',
        "x = '''" + "a." * 100 + "'''",
        'x = """\\"""' + "a." * 100 + '"""',
        "# " + "a." * 100,
        "a." * (MAX_DEPTH - 2) + "b = 1",
        '"' + "a." * 100 + '" = 1',
    ],
)
def test_dots_elsewhere_are_not_counted(text: str) -> None:
    assert tables(text, "m") == tables(text, "m")


@pytest.mark.parametrize("text", ['x = "' + '\\"' * 50_000, '"""' + '\\"' * 50_000, "'" * 100_000])
def test_unclosed_strings_take_linear_time(text: str) -> None:
    began = time.process_time()
    with pytest.raises(InputError, match="not valid TOML"):
        tables(text, "m")
    assert time.process_time() - began < 5.0


def test_a_long_chain_is_read_in_linear_time(tmp_path: Path) -> None:
    assert "5,000 entries: at most 2,000" in refusal(tmp_path, chain(5000))
    file = tmp_path / "chain.toml"
    file.write_text(chain(1000))
    assert len(flexor.load(file).file.bodies) == 1000


def test_few_lines_do_not_ask_for_gigabytes(tmp_path: Path) -> None:
    said = refusal(tmp_path, ROD.format(name="a", elements=1000, points=30) + TOUCHING)
    assert "contacts.c has too many pairs of spheres" in said
    several = "".join(
        ROD.format(name=f"r{i}", elements=1000, points=30)
        .split("[spheres")[0]
        .replace('name = "rod"\n', "" if i else 'name = "rod"\n')
        for i in range(10)
    )
    assert "sample points" in refusal(tmp_path, several)


def test_many_sets_of_constants(tmp_path: Path) -> None:
    sets = "".join(f'[constants.s{i}.bodies.b0]\nlength = "2 cm"\n' for i in range(2000))
    assert "2,000 sets: at most 50" in refusal(tmp_path, chain(1) + sets)


def test_large_files(tmp_path: Path) -> None:
    said = refusal(tmp_path, "#" * (MAX_BYTES + 1))
    assert "more than 10 MB" in said


MODES = ("bend_y", "bend_z", "twist_x", "shear_y", "shear_z", "extend_x")


def rods(count: int, elements: int, basis: str) -> str:
    modes = ", ".join(f'{mode} = "{basis}"' for mode in MODES)
    each = "".join(
        ROD.format(name=f"r{i}", elements=elements, points=4)
        .replace('bend_y = "nodal_linear"', modes)
        .split("[spheres")[0]
        .replace('name = "rod"\n', "")
        for i in range(count)
    )
    return f'name = "rods"\n{each}'


def test_a_tangent_fits_into_memory(tmp_path: Path) -> None:
    said = refusal(tmp_path, rods(10, 1000, "nodal_cubic"))
    assert "bodies have 180,060 strains: at most 10,000" in said


@pytest.mark.parametrize("basis", ["nodal_linear", "nodal_quadratic", "nodal_cubic", "hermite"])
def test_strains_are_counted_as_the_engine_does(tmp_path: Path, basis: str) -> None:
    file = tmp_path / "m.toml"
    file.write_text(rods(2, 3, basis))
    model = flexor.load(file)
    counted = sum(
        mode.size(rod.elements)
        for rod in map(model.file.rod, model.rods)
        for mode in rod.strain.modes.values()
    )
    assert counted == model.dof


LIMITED = """
import resource, sys
import numpy as np
import flexor
from flexor.design import parameter_set
model = flexor.load("finger")
pages = int(open("/proc/self/statm").read().split()[0])
limit = pages * resource.getpagesize() + 300_000_000
resource.setrlimit(resource.RLIMIT_AS, (limit, limit))
chosen = parameter_set("L", model.design)
def many():
    model.evaluate(chosen.geometry(np.full((20_000, 1), 0.1), model.X), "0:5:0.01", 1)
def steps():
    model.equilibrium("0:5:0.00001", max_seconds=1)
try:
    {"many": many, "steps": steps}[sys.argv[1]]()
except MemoryError:
    sys.exit(7)
"""


@pytest.mark.skipif(sys.platform != "linux", reason="limits of memory")
@pytest.mark.parametrize("what", ["many", "steps"])
def test_arrays_too_large_are_a_memory_error(what: str) -> None:
    done = subprocess.run([sys.executable, "-c", LIMITED, what], capture_output=True, text=True)
    assert done.returncode == 7, done.stderr
    assert done.stderr == ""


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="the system has no pipes with names")
def test_pipes_are_refused_not_waited_for(tmp_path: Path) -> None:
    pipe, model = tmp_path / "pipe", flexor.load("finger")
    os.mkfifo(pipe)
    for read in (
        lambda: model.equilibrium(1.0, start=pipe),
        lambda: read_targets(pipe),
        lambda: bench(model, pipe),
        lambda: read_xml(pipe),
    ):
        with pytest.raises(InputError, match=r'pipe".* it is not a regular file'):
            read()
