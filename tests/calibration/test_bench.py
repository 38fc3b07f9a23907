"""The example with a known answer: constants are recovered from measurements with noise."""

from __future__ import annotations

import json
import re
import shlex
from pathlib import Path

import numpy as np
import pytest

import flexor as package
from flexor.calibration import calibrate, read

ROOT = Path(__file__).resolve().parents[2]
FILE = "examples/bench-targets.toml"
TRUTH = {"E": 1.8e6, "k": 150.0, "K_1": 0.055}
NAMES = {"E": "exosuit.young_modulus", "k": "skin.stiffness", "K_1": "ph_1.joint.stiffness"}


MEASURED = {
    "exosuit.young_modulus": "1.8 MPa",
    "skin.stiffness": "150 N/m",
    "ph_1.joint.stiffness": "0.055 N*m/rad",
}
COARSE = {"exosuit.elements": 4, "exosuit.gauss_points": 2}


def measured(**changes):
    changed = package.load("finger", "calibrated", changes={**MEASURED, **changes})
    return changed.equilibrium([2, 4, 6, 8, 10])


@pytest.fixture(scope="module")
def bench():
    return measured()


@pytest.fixture(scope="module")
def found():
    return calibrate(package.load("finger", "calibrated"), FILE, samples=256, starts=4)


def test_the_file_holds_what_its_first_lines_say(bench) -> None:
    file, _ = read(FILE)
    noise = np.random.default_rng(2024).normal(0.0, 0.5, bench.joint_angles.shape)
    measured = np.degrees(bench.joint_angles) + noise
    for joint in range(3):
        written = [float(value.removesuffix(" deg")) for value in file.target[joint].value]
        np.testing.assert_allclose(written, measured[:, joint], atol=0.0501)
    height = 100.0 * bench.frames(-1)["exosuit"][-1, 2, 3]
    assert file.target[3].value == f"{height:.2f} cm"


def test_the_constants_are_recovered_within_their_confidence_intervals(found) -> None:
    for i, constant in enumerate(found.identifiability.constants):
        low, high = found.identifiability.interval(i)
        assert low < TRUTH[constant.name] < high
        assert high / low < 2.0
    assert found.best.constants["E"] == pytest.approx(TRUTH["E"], rel=0.02)
    assert found.best.constants["K_1"] == pytest.approx(TRUTH["K_1"], rel=0.06)
    # Neither overfitted nor missed: residuals are as large as the noise.
    assert 0.4 < found.best.misfit / found.degrees_of_freedom < 2.0


def test_what_was_held_out_is_predicted(found, bench) -> None:
    height = bench.frames(-1)["exosuit"][-1, 2, 3]
    assert found.best.values[3][0] == pytest.approx(height, abs=1e-3)


def test_the_fit_does_not_see_what_is_held_out(found) -> None:
    assert len(found.best.minimum.residuals) == 15


def test_the_confidence_intervals_are_those_of_repeated_measurements(coarse, tmp_path) -> None:
    """Measured and fitted again and again, the constants scatter as the first fit said.

    The bench and the model have the same mesh, whatever it is.
    """
    text, bench = read(FILE)[1], measured(**COARSE)
    rng, scatter, told = np.random.default_rng(7), [], []
    for turn in range(6):
        lines = text
        again = np.degrees(bench.joint_angles) + rng.normal(0.0, 0.5, bench.joint_angles.shape)
        file, _ = read(FILE)
        for joint in range(3):
            old = ", ".join(f'"{value}"' for value in file.target[joint].value)
            new = ", ".join(f'"{angle:.4f} deg"' for angle in again[:, joint])
            assert old in lines
            lines = lines.replace(old, new)
        path = tmp_path / f"{turn}.toml"
        path.write_text(lines)
        once = calibrate(coarse, path, samples=64, starts=2)
        deviation = once.identifiability.deviation
        u = once.best.minimum.u
        truth = [c.fraction(TRUTH[c.name]) for c in once.identifiability.constants]
        scatter.append((u - truth) / deviation)
        told.append(deviation)
    # Six draws of three constants: chi-squared with 18 degrees of freedom, 99.9 % of it.
    assert 4.9 < float(np.sum(np.square(scatter))) < 42.3


def documented() -> list[list[str]]:
    """Return every command of the documentation that fits these measurements."""
    texts = [page.read_text(encoding="utf-8") for page in (ROOT / "docs").glob("*.md")]
    found = re.findall(
        rf"flexor calibrate [^\n`]*{FILE}[^\n`]*", "\n".join([*texts, read(FILE)[1]])
    )
    return [shlex.split(each)[1:] for each in sorted(set(found))]


def test_the_documented_commands_fit_the_model_that_was_measured() -> None:
    """With other constants that are not fitted, such as the lever, no fit is good."""
    assert len(documented()) >= 4
    for words in documented():
        assert words[words.index("--variant") + 1] == "calibrated", words


def test_the_documented_command_recovers_and_writes_the_constants(flexor, tmp_path) -> None:
    (words,) = (each for each in documented() if each[-2:] == ["--variant", "calibrated"])
    ran = flexor(*words, "--samples", 64, "--starts", 2, "--name", "bench")
    assert ran.code == 0
    assert ran.err == ""
    (written,) = tmp_path.glob("calibrations/*/calibration.json")
    constants = json.loads(written.read_text())["fits"][0]["constants"]
    assert constants["E"] == pytest.approx(TRUTH["E"], rel=0.02)
    assert constants["K_1"] == pytest.approx(TRUTH["K_1"], rel=0.06)
    for words in ("first joint", "K_1", "N*m/rad", "held out", "identifiable", "evaluations in"):
        assert words in ran.out
    folder = written.parent
    assert folder.name == "finger-bench-targets"
    for name in ("calibration.png", "calibration.svg"):
        assert (folder / name).stat().st_size > 10_000
    snippet = (folder / "constants.toml").read_text()
    assert "[variants.bench]" in snippet
    told = json.loads((folder / "calibration.json").read_text())
    model = tmp_path / "pasted.toml"
    text = package.load("finger", "calibrated").file.to_toml()
    model.write_text(f"{text.split('[variants')[0].replace('use =', '# use =')}\n{snippet}")
    pasted = package.load(model, variant="bench")
    for name, field in NAMES.items():
        part, _, key = field.rpartition(".")
        slot = {"young_modulus": "exosuit.young_modulus", "stiffness": f"{part}.stiffness"}[key]
        slot = "ph_1.joint_stiffness" if name == "K_1" else slot
        wanted = told["fits"][0]["constants"][name]
        assert pasted.slot(slot)[0] == pytest.approx(wanted, rel=1e-8)
    rows = (folder / "targets.csv").read_text().splitlines()
    assert len(rows) == 1 + 15 + 1
    assert rows[1].startswith("first joint,soft,2,deg,4.5,")
