"""How exactly a path is known, and that tables hide no force that is known."""

from __future__ import annotations

import io

import numpy as np
import pytest
from rich.console import Console

import flexor
from flexor.cli import table
from flexor.cli.path_report import report
from flexor.model import Model
from flexor.model.accuracy import accuracy, force_accuracy

# Two carts that are pushed against plates, one with 1 MN and one with 0.1 mN.
CARTS = """
name = "carts"
planar = true
{carts}
"""
CART = """
[bodies.{name}]
kind = "link"
length = "10 cm"
radius = "1 cm"
joint = {{ kind = "prismatic", axis = "x", stiffness = "{soft} N/m" }}
placement = {{ z = "{z} cm" }}

[spheres.{name}]
points = [{{ body = "{name}", at = "tip" }}]

[obstacles.at_{name}]
kind = "half-space"
spheres = ["{name}"]
point = {{ x = "11 cm" }}
normal = [-1, 0, 0]
stiffness = "{stiff} N/m"

[wrenches.on_{name}]
body = "{name}"
at = "tip"
force = {{ x = "{force} N" }}
"""
PUSHED = {"heavy": 1e6, "light": 1e-4}


@pytest.fixture(scope="module")
def carts() -> Model:
    words = ((0, 1.0, 1e9), (30, 1e-6, 10.0))
    text = "".join(
        CART.format(name=name, z=z, soft=soft, stiff=stiff, force=PUSHED[name])
        for name, (z, soft, stiff) in zip(PUSHED, words, strict=True)
    )
    return flexor.load(flexor.model.parse(CARTS.format(carts=text)))


def printed(model: Model, monkeypatch: pytest.MonkeyPatch) -> list[list[str]]:
    stream = io.StringIO()
    monkeypatch.setattr(table, "out", Console(file=stream, width=200))
    report(model.equilibrium())
    return [line.split() for line in stream.getvalue().splitlines()]


def test_a_small_force_beside_a_large_one_is_shown(
    carts: Model, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Ten orders of magnitude apart, each is that which pushes (but for the joint's spring)."""
    path = carts.equilibrium()
    found = path.obstacle_forces()
    known = force_accuracy(path, lambda each: each.obstacle_forces())
    for name, pushed in PUSHED.items():
        assert found[f"at_{name}"][-1] == pytest.approx(pushed, rel=1e-3)
        assert known[f"at_{name}"][-1] < 1e-3 * pushed
    rows = printed(carts, monkeypatch)
    assert any("1e+06" in row and "0.0001" in row for row in rows)


@pytest.mark.parametrize("name", ["pneumatic-finger", "load-cell"])
def test_paths_are_as_exact_as_is_said(name: str) -> None:
    """Against equilibria with a hundredth of the tolerance."""
    model = flexor.load(name)
    path, better = model.equilibrium(), model.equilibrium(tolerance=1e-11)
    known = accuracy(path)
    assert (known.strain > 0.0).all() and (known.place < 1e-8).all()

    def forces(each):
        return {**each.strap_forces(), **each.obstacle_forces()}

    least, other = force_accuracy(path, forces), forces(better)
    for each, values in forces(path).items():
        assert (np.abs(values - other[each]) <= 2.0 * least[each]).all()
        assert (least[each] <= 1e-4 * values.max()).all()
    if path.max_overlap is not None:
        assert (np.abs(path.max_overlap - better.max_overlap) <= known.place).all()


def test_what_is_unloaded_is_zero(monkeypatch: pytest.MonkeyPatch) -> None:
    """Straps at rest, from which only rounding keeps zero."""
    for name in ("pneumatic-finger", "four-bar", "load-cell"):
        for row in printed(flexor.load(name), monkeypatch):
            cells = [cell for cell in row if cell.replace("e-", "").replace(".", "").isdigit()]
            assert all(float(cell) == 0.0 or float(cell) > 1e-7 for cell in cells), row
