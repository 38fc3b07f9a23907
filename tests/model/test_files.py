"""Finding, reading and writing model files."""

from __future__ import annotations

import pathlib

import pytest

from flexor.errors import InputError, unknown
from flexor.model import parse, presets, read
from flexor.model.reading import locate

ROOT = pathlib.Path(__file__).parents[2]
ALL = presets()

EVERYTHING = pathlib.Path(__file__).with_name("everything.toml").read_text(encoding="utf-8")


def test_presets_are_the_examples() -> None:
    assert {"finger", "pneumatic-finger", "tendon-arm"} <= set(ALL)
    files = sorted(file.stem for file in (ROOT / "examples").glob("*.toml"))
    # Calibration targets are in the same folder.
    assert tuple(name for name in files if not name.endswith("-targets")) == ALL


@pytest.mark.parametrize("name", ALL)
def test_presets_read_and_are_named_after_their_file(name: str) -> None:
    file = read(locate(name))
    assert file.name == name
    assert file.title


@pytest.mark.parametrize("name", ALL)
def test_presets_round_trip(name: str) -> None:
    written = read(locate(name))
    for use in (None, *written.variants):
        file = read(locate(name), use=use)
        assert parse(file.to_toml()) == file


def test_a_file_with_every_key_round_trips() -> None:
    file = parse(EVERYTHING)
    written = file.to_toml()
    assert parse(written) == file
    assert parse(written).to_toml() == written
    assert 'length = "10 in"' in written


def test_files_with_different_values_are_not_equal() -> None:
    assert parse(EVERYTHING.replace("10 in", "10.0001 in")) != parse(EVERYTHING)


def test_examples_folder_is_found_from_anywhere(
    tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    assert locate("examples/finger.toml").samefile(locate("finger"))
    (tmp_path / "finger").write_text(EVERYTHING)
    assert locate("finger") == pathlib.Path("finger")  # files take precedence over presets
    (tmp_path / "examples").mkdir()
    (tmp_path / "examples" / "finger.toml").write_text(EVERYTHING)
    assert read(locate("examples/finger.toml")).name == "everything"


def test_a_misspelt_preset() -> None:
    with pytest.raises(InputError) as caught:
        locate("fingr")
    assert str(caught.value) == (
        'unknown preset "fingr" (did you mean "finger"?): expected one of '
        + ", ".join(f'"{name}"' for name in ALL)
        + ", or the path of a model file."
    )


@pytest.mark.parametrize("name", ["examples/fingr.toml", "nowhere.toml", "some/where"])
def test_missing_file(name: str, tmp_path: pathlib.Path) -> None:
    with pytest.raises(InputError) as caught:
        locate(str(tmp_path / name))
    assert str(caught.value) == (f'cannot read the model file "{tmp_path / name}": no such file.')


def test_a_folder_is_not_a_model_file(tmp_path: pathlib.Path) -> None:
    with pytest.raises(InputError) as caught:
        locate(tmp_path)
    assert str(caught.value) == f'cannot read the model file "{tmp_path}": it is a folder.'


def test_a_binary_file_is_not_a_model_file(tmp_path: pathlib.Path) -> None:
    path = tmp_path / "image.toml"
    path.write_bytes(b'name = "\xff\xd8\xff"')
    with pytest.raises(InputError) as caught:
        read(path)
    assert str(caught.value) == f'cannot read the model file "{path}": byte 8 is not valid UTF-8.'


def test_deep_nesting_is_rejected() -> None:
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
def test_very_long_integers_are_rejected(line: str, number: str) -> None:
    assert EVERYTHING.count(line) == 1
    with pytest.raises(InputError) as caught:
        parse(EVERYTHING.replace(line, f"{line.split()[0]} = {number}"))
    assert len(str(caught.value)) < 300


@pytest.mark.parametrize("sign", ["", "-"])
def test_huge_exponents_are_rejected(sign: str) -> None:
    with pytest.raises(InputError, match=r"bodies.arm.length is .*: it must be "):
        parse(EVERYTHING.replace('"10 in"', f'"{sign}1e99999999999999999999 in"'))


@pytest.mark.parametrize("deep", [40, 1500])
def test_deeply_nested_tables_are_rejected(deep: int) -> None:
    for text in (f"{'a.' * deep}b = 1", f"[constants{'.a' * deep}]", f"a = {'[' * 40}{']' * 40}"):
        with pytest.raises(
            InputError, match=r"nested more than 30 levels|nested too deeply|has more than 30 parts"
        ):
            parse(EVERYTHING.replace('name = "everything"', text))
    with pytest.raises(InputError, match="has more than 30 parts"):
        parse(EVERYTHING, changes={"bodies" + ".a" * deep: "1"})


@pytest.mark.parametrize(
    ("found", "odd"),
    [
        ("radius_bounds", "r" * 5000),
        ('kind = "cable"', f'kind = "{"c" * 5000}"'),
        ("[springs.strap]", f"[springs.strap.{'s' * 5000}]"),
        ('"10 in"', f'"10 {"i" * 5000}"'),
        ("axis = [1, 0, 1]", f"axis = '{'x' * 5000}'"),
        ("[design]", f"[bodies.{'b' * 5000}]\nkind = 3\n[design]"),
    ],
)
def test_messages_truncate_what_they_quote(found: str, odd: str) -> None:
    assert EVERYTHING.count(found) == 1
    with pytest.raises(InputError) as caught:
        parse(EVERYTHING.replace(found, odd))
    assert len(str(caught.value)) < 600


def test_too_many_load_steps_are_rejected() -> None:
    for step in ("1e-50 N", "1 nN"):
        with pytest.raises(InputError, match=r"evaluation.step is .* more than 10,000 steps"):
            parse(EVERYTHING.replace('"500 mN"', f'"{step}"'))


def test_suggestions_ignore_case() -> None:
    assert str(unknown("parameter set", "l+r01", ["L", "R01", "L+R01"])) == (
        'unknown parameter set "l+r01" (did you mean "L+R01"?): expected one of "L", "R01", '
        '"L+R01".'
    )
    assert str(unknown("objective", "zzz", ["bending"])) == (
        'unknown objective "zzz": expected "bending".'
    )
