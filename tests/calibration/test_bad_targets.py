from __future__ import annotations

import pytest

from flexor.calibration import calibrate
from flexor.errors import InputError

E = """
[[constant]]
name = "E"
fields = ["exosuit.young_modulus"]
range = ["500 kPa", "8 MPa"]
"""
BEND = """
[[target]]
name = "bend"
observable = "bending"
force = "0:4:2"
value = "0.5 rad"
tolerance = "1 %"
"""


def constant(fields: str = '["exosuit.young_modulus"]', span: str = '["1 MPa", "2 MPa"]') -> str:
    return f'[[constant]]\nname = "c"\nfields = {fields}\nrange = {span}\n'


def target(**given: str) -> str:
    lines = {
        "name": '"t"',
        "observable": '"bending"',
        "value": '"0.5 rad"',
        "tolerance": '"1 %"',
        **given,
    }
    return "[[target]]\n" + "\n".join(f"{key} = {value}" for key, value in lines.items() if value)


OPTIMUM = {"observable": '"optimum"', "parameters": '"L+R01"', "of": '"L"', "value": '"10 cm"'}
DESIGN = {"parameters": '"R01"', "design": '{ R_0 = "1 cm", R_1 = "1 cm" }'}


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "has no [[target]]"),
        ("E = 1", 'unknown key "E"'),
        ("[[target]", "not valid TOML at line 1"),
        (BEND, "has no [[constant]]"),
        (E, "has no [[target]]"),
        ("constant = 3\n" + BEND, "constant is 3: expected a list"),
        (E + E + BEND, 'has the name "E" twice'),
        (E + BEND + BEND, 'has the name "bend" twice'),
        # constants
        (constant('["exosiut.young_modulus"]') + BEND, 'did you mean "exosuit"'),
        (constant('["bodies.exosiut.young_modulus"]') + BEND, 'did you mean "exosuit"'),
        (constant('["exosuit.yuong_modulus"]') + BEND, 'did you mean "young_modulus"'),
        (constant('["ph_9.joint.stiffness"]') + BEND, 'the model "finger" has the unknown entry'),
        (constant("[]") + BEND, "at least 1"),
        (E + constant() + BEND, 'which the constant "E" sets already'),
        (constant(span='["2 MPa", "1 MPa"]') + BEND, "lower end must be below the upper one"),
        (constant(span='["1 MPa", "1 MPa"]') + BEND, "lower end must be below the upper one"),
        (constant(span='["1 MPa", "2 cm"]') + BEND, "both must be of one kind"),
        (constant(span='["1 MPa", 2.0]') + BEND, "both must be of one kind"),
        (constant(span='["1", "2"]') + BEND, "write a value with its unit"),
        (constant(span="[1e6, 2e6]") + BEND, "a number without a unit"),
        (constant(span='["1 cm", "2 cm"]') + BEND, "is not an elastic modulus"),
        (constant(span='["1 MPa", "2 GPA"]') + BEND, "write a value with its unit"),
        (constant(span='["-1 MPa", "2 MPa"]') + BEND, "must be greater than zero"),
        (constant(span='["0 MPa", "2 MPa"]') + 'scale = "log"' + BEND, "on a log scale"),
        (constant(span='["1 MPa"]') + BEND, "write two values"),
        (constant(span="[0.0, nan]") + BEND, "must be a finite number"),
        (constant() + 'scale = "logarithmic"' + BEND, 'expected one of "linear", "log"'),
        (constant() + "unit = 3" + BEND, 'unknown key "unit"'),
        # targets
        (E + target(value='"0.5"'), "a number without a unit"),
        (E + target(value="0.5"), "a number without a unit"),
        (E + target(value='"0.5 N"'), "which is not an angle"),
        (E + target(value=""), 'target "t".value is missing'),
        (E + target(tolerance=""), 'target "t".tolerance is missing'),
        (E + target(tolerance="0.1"), "a number without a unit"),
        (E + target(tolerance='"0 rad"'), "must be greater than zero"),
        (E + target(tolerance='"x %"'), "expected a plain number"),
        (E + target(value='"0 rad"'), "a part of zero"),
        (E + target(observable='"bend"'), 'did you mean "bending"'),
        (E + target(observable='"angle"'), '"angle" needs the joint'),
        (E + target(of='"ph_1"'), '"bending" is of the whole model'),
        (E + target(observable='"angle"', of='"ph_4"'), 'unknown joint "ph_4"'),
        (E + target(observable='"x"', of='"hand"', value='"1 cm"'), 'unknown body "hand"'),
        (
            E + target(observable='"x"', of='"exosuit"', at="0.33", value='"1 cm"'),
            "a multiple of 1/10",
        ),
        (E + target(observable='"z"', of='"ph_1"', at="0.5", value='"1 cm"'), '"base" or "tip"'),
        (E + target(observable='"x"', of='"ph_1"', at='"end"', value='"1 cm"'), "expected one of"),
        (E + target(observable='"contacts"', value='"3"'), "expected a plain number"),
        (E + target(model='"fingr"'), 'unknown model "fingr"'),
        (E + target(force='"0:10"', value='["1 rad", "2 rad"]'), "2 entries for 11 forces"),
        (E + target(force='["1 rad"]'), "is not a force"),
        (E + target(weight='"strong"'), 'expected one of "hard", "soft", "held-out"'),
        (E + target(weight='"held-out"'), "held-out targets only"),
        (E + target(design="{ L = 1 }"), "parameters is missing"),
        (E + target(parameters='"L"'), "design is missing"),
        (E + target(**{**DESIGN, "parameters": '"R02"'}), 'unknown parameter set "R02"'),
        (E + target(**{**DESIGN, "design": '{ R_0 = "1 cm" }'}), "design.R_1 is missing"),
        (E + target(**{**DESIGN, "design": '{ R_0 = "1 cm", R_2 = 1 }'}), 'did you mean "R_1"'),
        (E + target(**{**DESIGN, "design": "{ R_0 = 1, R_1 = 1 }"}), "a number without a unit"),
        (E + target(**{**OPTIMUM, "of": '"R_2"'}), "unknown part of an optimum of L+R01"),
        (E + target(**{**OPTIMUM, "objective": '"bendin"'}), 'did you mean "bending"'),
        (E + target(**{**OPTIMUM, "method": '"patern"'}), "unknown method"),
        (E + target(**{**OPTIMUM, "options": "{ start = 3 }"}), 'did you mean "starts"'),
        (E + target(**{**OPTIMUM, "value": '["1 cm"]'}), "an optimum is one design"),
        (E + target(**OPTIMUM, design="{ L = 1 }"), "looks for the design itself"),
        (
            constant('["exosuit.radius.base"]', '["1 cm", "2 cm"]') + target(**DESIGN),
            'the constant "c" sets as well',
        ),
        # models
        ('[models]\nother = "fingr"\n' + E + BEND, 'did you mean "finger"'),
        ('[models]\nfinger = "finger"\n' + E + BEND, "the name of the model calibrated"),
        (E + '[[choice]]\nname = "c"\n' + BEND, 'unknown key "choice"'),
        ("[search]\nsamples = 0\n" + E + BEND, "must be at least 1"),
    ],
)
def test_a_bad_targets_file_gets_one_sentence(flexor, targets, tmp_path, text, words) -> None:
    path = targets(text)
    ran = flexor("calibrate", "finger", path.name, "--out", "made")
    assert ran.code == 2
    assert ran.out == ""
    assert ran.err.startswith("error: made-targets.toml")
    assert ran.err.count("\n") == 1
    assert words in ran.err
    assert not (tmp_path / "made").exists()


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["finger", "nowhere.toml"], "no such file"),
        (["finger", "."], "is a directory"),
        (["fingr", "made-targets.toml"], 'did you mean "finger"'),
        (["finger"], "TARGETS"),
        (["finger", "made-targets.toml", "--resume", "a", "--out", "b"], "omit --out"),
        (["finger", "made-targets.toml", "--resume", "nothing"], "is not a calibration"),
        (["finger", "made-targets.toml", "--seed", "-1"], "--seed"),
        (["finger", "made-targets.toml", "--samples", "0"], "--samples"),
        (["finger", "made-targets.toml", "--name", "a b"], "letters, digits"),
        (["exosuit-alone", "made-targets.toml"], "no joint that turns"),
    ],
)
def test_bad_use_gets_one_sentence(flexor, targets, tmp_path, arguments, words) -> None:
    targets()
    ran = flexor("calibrate", *arguments)
    assert ran.code == 2
    assert ran.out == ""
    assert ran.err.startswith("error: ")
    assert ran.err.count("\n") == 1
    assert words in ran.err
    assert [place.name for place in tmp_path.iterdir()] == ["made-targets.toml"]


