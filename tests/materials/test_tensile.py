"""CSV files of tensile tests."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pytest

from flexor.errors import InputError
from flexor.materials.tensile import read_test

VALUES = [(0.0, 0.0), (0.1, 20.0), (0.2, 38.0), (0.3, 55.0), (0.4, 70.0), (0.5, 84.0)]


def written(folder: Path, header: str, factors: tuple[float, float], delimiter: str = ",") -> Path:
    rows = [f"{e * factors[0]}{delimiter}{s * factors[1]}" for e, s in VALUES]
    path = folder / "specimen.csv"
    path.write_text("\n".join([header, *rows]) + "\n")
    return path


@pytest.mark.parametrize(
    ("header", "factors", "delimiter"),
    [
        ("strain,stress (kPa)", (1.0, 1.0), ","),
        ("Strain [%];Stress [MPa]", (100.0, 1e-3), ";"),
        ("strain (mm/mm)\tstress_Pa", (1.0, 1e3), "\t"),
        (
            "machine: X;;\nspeed;450;\nengineering strain;engineering stress (N/mm^2)",
            (1, 1e-3),
            ";",
        ),
    ],
)
def test_forms(tmp_path: Path, header: str, factors: tuple[float, float], delimiter: str) -> None:
    test = read_test(written(tmp_path, header, factors, delimiter))
    assert test.name == "specimen"
    np.testing.assert_allclose(test.stretch, [1.0 + e for e, _ in VALUES])
    np.testing.assert_allclose(test.stress, [1e3 * s for _, s in VALUES])


def test_true_values_are_converted_and_second_choice(tmp_path: Path) -> None:
    rows = [f"{np.log1p(e)};{s * (1 + e)};{e};{s}" for e, s in VALUES]
    both = tmp_path / "both.csv"
    both.write_text("\n".join(["True Strain;True Stress (kPa);Strain;Stress (kPa)", *rows]))
    true = tmp_path / "true.csv"
    true.write_text(
        "\n".join(["true strain;true stress (kPa)", *(r.rpartition(";")[0] for r in rows)])
    )
    for path in (both, true):
        test = read_test(path)
        np.testing.assert_allclose(test.stretch, [1.0 + e for e, _ in VALUES])
        np.testing.assert_allclose(test.stress, [1e3 * s for _, s in VALUES])


def test_unloading_and_repeated_strains_are_left_out(tmp_path: Path) -> None:
    path = written(tmp_path, "stretch,stress (kPa)", (1.0, 1.0))
    text = "stretch,stress (kPa)\n" + "".join(f"{1 + e},{s}\n" for e, s in VALUES)
    path.write_text(text + "1.5,84.0\n1.6,80.0\n1.2,10.0\n\n")
    test = read_test(path)
    assert test.stretch[-1] == 1.5
    assert np.all(np.diff(test.stretch) > 0.0)


def test_pounds_per_square_inch(tmp_path: Path) -> None:
    for unit, factor in (("kPa", 6.894757293168361), ("psi", 1.0)):
        text = "".join(f"{e},{s * factor!r}\n" for e, s in VALUES)
        (tmp_path / f"{unit}.csv").write_text(f"strain,stress ({unit})\n{text}")
    pascals, pounds = (read_test(tmp_path / f"{unit}.csv") for unit in ("kPa", "psi"))
    np.testing.assert_allclose(pounds.stress, pascals.stress, rtol=1e-12)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "no header"),
        ("a,b\n1,2\n", "no header"),
        ("strain,stress\n0,0\n", "a stress with a unit"),
        ("strain,stress (ksi)\n0,0\n", "one of Pa, kPa, MPa, GPa, N/mm^2 and psi"),
        ("strain (inch),stress (kPa)\n0,0\n", 'unit "inch"'),
        ("stretch (%),stress (kPa)\n0,0\n", 'unit "%"'),
        ("strain,stress (kPa)\n0,0\n0.1,1\n", "2 rows"),
        ("strain,stress (kPa)\n0,0\n0.1,x\n", 'line 3: expected a number, found "x"'),
        ("strain,stress (kPa)\n0,0\n0.1,nan\n", "line 3"),
        ("strain,stress (kPa)\n0,0\n0.1\n", "line 3"),
        ("strain,stress (kPa)\n" + "0.1,1\n" * 9, "no tensile test"),
        ("strain,stress (kPa)\n" + "".join(f"-0.{i},-{i}\n" for i in range(1, 9)), "no tensile"),
    ],
)
def test_invalid(tmp_path: Path, text: str, words: str) -> None:
    path = tmp_path / "bad.csv"
    path.write_text(text)
    with pytest.raises(InputError, match=r"bad\.csv") as raised:
        read_test(path)
    assert words in str(raised.value)


def test_unreadable(tmp_path: Path) -> None:
    (tmp_path / "binary.csv").write_bytes(b"\xff\xfe\x00\x81")
    for name, words in {
        "none.csv": "no such file",
        "binary.csv": "UTF-8",
        ".": "not a file",
    }.items():
        with pytest.raises(InputError, match=words):
            read_test(tmp_path / name)


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="the system has no pipes with names")
def test_a_pipe_is_refused(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe.csv")
    with pytest.raises(InputError, match="not a file"):
        read_test(tmp_path / "pipe.csv")
