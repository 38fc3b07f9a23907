"""Names and titles from any file are shown as texts, whatever they contain."""

from __future__ import annotations

import csv
import io
import subprocess
import sys
from pathlib import Path

import pytest

from flexor.calibration import calibrate, figure, report
from flexor.cli.console import plain
from flexor.cli.table import table
from flexor.model import load
from flexor.model.toml import tables
from flexor.plot.style import literal
from flexor.store import csv_text

EVIL = r"""
title = "Bench\n[contacts.skin]\nstiffness = \"1 N/m\"\n#"
[[constant]]
name = "$E$ $x"
fields = ["exosuit.young_modulus"]
range = ["300 kPa", "10 MPa"]
[[target]]
name = "=HYPERLINK(\"http://127.0.0.1/?\"&A1,\"x\")"
observable = "angle"
of = "ph_1"
force = ["2 N"]
value = ["4.5 deg"]
tolerance = "0.5 deg"
[[target]]
name = "\u001b]0;pwn\u0007[red]x $\\frac$ & <b>"
observable = "bending"
force = ["2 N"]
value = ["9 deg"]
tolerance = "0.5 deg"
"""


def test_a_stranger_s_targets_file(tmp_path: Path) -> None:
    targets = tmp_path / "a\n[x]\x1b.toml"
    targets.write_text(EVIL)
    found = calibrate(load("finger"), targets, samples=4, starts=1)
    written = report.constants_toml(found, "fitted")
    assert set(tables(written, "variants")["variants"]["fitted"]) == {"bodies"}
    assert "\x1b" not in written
    rows = list(csv.reader(report.targets_csv(found.best).splitlines()))
    assert rows[1][0].startswith("'=HYPERLINK")
    figure.draw(found).savefig(tmp_path / "f.svg")
    assert "<b>" not in (tmp_path / "f.svg").read_text()


@pytest.mark.parametrize("start", ["=", "+", "-", "@", "\t", "\r", "\n"])
def test_spreadsheets_find_no_formulas(start: str) -> None:
    written = csv_text([[f"{start}=cmd|' /C calc'!A0", "-1.5", -2.5, "+3"]])
    (row,) = csv.reader(io.StringIO(written, newline=""))
    assert row[0].startswith("'")
    assert row[1:] == ["-1.5", "-2.5", "+3"]
    assert len(written.splitlines()) == 1


def test_terminals_get_no_codes_and_no_markup() -> None:
    assert plain("\x1b[2J[red]x\r\x9b31m").plain == " [2J[red]x  31m"
    (cell,) = table(["a [b]"], [["[red]x[/]\x1b]0;y\x07"]]).columns[0].cells
    assert cell.plain == "[red]x[/] ]0;y "


def test_figures_show_dollars() -> None:
    assert literal("$\\frac$\x07") == r"\$\frac\$ "


@pytest.mark.parametrize("encoding", ["ascii", "latin-1", "utf-8"])
def test_streams_of_few_characters(encoding: str) -> None:
    done = subprocess.run(
        [sys.executable, "-c", "from flexor.cli.app import main; main()", "simulate", "finger"],
        env={"PYTHONIOENCODING": encoding, "PATH": "/usr/bin:/bin"},
        capture_output=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    assert ("deg" if encoding == "ascii" else "°") in done.stdout.decode(encoding)


def test_a_reader_that_leaves_is_no_traceback() -> None:
    done = subprocess.run(
        f'"{sys.executable}" -c "from flexor.cli.app import main; main()" simulate finger | true',
        shell=True,
        capture_output=True,
        check=False,
    )
    assert done.stderr == b""