@pytest.mark.parametrize("words", [["--out", "s", "--resume"], ["--resume", "--out", "s"]])
def test_resuming_as_in_the_first_version_is_deprecated(flexor, targets, words) -> None:
    ran = flexor("calibrate", "finger", targets().name, *words)
    assert ran.code == 2
    first, second = ran.err.splitlines()
    assert first == "deprecated: --out FOLDER --resume is now --resume FOLDER."
    assert second == 'error: "s" is not a calibration: there is no such folder.'


def test_a_taken_folder_is_left_alone(flexor, targets, tmp_path) -> None:
    (tmp_path / "full").mkdir()
    (tmp_path / "full" / "mine.txt").write_text("mine")
    ran = flexor("calibrate", "finger", targets(), "--out", "full")
    assert ran.code == 2
    assert "not an empty folder" in ran.err
    assert [file.name for file in (tmp_path / "full").iterdir()] == ["mine.txt"]


def test_ranges_without_any_equilibrium_are_said_so(flexor, targets) -> None:
    # Forces that no model of this kind follows within the patience of the search.
    wild = constant(span='["1 Pa", "2 Pa"]')
    path = targets(wild, target(force='"0:1000:500"', value='"1 rad"'))
    ran = flexor("calibrate", "finger", path, "--samples", "4")
    assert ran.code == 2
    assert "gives equilibria for all targets" in ran.err


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"seed": -1}, "seed is -1: it must be at least 0."),
        ({"samples": 0}, "samples is 0: it must be at least 1."),
        ({"samples": 1.5}, "samples is 1.5: it must be an integer of at least 1."),
        ({"starts": -1}, "starts is -1: it must be at least 1."),
        ({"executor": 2}, "executor is a int"),
        ({"progress": 3}, "progress is 3: it must be a function."),
    ],
)
def test_arguments_are_checked_before_the_folder_is_made(
    targets, coarse, tmp_path, given, words
) -> None:
    with pytest.raises(InputError) as refusal:
        calibrate(coarse, targets(E + BEND), folder=tmp_path / "out", **given)
    assert words in str(refusal.value)
    assert not (tmp_path / "out").exists()
