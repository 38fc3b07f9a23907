"""Commands on models with several inputs."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

MODEL = """
name = "two-lines"
planar = true

[bodies.rod]
kind = "rod"
length = "6 cm"
radius = "8 mm"
young_modulus = "300 kPa"
poisson_ratio = 0.5
strain = { bend_y = "nodal_linear" }
elements = 2
gauss_points = 2

[bodies.bar]
kind = "link"
length = "4 cm"
radius = "1 cm"
joint = { kind = "revolute", stiffness = "0.05 N*m/rad" }

[springs.tie]
first = { body = "rod", at = "tip" }
second = { body = "bar", at = "tip" }
stiffness = "300 N/m"

[actuators.up]
kind = "chamber"
rod = "rod"
lever = 1.0

[actuators.down]
kind = "cable"
rod = "rod"
lever = -0.5

[design]
rod = "rod"
length_bounds = ["4 cm", "8 cm"]
radius_bounds = ["6 mm", "10 mm"]
minimum_radius = "5 mm"
"""
LOADS = ("--load", "up=0:2:1", "--load", "down=1 N")


def test_every_search_takes_the_loads_of_each_input(flexor, tmp_path: Path) -> None:
    (tmp_path / "two.toml").write_text(MODEL)
    options = ("two.toml", *LOADS)
    ran = flexor("optimize", *options, "-p", "R01", "--budget", "8", "--out", "a")
    assert ran.code == 0 and "At up 2 N, down 1 N the optimum bends" in ran.out
    settings = json.loads((tmp_path / "a" / "settings.json").read_text())
    assert settings["objective"]["force"] == [[0.0, 1.0], [1.0, 1.0], [2.0, 1.0]]
    assert flexor("optimize", "--resume", "a", "--budget", "10").code == 0
    assert flexor("landscape", *options, "-p", "R01", "--grid", "2", "--out", "b").code == 0
    compared = flexor(
        *("compare", *options, "-p", "R01", "--methods", "pattern-search"),
        *("--seeds", "1", "--budget", "8", "--out", "c"),
    )
    assert compared.code == 0, compared.err


@pytest.mark.parametrize("command", ["optimize", "landscape", "compare"])
@pytest.mark.parametrize(
    ("loads", "sentence"),
    [
        ([], "has 2 inputs: give the load of each"),
        (["--load", "up=5 kPa"], 'load of up is "5 kPa", which is not a force'),
        (["--load", "sideways=5"], 'unknown input "sideways"'),
        (["--load", "0:5:1"], 'force must name its input, one of "up", "down"'),
    ],
)
def test_one_sentence(
    flexor, tmp_path: Path, command: str, loads: list[str], sentence: str
) -> None:
    (tmp_path / "two.toml").write_text(MODEL)
    assert sentence in flexor(command, "two.toml", *loads).error
