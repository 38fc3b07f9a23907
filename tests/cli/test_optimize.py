from __future__ import annotations

import json
import os
import shlex
import signal
import sqlite3
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

import flexor as package
from flexor.model.limbs import limbs
from flexor.model.reading import locate
from flexor.study import Study

SMALL = ("optimize", "finger", "--parameters", "R01", "--budget", "30")


def test_the_result_is_printed_saved_and_plotted(flexor, tmp_path) -> None:
    ran = flexor(*SMALL)
    assert ran.code == 0
    for words in ("default", "optimum", "R_0 / cm", "bending / rad", "At 5 N the optimum bends"):
        assert words in ran.out
    for words in ("sensitivity", "R_0 + 1 mm", "if decreased"):
        assert words in ran.out
    folder = tmp_path / "studies" / "finger-R01-bending"
    assert f"study:  {folder.relative_to(tmp_path)}" in ran.out
    assert (folder / "designs.png").stat().st_size > 10_000
    assert (folder / "designs.svg").stat().st_size > 10_000
    study = Study.open(folder)
    assert study.evaluations == 30
    assert study.best.bending > study.start.bending
    optimum = folder / "optimum.toml"
    assert f"model:  {optimum.relative_to(tmp_path)}" in ran.out
    assert optimum.read_text(encoding="utf-8").startswith("# Saved by flexor: the optimum of the ")
    saved = package.load(optimum)
    assert saved.hash == study.best.model.hash != package.load("finger").hash


def test_a_constraint_that_is_not_kept_is_said_for_any_objective(flexor) -> None:
    words = ("--subject-to", "overlap <= 0.1 mm", "--budget", "20")
    result = flexor("optimize", "finger", "-p", "L", "-o", "bending", *words)
    assert result.code == 0
    assert "NOT FEASIBLE: no design that was tried keeps overlap <= 0.1 mm." in result.out
    assert "BROKEN" in result.out
    assert "the least infeasible design bends" in result.out and "times as much" not in result.out
    assert "The default breaks overlap (" in result.out
    saved = next(Path("studies").glob("*/optimum.toml")).read_text(encoding="utf-8")
    assert saved.startswith("# Saved by flexor: the least infeasible design, NOT FEASIBLE, of")


def test_json_is_one_object_with_the_gain(flexor) -> None:
    ran = flexor(*SMALL, "--json", "--save", "best.toml")
    assert ran.code == 0
    told = json.loads(ran.out)
    assert "# Table I" in Path("best.toml").read_text(encoding="utf-8")
    assert flexor("optimize", "--resume", told["folder"], "--save", "best.toml").code == 0
    saved = json.loads(flexor("simulate", "best.toml", "--json").out)
    assert saved["joint_angles"][-1] == pytest.approx(told["best"]["joint_angles"], rel=1e-12)
    study = Study.open(told["folder"])
    assert told["best"]["parameters"] == study.best.parameters
    assert package.load(told["models"][0]).hash == study.best.model.hash
    assert told["without_effect"] == []
    assert told["best"]["bending"] == pytest.approx(sum(told["best"]["joint_angles"]))
    assert told["best"]["bending"] > told["start"]["bending"]
    slopes = told["sensitivity"]["parameters"]
    assert list(slopes) == ["R_0", "R_1"]
    assert slopes["R_0"]["joint_angles"] == study.best.sensitivity.joint_angles[:, 0].tolist()


def test_a_second_study_gets_its_own_folder(flexor, tmp_path) -> None:
    flexor(*SMALL, "--json")
    flexor(*SMALL, "--json")
    names = {place.name for place in (tmp_path / "studies").iterdir()}
    assert names == {"finger-R01-bending", "finger-R01-bending-2"}


def test_a_resumed_study_has_the_same_result(flexor) -> None:
    whole = json.loads(flexor(*SMALL, "--out", "whole", "--json").out)
    flexor(*SMALL[:-1], "10", "--out", "parts", "--json")
    parts = json.loads(flexor("optimize", "--resume", "parts", "--budget", "30", "--json").out)
    assert parts["best"] == whole["best"]
    assert parts["evaluations"] == whole["evaluations"] == 30
    files = [Path(each["models"][0]).read_text(encoding="utf-8") for each in (whole, parts)]
    assert files[0].replace("study whole", "study parts") == files[1]


