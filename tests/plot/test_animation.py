"""Paths as animations."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from PIL import Image

from flexor import plot
from flexor.errors import InputError
from flexor.model import load


@pytest.mark.parametrize("name", ["finger", "tendon-arm"])
def test_an_animation_has_a_picture_for_each_load(name: str, tmp_path: Path) -> None:
    path = load(name).equilibrium([0.0, 0.5, 1.0])
    file = tmp_path / "path.gif"
    plot.animation(path).save(file, dpi=50)
    with Image.open(file) as image:
        assert image.n_frames == 3


def test_a_notebook_shows_it_without_a_network() -> None:
    text = plot.animation(load("finger").equilibrium([0.0, 1.0]))._repr_html_()
    assert not re.search(r"""(?:src|href)=["']?https?:""", text)
    buttons = re.findall(r"<button[^>]*>(.*?)</button>", text, re.DOTALL)
    assert len(buttons) == 9
    assert all(each.strip() and "<" not in each for each in buttons)
    assert text.count("data:image/png") == 2


def test_a_path_without_equilibria_is_refused() -> None:
    path = load("finger").equilibrium([5.0], max_iterations=1)
    assert not path.converged.any()
    with pytest.raises(InputError, match="no equilibrium"):
        plot.animation(path)
