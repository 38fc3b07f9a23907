from __future__ import annotations

import json
import re

import numpy as np
import pytest

import flexor as package
from flexor.cli.values import load_changed
from flexor.design import parameter_set


def test_json_is_one_object_with_the_path(flexor) -> None:
    ran = flexor("simulate", "finger", "--force", "0:5:1", "--json")
    assert ran.code == 0
    path = json.loads(ran.out)
    assert set(path) == {
        *("force", "joint_angles", "converged", "stable", "contacts", "tip_force", "events"),
        *("max_overlap", "places", "length"),
        *("coordinates", "q"),
    }
    assert path["force"] == [0, 1, 2, 3, 4, 5]
    expected = package.load("finger").equilibrium([0, 1, 2, 3, 4, 5])
    np.testing.assert_array_equal(path["joint_angles"], expected.joint_angles)
    assert all(path["converged"]) and all(path["stable"])


def test_the_table_shows_the_angles_of_the_path(flexor) -> None:
    ran = flexor("simulate", "finger", "--force", "0,2.5,5")
    assert ran.code == 0
    rows = [line.split() for line in ran.out.splitlines() if line.split()[:1] == ["2.5"]]
    angles = np.degrees(package.load("finger").equilibrium([0, 2.5, 5]).joint_angles[1])
    np.testing.assert_allclose([float(cell) for cell in rows[0][1:4]], angles, atol=0.005)
    assert float(rows[0][4]) == pytest.approx(angles.sum(), abs=0.005)


def test_no_digit_is_lost_in_a_narrow_terminal(flexor, monkeypatch) -> None:
    snapping = ["--set", "exosuit.radius.base=1.16 mm", "--set", "skin.stiffness=2000 N/m"]
    for width in ("40", "80", "200"):
        monkeypatch.setenv("COLUMNS", width)
        ran = flexor("simulate", "finger", *snapping)
        rows = [line.split() for line in ran.out.splitlines() if line.split()[:1] == ["3"]]
        assert rows, width  # in a narrow one there are several tables, angles in the first
        assert sum(map(float, rows[0][1:4])) == pytest.approx(float(rows[0][4]), abs=0.011), width
        assert "-0.00" not in ran.out


def test_a_model_without_joints_shows_where_its_tip_is(flexor) -> None:
    ran = flexor("simulate", "exosuit-alone", "--force", "0")
    assert ran.code == 0
    assert "10.00, 0.00," in ran.out


def test_a_branch_by_arc_length_has_a_table(flexor) -> None:
    ran = flexor("simulate", "finger", "--force", "0:2:1", "--follow", "arc-length")
    assert ran.code == 0, ran.err
    assert "stable" in ran.out


SLIDES = """
name = "slides"
planar = true

[bodies.cart]
kind = "link"
length = "1 cm"
radius = "1 mm"
joint = { kind = "prismatic", axis = "x", stiffness = "2 N/m" }

[wrenches.pull]
body = "cart"
at = "tip"
force = { x = "1 N" }
input = true

[wrenches.push]
body = "cart"
at = "tip"
force = { x = "-1 N" }
input = true
"""


def test_slides_have_a_column_and_several_inputs_rest_without_load(flexor, tmp_path) -> None:
    file = tmp_path / "slides.toml"
    file.write_text(SLIDES)
    ran = flexor("simulate", str(file))
    assert ran.code == 0, ran.err
    assert "cart" in ran.out and "mm" in ran.out
    assert "no load is given: --load pull=" in ran.out


def test_constants_change_the_result(flexor) -> None:
    command = ("simulate", "finger", "--force", "0:1:1", "--json", "--constants")
    printed, calibrated = (
        json.loads(flexor(*command, name).out)["joint_angles"][1]
        for name in ("printed", "calibrated")
    )
    assert printed != calibrated


@pytest.mark.parametrize("key", ["exosuit.length", "bodies.exosuit.length"])
def test_set_changes_a_field(flexor, key: str) -> None:
    ran = flexor("simulate", "finger", "--set", f"{key}=8 cm", "--force", "0:2:1", "--json")
    model = package.load("finger")
    shorter = parameter_set("L", model.design).geometry([[0.08]], model.design.points)
    expected = model.equilibrium([0, 1, 2], design=shorter).joint_angles
    np.testing.assert_allclose(json.loads(ran.out)["joint_angles"], expected, atol=1e-9)


@pytest.mark.parametrize("constants", [None, "printed"])
def test_set_wins_over_the_set_of_constants(constants: str | None) -> None:
    changed = load_changed("finger", constants, ["exosuit.young_modulus=20 MPa"])
    assert changed.slot("exosuit.young_modulus").tolist() == [20e6]
    assert changed.file.use == (constants or package.load("finger").file.use)