@pytest.mark.parametrize("start", ["0.7 cm, 0.75 cm", "0.7cm,7.5 mm", "R_1=0.75 cm,R_0=0.007 m"])
def test_formats_of_a_start(flexor, start: str) -> None:
    told = json.loads(flexor(*SMALL[:-1], "1", "--start", start, "--json").out)
    read = [told["start"]["parameters"][label] for label in ("R_0", "R_1")]
    np.testing.assert_allclose(read, [0.007, 0.0075], rtol=1e-12)


def evaluated(record: Path) -> int:
    """Return how many designs the record of a running study holds."""
    try:
        with sqlite3.connect(f"{record.as_uri()}?mode=ro", uri=True, timeout=10) as sql:
            return int(sql.execute("SELECT count(*) FROM evaluations").fetchone()[0])
    except sqlite3.Error:
        return 0


@pytest.mark.skipif(sys.platform == "win32", reason="sends SIGINT")
@pytest.mark.usefixtures("interruptible")
def test_ctrl_c_leaves_a_study_and_says_how_to_go_on(tmp_path) -> None:
    command = [sys.executable, "-c", "from flexor.cli.app import main; main()"]
    # Twenty starts with a tight tolerance: long enough to be interrupted on any machine.
    options = ["--option", "starts=20", "--option", "tolerance=1e-14", "--out", "my study"]
    process = subprocess.Popen(
        [*command, "optimize", "finger", "--parameters", "RLP", *options],
        cwd=tmp_path,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env={**os.environ, "COLUMNS": "200"},
    )
    record = tmp_path / "my study" / "record.sqlite"
    until = time.monotonic() + 60.0
    while evaluated(record) == 0 and process.poll() is None and time.monotonic() < until:
        time.sleep(0.05)
    process.send_signal(signal.SIGINT)
    out, err = process.communicate(timeout=300)
    assert process.returncode == 130
    assert out == ""
    assert "Traceback" not in err
    resuming = shlex.split(err.strip().splitlines()[-1])
    assert resuming == ["flexor", "optimize", "--resume", "my study"]
    before = Study.open(tmp_path / "my study").evaluations
    assert before > 0
    subprocess.run(
        [*command, *resuming[1:], "--budget", str(before + 5), "--json"], cwd=tmp_path, check=True
    )
    assert Study.open(tmp_path / "my study").evaluations == before + 5


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ([], "MODEL"),
        (["fingr"], 'did you mean "finger"'),
        (["finger", "--parameters", "R02"], "unknown parameter set"),
        (["finger", "--objective", "bendin"], 'did you mean "bending"'),
        (["finger", "--method", "patern-search"], 'did you mean "pattern-search"'),
        (["finger", "--option", "start=8"], 'did you mean "starts"'),
        (["finger", "--option", "starts=many"], "expected a number"),
        (["finger", "--start", "L=20 cm"], "outside its bounds"),
        (["finger", "--start", "L=9 kg"], "expected a finite number with its unit: m, cm, mm"),
        (["finger", "--start", "9,1"], "needs 3 values"),
        (["finger", "--start", "M=9"], "unknown parameter"),
        (["finger", "--budget", "0"], "budget"),
        (["--resume", "nowhere"], "is not a study"),
        (["finger", "--resume", "a"], "takes only the folder"),
        (["--resume", "a", "--out", "b"], "takes only the folder"),
        (["finger", "--seed", "-1"], "--seed is -1: it must be at least 0."),
        (["finger", "--option", "starts=1e30"], "from 1 to 1,000,000"),
        (["finger", "--start", "9,1,1"], "expected a finite number with its unit: m, cm, mm"),
        (["finger", "--plot", "no/where.png"], "no folder"),
        (["exosuit-alone", "--constants", "prined"], 'did you mean "printed"'),
    ],
)
def test_bad_input_gets_one_sentence(flexor, tmp_path, arguments: list[str], words: str) -> None:
    ran = flexor("optimize", *arguments)
    assert words in ran.error
    assert list(tmp_path.iterdir()) == []


