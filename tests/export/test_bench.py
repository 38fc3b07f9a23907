"""The table of bench measurements, and its comparison with the model."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

import flexor
from flexor.errors import InputError
from flexor.export.bench import bench, figure, template
from flexor.model import Model

HEADINGS = "chamber / kPa,ph_1 / deg,ph_2 / deg,ph_3 / deg"


@pytest.fixture(scope="module")
def model() -> Model:
    return flexor.load("pneumatic-finger")


def test_what_the_model_predicts_deviates_by_nothing(model: Model, tmp_path: Path) -> None:
    assert template(model).splitlines()[0] == HEADINGS
    path = model.equilibrium([0.0, 30e3, 60e3, 30e3])
    angles = np.degrees(path.joint_angles) + np.array([0.0, 1.0, -2.0])
    rows = [
        f"{load},{','.join(map(str, row))}"
        for load, row in zip((0, 30, 60, 30), angles.tolist(), strict=True)
    ]
    (tmp_path / "bench.csv").write_text("\n".join([HEADINGS, *rows, ",,,"]))
    found = bench(model, tmp_path / "bench.csv")
    assert np.degrees(found.deviations) == pytest.approx([0.0, 1.0, 2.0], abs=1e-9)
    assert len(figure(found).axes[0].lines) == 6


def test_columns_and_cells_may_be_missing(model: Model, tmp_path: Path) -> None:
    (tmp_path / "bench.csv").write_text("ph_2 / deg,chamber / kPa\n6,20\n,40\n")
    found = bench(model, tmp_path / "bench.csv")
    assert found.joints == ("ph_2",)
    assert np.isnan(found.measured[1, 0])
    assert np.isfinite(found.predicted).all()
    assert np.isfinite(found.deviations).all()


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("", "has no measurements"),
        (f"{HEADINGS}\n,,,\n", "has no measurements"),
        ("chamber / kPa,ph_9 / deg\n1,2\n", 'unknown column "ph_9 / deg"'),
        ("ph_1 / deg\n1\n", 'has no column "chamber / kPa"'),
        ("chamber / kPa\n1\n", "has no column of a joint"),
        (f"{HEADINGS}\n12,one,,\n", 'has "one" in line 2, ph_1 / deg: write a number'),
        (f"{HEADINGS}\n12,inf,,\n", 'has "inf" in line 2'),
        (f"{HEADINGS}\n,4,,\n", "has no load in line 2"),
        (f"{HEADINGS}\n1,2,3,4,5\n", "has 5 cells in line 2: it has 4 columns"),
        ("chamber / kPa,chamber / kPa\n1,2\n", "has a column twice"),
    ],
)
def test_bad_tables_are_refused(model: Model, tmp_path: Path, text: str, sentence: str) -> None:
    (tmp_path / "bench.csv").write_text(text)
    with pytest.raises(InputError, match=sentence):
        bench(model, tmp_path / "bench.csv")
    with pytest.raises(InputError, match="cannot be read"):
        bench(model, tmp_path / "nothing.csv")


def test_the_template_is_filled_in_and_compared(tmp_path: Path, monkeypatch, capsys) -> None:
    from flexor.cli.app import main

    monkeypatch.chdir(tmp_path)

    def run(*arguments: str) -> str:
        with pytest.raises(SystemExit) as ended:
            main(list(arguments))
        assert ended.value.code == 0
        return capsys.readouterr().out

    assert "springs.csv" in run("export", "pneumatic-finger", "--finger", "finger")
    blank = Path("finger/bench.csv").read_text()
    Path("finger/bench.csv").write_text(blank.replace(",,,", ",5,10,"))
    run("bench", "pneumatic-finger", "finger/bench.csv", "--plot", "bench.png")
    assert Path("bench.png").stat().st_size > 10_000
    found = json.loads(run("bench", "pneumatic-finger", "finger/bench.csv", "--json"))
    assert found["deviation"]["ph_3"] is None
    assert found["measured"]["ph_1"] == pytest.approx(np.radians([5.0] * 6).tolist())