def test_plot_draws_a_figure(flexor, tmp_path) -> None:
    ran = flexor("simulate", "finger", "--force", "0:5:1", "--plot", "finger.png")
    assert ran.code == 0
    assert "finger.png" in ran.err
    assert (tmp_path / "finger.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["nowhere.toml"], "no such file"),
        (["finger", "--force", ""], "force"),
        (["finger", "--force", "0:5:0"], "step"),
        (["finger", "--force", "0,nan"], "finite"),
        (["finger", "--constants", "calibrate"], 'did you mean "calibrated"'),
        (["finger", "--set", "exosuit.length=30 kg"], "30 kg"),
        (["finger", "--set", "exosuit.length=-3 cm"], "exosuit.length"),
        (["finger", "--set", "exosuit.lenght=3 cm"], 'did you mean "length"'),
        (["finger", "--set", "exosiut.length=3 cm"], 'did you mean "exosuit"'),
        (["finger", "--set", "length"], "key=value"),
        (["finger", "--plot", "finger.jpeg"], "must end in"),
    ],
)
def test_bad_input_gets_one_sentence(flexor, arguments: list[str], words: str) -> None:
    ran = flexor("simulate", *arguments)
    assert words in ran.error


def test_several_inputs_are_driven_by_name(flexor, tmp_path) -> None:
    text = package.load("exosuit-alone").file.to_toml()
    text += '\n[actuators.lower]\nkind = "chamber"\nrod = "exosuit"\nlever = -1.0\n'
    (tmp_path / "two.toml").write_text(text)
    told = flexor("simulate", "two.toml", "--force", "lower=0:1:0.5", "--force", "chamber=2")
    assert told.code == 0
    rows = [line.split()[:2] for line in told.out.splitlines() if "stable" in line]
    assert rows == [["2", "0"], ["2", "0.5"], ["2", "1"]]
    ran = flexor("simulate", "two.toml", "--force", "lower=0:1:0.5", "--json")
    path = json.loads(ran.out)
    assert path["loads"] == {"chamber": [0.0, 0.0, 0.0], "lower": [0.0, 0.5, 1.0]}
    assert "force must name its input" in flexor("simulate", "two.toml", "--force", "0:1:1").error
    both = flexor("simulate", "two.toml", "--force", "0:1:1", "--force", "lower=2")
    assert "give key=value" in both.error
    unknown = flexor("simulate", "two.toml", "--force", "lowr=2")
    assert 'did you mean "lower"' in unknown.error


def test_a_path_goes_on_where_a_file_ends(flexor, tmp_path) -> None:
    first = flexor("simulate", "finger", "--force", "0:4:1", "--json")
    saved = tmp_path / "bent.json"
    saved.write_text(first.out, encoding="utf-8")
    ran = flexor("simulate", "finger", "--force", "4:0:2", "--start", str(saved), "--json")
    assert ran.code == 0
    path = json.loads(ran.out)
    assert path["force"] == [4, 2, 0]
    np.testing.assert_allclose(path["q"][0], json.loads(first.out)["q"][-1], atol=1e-9)
    np.testing.assert_allclose(path["q"][1], json.loads(first.out)["q"][2], atol=1e-7)


def test_a_path_starts_from_coordinates_and_loads_return(flexor) -> None:
    start = ("--start", "ph_1=20 deg", "--start", "exosuit.bend_y=30 deg")
    forces = ("--force", "0:2:1,2:-1:1", *start)
    ran = flexor("simulate", "finger", *forces, "--json")
    assert ran.code == 0
    assert json.loads(ran.out)["force"] == [0, 1, 2, 1, 0, -1]
    refused = flexor("simulate", "finger", "--start", "ph_9=20 deg")
    assert refused.code == 2 and "ph_9" in refused.err


def test_arc_length_is_an_option(flexor) -> None:
    ran = flexor("simulate", "finger", "--force", "0,3", "--follow", "arc-length", "--json")
    assert ran.code == 0
    forces = json.loads(ran.out)["force"]
    assert forces[0] == 0 and forces[-1] == 3 and len(forces) > 2
    refused = flexor("simulate", "finger", "--follow", "arc")
    assert refused.code == 2 and "arc-length" in refused.err


def test_a_syringe_finds_its_pressures(flexor) -> None:
    syringe = ("simulate", "pneumatic-finger", "--set", "actuators.chamber.control=volume")
    ran = flexor(*syringe, "--load", "0:2:1 mL")
    assert ran.code == 0
    assert "volume" in ran.out and "mL" in ran.out and "kPa" in ran.out
    found = json.loads(flexor(*syringe, "--load", "0:2:1 mL", "--json").out)
    assert found["force"] == [0.0, 1e-6, 2e-6]
    pressure, volume = found["pressure"]["chamber"], found["volume"]["chamber"]
    assert pressure[0] == 0.0 < pressure[1] < pressure[2]
    assert volume[2] - volume[0] == pytest.approx(2e-6)
    assert flexor(*syringe, "--load", "0:2:1 kPa").code == 2


def test_friction_in_the_table(flexor):
    table = flexor("simulate", "capstan", "--load", "pull=0,0.5,1,2,1.5").out
    assert "sliding" in table and "dissipated" in table
    counts = re.findall(r" (\d+) of (\d+) ", table)
    assert len(counts) == 5
    assert 0 < int(counts[-1][0]) < int(counts[-1][1])


def test_a_joint_that_never_moves_has_no_column(flexor) -> None:
    ran = flexor("simulate", "glove-thumb", "--load", "0:24:12 kPa")
    assert "metacarpal.theta_z stays at zero." in ran.out
    assert "metacarpal.theta_y" in ran.out and ran.out.count("theta_z") == 1
    # Without a load nothing moves, and all is shown.
    ran = flexor("simulate", "glove-thumb", "--load", "0 kPa")
    assert "theta_z" in ran.out and "stays" not in ran.out