def test_a_damaged_study_is_rejected(flexor, tmp_path) -> None:
    flexor(*SMALL, "--out", "study", "--json")
    (tmp_path / "study" / "settings.json").write_text("{")
    ran = flexor("optimize", "--resume", "study")
    assert "damaged" in ran.error


def test_fixed_options_cannot_be_given_when_resuming(flexor) -> None:
    flexor("optimize", "finger", "-p", "L", "--budget", "10", "--out", "study", "--json")
    ran = flexor("optimize", "--resume", "study", "--method", "cma-es", "--seed", "0")
    assert ran.code == 2
    assert (
        '--method and --seed cannot be changed: "study" is resumed with its own settings.'
        in ran.err
    )
    assert flexor("optimize", "--resume", "study", "--budget", "12", "--json").code == 0


SEVERAL = (
    *("optimize", "pneumatic-finger", "--vary", "exosuit.section.wall=1.5 mm:3 mm"),
    *("--vary", "exosuit.radius.base=6 mm:10 mm"),
    *("--maximise", "range-of-motion", "--minimise", "mass", "--budget", "60"),
    *("--option", "population=8", "--option", "generations=3", "--out", "s"),
)


ONE = ["--maximise", "range-of-motion", "--vary", "exosuit.length=9 cm:10 cm"]
TWO = [*ONE, "--minimise", "mass"]


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ([*TWO, "--tolerance", "exosuit.section.wall=0.1 mm"], "need one objective"),
        ([*TWO, "--samples", "4"], "need one objective"),
        ([*TWO, "--aggregate", "worst"], "need one objective"),
        ([*TWO, "--wearers", "4"], "need one objective"),
        ([*TWO, "--wearers", "4", "--sizes", "2"], "sizes are found for one objective"),
        ([*TWO, "--choose", "middle=with,without"], "choices are made for one objective"),
        (
            [*ONE, "--wearers", "4", "--sizes", "2", "--tolerance", "exosuit.length=1 mm"],
            "leave out --tolerance",
        ),
        ([*ONE, "--wearers", "4", "--sizes", "2", "--samples", "4"], "leave out --samples"),
    ],
)
def test_what_does_not_go_with_several_objectives_or_sizes_is_refused(
    flexor, words: list[str], message: str
) -> None:
    ran = flexor("optimize", "pneumatic-finger", *words)
    assert ran.code == 2
    assert message in " ".join(ran.err.split())


def test_several_objectives_give_a_front(flexor, tmp_path) -> None:
    ran = flexor(*SEVERAL)
    assert ran.code == 0
    assert "range-of-motion" in ran.out
    assert "designs that no other is better than in all, to maximise range-of-motion" in ran.out
    assert "states are not applied to a front of several objectives" in ran.err
    for name in ("front.csv", "front.png", "front.svg"):
        assert (tmp_path / "s" / name).stat().st_size > 100
    shown = flexor("front", "s", "--point", "1", "--save", "light.toml")
    assert shown.code == 0
    assert "overlap <= 1.5 mm" in shown.out
    first, _, *own = (tmp_path / "light.toml").read_text(encoding="utf-8").splitlines()
    assert first.startswith("# Saved by flexor: point 1 of the front of s: exosuit.section.wall = ")
    preset = locate("pneumatic-finger").read_text(encoding="utf-8").splitlines()
    changed = [line.split()[0] for line, now in zip(preset, own, strict=True) if line != now]
    assert changed == ["radius", "section"]
    told = json.loads(flexor("front", "s", "--json").out)
    best = told["front"][0]
    point = json.loads(flexor("front", "s", "--point", "1", "--json").out)
    assert point["parameters"] == best["parameters"]
    assert point["feasible"]
    path = json.loads(flexor("simulate", "light.toml", "--json").out)
    moved = sum(path["joint_angles"][-1]) - sum(path["joint_angles"][0])
    assert moved == pytest.approx(best["objectives"]["maximise range-of-motion"])


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("nowhere",), "is not a study"),
        (("nowhere", "--save", "x.toml"), "--save needs --point"),
        (("nowhere", "--point", "1", "--save", "x.txt"), "must end in .toml"),
        (("nowhere", "--point", "1", "--save", "mine.toml"), "was not saved by flexor"),
        (("nowhere", "--point", "0"), "at least 1"),
    ],
)
def test_bad_fronts_get_one_sentence(flexor, arguments, words) -> None:
    Path("mine.toml").write_text("# My own finger", encoding="utf-8")
    assert words in flexor("front", *arguments).error


