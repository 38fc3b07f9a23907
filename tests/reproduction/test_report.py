"""The study as a whole, with budgets so small that only the form of its output can be tested."""

from __future__ import annotations

import json
import re
from pathlib import Path

import numpy as np
import pytest

import flexor
from reproduction import report
from reproduction.__main__ import main
from reproduction.optima import NESTED, as_legendre, objective_value, rounded
from reproduction.study import PUBLISHED, SETS, model, parameters, published_design


@pytest.fixture(scope="module")
def folder(tmp_path_factory) -> Path:
    """The whole study with tiny budgets, interrupted once."""
    out = tmp_path_factory.mktemp("reproduction") / "out"
    # A study of some items is completed by the others.
    assert main(["--quick", "--what", "fig3, table4", "--out", str(out)]) == 0
    before = (out / "results" / "optimum-L-bending-surface.json").read_bytes()
    assert main(["--quick", "--out", str(out)]) == 0
    assert (out / "results" / "optimum-L-bending-surface.json").read_bytes() == before
    return out


@pytest.fixture(scope="module")
def text(folder) -> str:
    return (folder / "report.md").read_text(encoding="utf-8")


def result(folder: Path, name: str) -> dict:
    return json.loads((folder / "results" / f"{name}.json").read_text())


def test_tables_are_well_formed_and_figures_exist(folder, text) -> None:
    for block in re.split(r"\n\n+", text):
        lines = block.splitlines()
        if lines[0].startswith("|"):
            assert len(lines) > 2
            assert len({line.count("|") for line in lines}) == 1, lines[0]
    pictures = re.findall(r"!\[[^\]]+\]\((figures/[\w-]+\.png)\)", text)
    assert len(pictures) == 8
    for picture in pictures:
        assert (folder / picture).stat().st_size > 10_000
        assert (folder / picture).with_suffix(".svg").is_file()
    assert "\n\n\n" not in text and "{{" not in text


def test_the_html_report_is_self_contained(folder) -> None:
    page = (folder / "report.html").read_text(encoding="utf-8")
    sources = re.findall(r'src="([^"]{0,30})', page)
    assert len(sources) == 8
    assert all(source.startswith("data:image/png;base64,") for source in sources)
    assert page.count("<table>") == page.count("</table>") > 8


def test_every_published_number_is_shown(text) -> None:
    for name in SETS:
        assert f"| {report.format_design(PUBLISHED['table3'][name]['design'], name)} |" in text
        assert f"| {PUBLISHED['table3'][name]['minutes']} |" in text
    for row in PUBLISHED["table4"].values():
        assert f"| {report.format_design(row['design'], 'L+R01')} |" in text
        assert f"| {row['minutes']} |" in text
    for value in (1.05, 0.27, 1.43, "0.53, 0.52 cm", "82°", 25, 42):
        assert str(value) in text


def test_a_printed_design_reproduces_its_printed_bending(folder, text) -> None:
    for name in ("L", "R01", "L+R01"):
        found = result(folder, f"optimum-{name}-bending-surface")
        ending = f"| {PUBLISHED['table3'][name]['minutes']} |"
        rows = [row for row in text.splitlines() if row.startswith(f"| {name} | ")]
        (line,) = (row for row in rows if row.endswith(ending))
        cells = [cell.strip() for cell in line.split("|")]
        typed = [float(word) / 100.0 for word in cells[6].removesuffix(" cm").split(", ")]
        chosen = parameters(name)
        path = model().equilibrium(
            [0, 1, 2, 3, 4, 5], design=chosen.geometry([typed], chosen_points())
        )
        assert f"{path.joint_angles[-1].sum():.5g}" == cells[8]
        assert np.allclose(typed, found["design"], rtol=0, atol=1e-16)


def chosen_points() -> np.ndarray:
    return model().design.points


def test_rounding_stops_at_a_cliff() -> None:
    design = np.array([0.13217933, 0.00625334, 0.01056362])
    short, digits = rounded("L+R01", design)
    assert digits >= 5
    values = [objective_value("L+R01", each, "bending", "surface") for each in (design, short)]
    assert values[0] == pytest.approx(values[1], abs=2e-5)


def test_sets_that_contain_others_are_at_least_as_good(folder) -> None:
    value = {name: result(folder, f"optimum-{name}-bending-surface")["value"] for name in SETS}
    default = result(folder, "default-surface")["value"]
    for outer, contained in NESTED.items():
        for inner in contained:
            assert value[outer] <= value[inner] + 1e-4
    # Even these short searches start from the default design.
    assert all(each <= default + 1e-4 for each in value.values())


def test_angles_of_fig3_are_the_models_own(folder) -> None:
    last = result(folder, "fig3")["rows"][-1]
    for preset, key in (("finger-2-links", "two_sum"), ("finger", "three_sum")):
        path = flexor.load(preset).equilibrium([0, 2, 4, 6, 8, 10])
        assert last[key] == float(path.joint_angles[-1].sum())


def test_the_second_angle_depends_on_the_mesh(folder) -> None:
    rows = result(folder, "mesh-surface")["rows"]
    angles = {row["elements"]: row["two_links"] for row in rows}
    assert angles == {5: pytest.approx(0.158, abs=5e-4), 10: pytest.approx(0.270, abs=5e-4)}


def test_straight_surfaces_as_legendre_coefficients() -> None:
    X = np.linspace(0.0, 1.0, 7)
    design = published_design("L+R01")[1:]
    for name, vector in (("R01", design), ("RLP", as_legendre(design, 10))):
        radius = parameters(name).geometry(vector[None, :], X).radius[0]
        np.testing.assert_allclose(radius, design[0] + X * (design[1] - design[0]), atol=1e-15)


@pytest.mark.parametrize(
    ("value", "shown"),
    [(1.0499863, "1.05"), (-0.0, "0"), (1e-15, "0"), (6561, "6,561"), (None, "–"), (0.27, "0.27")],
)
def test_format_of_numbers(value, shown: str) -> None:
    assert report.number(value) == shown


def test_format_of_designs() -> None:
    assert report.format_design([13.322000000000001], "L", 5) == "13.322 cm"
    assert report.format_design([-1e-9, 0.5, -2.0, 0.0], "Rsc") == "0, 0.5; -2, 0"


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--what", "fig33"], 'unknown item of the study "fig33" (did you mean "fig3"?)'),
        (["--what", ","], "no item of the study is named"),
        (["--what", "fig3", "--write"], "--write requires the whole study"),
        (["--seed", "-1"], "--seed must be at least 0"),
    ],
)
def test_bad_input_gets_one_sentence(capsys, monkeypatch, tmp_path, arguments, words) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(arguments) == 2
    said = capsys.readouterr().err
    assert words in said and said.count("\n") == 1


def test_the_documentation_gets_the_report_and_its_images(folder, text, tmp_path) -> None:
    report.write_docs(folder, tmp_path / "docs" / "reproduction.md")
    written = (tmp_path / "docs" / "reproduction.md").read_text(encoding="utf-8")
    assert written == text.replace("(figures/", "(images/reproduction/")
    for picture in re.findall(r"\((images/[\w/-]+\.png)\)", written):
        assert (tmp_path / "docs" / picture).is_file()
