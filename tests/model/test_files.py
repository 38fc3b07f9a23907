"""Finding, reading and writing model files."""

from __future__ import annotations

import pathlib

import pytest

from flexor.errors import InputError, unknown
from flexor.model import parse, presets, read
from flexor.model.presets import locate

ROOT = pathlib.Path(__file__).parents[2]
ALL = ("exosuit-alone", "finger", "finger-2-links", "tendon-arm")

EVERYTHING = """
name = "everything"
gravity = { z = "-9.81 m/s^2" }

[bodies.arm]
kind = "rod"
length = "10 in"
radius = ["12 mm", "9 mm", "10 mm", "6 mm"]
section = { kind = "elliptic", ratio = 1.5 }
young_modulus = "29 psi"
poisson_ratio = 0.3
density = "1 g/cm^3"
strain = { bend_y = { basis = "chebyshev", order = 3 }, twist_x = "hermite" }
reference_strain = { bend_y = "1 deg/cm", extend_x = 1.1 }
elements = 2
gauss_points = 4
magnus_order = 2
placement = { x = "1 cm", rotation = { z = "30 deg" } }
joint = { kind = "spherical", stiffness = "0.1 N*m/rad" }

[bodies.hand]
kind = "link"
parent = "arm"
length = "4 cm"
radius = "1 cm"
joint = { kind = "free", linear_stiffness = ["1 N/m", "2 N/m", "3 N/m"] }

[bodies.tool]
kind = "link"
parent = "hand"
length = "4 cm"
radius = "1 cm"
joint = { kind = "universal", stiffness = ["0.1 N*m/rad", "0.2 N*m/rad"] }

[bodies.slider]
kind = "link"
length = "4 cm"
radius = "1 cm"
joint = { kind = "prismatic", axis = [1, 0, 1], upper = "1 cm", stiffness = "1 N/cm" }

[spheres.all]
bodies = ["arm", "hand"]
points = [{ body = "arm", at = 0.5 }, { body = "tool", at = 0.25 }, { body = "arm", point = 3 }]

[contacts.self]
first = "all"
second = "all"
stiffness = "1 N/mm"
skip = 3

[actuators.tendon]
kind = "cable"
rod = "arm"
path = { radius = "4 mm", turn = "180 deg" }

[actuators.chamber]
kind = "chamber"
rod = "arm"
path = { y = ["1 mm", "2 mm", "1 mm"], z = "3 mm" }
lever = { y = 0.5, z = -0.5 }

[springs.strap]
first = { body = "hand", at = "tip", offset = { z = "1 cm" } }
second = { world = { x = "1 m" } }
stiffness = "10 N/m"
rest_length = "5 cm"
slack = true

[springs.band]
first = { body = "hand", at = "centroid" }
second = { body = "arm", at = "base" }
stiffness = "10 N/m"

[wrenches.push]
body = "tool"
at = "tip"
force = { z = "-1 N" }
moment = { x = "1 N*mm" }
frame = "body"
input = true

[design]
rod = "arm"
length_bounds = ["5 in", "15 in"]
radius_bounds = ["5 mm", "15 mm"]
minimum_radius = "4 mm"

[evaluation]
force = "2 N"
step = "500 mN"
"""


def test_presets_are_the_examples() -> None:
    assert presets() == ALL
    files = sorted(file.stem for file in (ROOT / "examples").glob("*.toml"))
    # Targets of a calibration stand beside the models that they are about.
    assert tuple(name for name in files if not name.endswith("-targets")) == ALL


@pytest.mark.parametrize("name", ALL)
def test_presets_read_and_are_named_after_their_file(name: str) -> None:
    file = read(locate(name))
    assert file.name == name
    assert file.title


@pytest.mark.parametrize("name", ALL)
def test_presets_survive_writing(name: str) -> None:
    written = read(locate(name))
    for use in (None, *written.constants):
        file = read(locate(name), use=use)
        assert parse(file.to_toml()) == file


def test_everything_a_file_can_say_survives_writing() -> None:
    file = parse(EVERYTHING)
    written = file.to_toml()
    assert parse(written) == file
    assert parse(written).to_toml() == written
    assert 'length = "10 in"' in written


def test_a_changed_file_is_another_file() -> None:
    assert parse(EVERYTHING.replace("10 in", "10.0001 in")) != parse(EVERYTHING)


def test_examples_folder_is_found_from_anywhere(
    tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    assert locate("examples/finger.toml").samefile(locate("finger"))
    (tmp_path / "finger").write_text(EVERYTHING)
    assert locate("finger") == pathlib.Path("finger")  # a file there comes first
    (tmp_path / "examples").mkdir()
    (tmp_path / "examples" / "finger.toml").write_text(EVERYTHING)
    assert read(locate("examples/finger.toml")).name == "everything"


def test_near_miss_of_a_preset() -> None:
    with pytest.raises(InputError) as caught:
        locate("fingr")
    assert str(caught.value) == (
        'unknown preset "fingr" (did you mean "finger"?): allowed are "exosuit-alone", "finger", '
        '"finger-2-links", "tendon-arm", or the path of a model file.'
    )


@pytest.mark.parametrize("name", ["examples/fingr.toml", "nowhere.toml", "some/where"])
def test_missing_file(name: str, tmp_path: pathlib.Path) -> None:
    with pytest.raises(InputError) as caught:
        locate(str(tmp_path / name))
    assert str(caught.value) == (
        f'cannot read the model file "{tmp_path / name}": there is no such file.'
    )


def test_a_folder_is_no_model_file(tmp_path: pathlib.Path) -> None:
    with pytest.raises(InputError) as caught:
        locate(tmp_path)
    assert str(caught.value) == f'cannot read the model file "{tmp_path}": it is a folder.'


def test_binary_is_no_model_file(tmp_path: pathlib.Path) -> None:
    path = tmp_path / "image.toml"
    path.write_bytes(b'name = "\xff\xd8\xff"')
    with pytest.raises(InputError) as caught:
        read(path)
    assert str(caught.value) == f'cannot read the model file "{path}": byte 8 is not text in UTF-8.'


def test_deep_nesting_is_refused_and_not_a_crash() -> None:
    with pytest.raises(InputError, match="not valid TOML"):
        parse("a = " + "[" * 100_000)


@pytest.mark.parametrize("number", ["9" * 5000, "0x" + "f" * 5000])
@pytest.mark.parametrize(
    "line",
    [
        'length = "10 in"',
        "skip = 3",
        "poisson_ratio = 0.3",
        "elements = 2",
        "magnus_order = 2",
        "lever = { y = 0.5, z = -0.5 }",
    ],
)
def test_endless_numbers_are_refused_and_not_a_crash(line: str, number: str) -> None:
    assert EVERYTHING.count(line) == 1
    with pytest.raises(InputError) as caught:
        parse(EVERYTHING.replace(line, f"{line.split()[0]} = {number}"))
    assert len(str(caught.value)) < 300


def test_unknown_suggests_whatever_the_capitals() -> None:
    assert str(unknown("parameter set", "l+r01", ["L", "R01", "L+R01"])) == (
        'unknown parameter set "l+r01" (did you mean "L+R01"?): allowed are "L", "R01", "L+R01".'
    )
    assert str(unknown("objective", "zzz", ["bending"])) == (
        'unknown objective "zzz": allowed is "bending".'
    )