def test_scenarios_and_tolerances_are_stated_and_answered(flexor, tmp_path) -> None:
    text = package.load("pneumatic-finger").file.to_toml()
    (tmp_path / "glove.toml").write_text(
        f'{text}\n[variants.stiff]\nbodies.ph_1.joint.stiffness = "0.08 N*m/rad"\n'
    )
    vary = ("--vary", "exosuit.section.wall=1.5 mm:3 mm", "--maximise", "bending")
    words = ("optimize", "glove.toml", *vary, "--budget", "40", "--scenarios", "stiff")
    ran = flexor(*words, "--tolerance", "exosuit.section.wall=0.1 mm")
    assert ran.code == 0, ran.err
    assert "within the tolerances bending is at worst" in ran.out
    assert "in scenario stiff" in ran.out
    signs = ran.out.partition("worst errors of")[2]
    assert "exosuit.section.wall ± 0.1 mm" in signs and "+" in signs
    assert "bending of the model as it is" in ran.out
    assert "checking the best design" in ran.err
    # As drawn, which is not for every error.
    words = ("optimize", "pneumatic-finger", *vary, "--budget", "4", "--json")
    found = json.loads(flexor(*words).out)
    assert (found["feasible"], found["robust"]) == (True, False)
    assert all(each["kept"] for each in found["constraints"])


@pytest.mark.parametrize(
    ("option", "message"),
    [
        (("--scenarios", "stif"), 'the model "pneumatic-finger" has no variants'),
        (("--tolerance", "exosuit.section.wall=0.1"), "write a value with its unit"),
        (("--aggregate", "wrost"), 'did you mean "worst"'),
        (("--samples", "-1"), "--samples"),
    ],
)
def test_bad_scenarios(flexor, option: tuple[str, str], message: str) -> None:
    vary = ("--vary", "exosuit.section.wall=1.5 mm:3 mm", "--maximise", "bending")
    ran = flexor("optimize", "pneumatic-finger", *vary, *option)
    assert ran.code == 2
    assert message in ran.err


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (("--choose", "middel=with,without"), 'did you mean "middle"'),
        (("--choose", "exosuit.material=silicone"), "give values, such as"),
        (("--choose", "middle=with,without", "--sizes", "2"), "exclude each other"),
        (("--choose", "middle=with,without", "--minimise", "mass"), "for one objective"),
        (("--vary", "exosuit.radius=6 mm:9 mm:splin 4"), 'did you mean "spline"'),
        (("--vary", "exosuit.radius=6 mm:9 mm:spline 4:5"), "give bounds, such as"),
    ],
)
def test_bad_choices_and_profiles(flexor, options: tuple[str, ...], message: str) -> None:
    vary = ("--vary", "exosuit.length=8 cm:11 cm", "--maximise", "bending")
    assert message in flexor("optimize", "pneumatic-finger", *vary, *options).error


def test_the_bending_of_several_limbs_is_said_to_be_a_sum(flexor, tmp_path) -> None:
    parts = "".join(f'[parts.{key}]\nfile = "finger"\n' for key in "ab")
    (tmp_path / "two.toml").write_text(f'name = "two"\nplanar = true\n{parts}')
    loads = "a.chamber=0:1:1 N", "b.chamber=0:1:1 N"
    given = ("--load", loads[0], "--load", loads[1], "--vary", "a.exosuit.length=9 cm:10 cm")
    ran = flexor("optimize", "two.toml", *given, "--maximise", "bending", "--budget", "3")
    assert ran.code == 0, ran.err
    assert "It is the sum over all joints, of 2 limbs." in ran.out
    counts = {"glove": 5, "finger": 1, "tendon-arm": 1, "column": 0}
    for name, count in counts.items():
        assert limbs(package.load(name)) == count
