"""The generated pages of the reference are those of the present code: `./dev site` writes them."""

from __future__ import annotations

import runpy
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent
GENERATOR = runpy.run_path(str(ROOT / ".ci" / "reference.py"))


@pytest.mark.parametrize("name", GENERATOR["PAGES"])
def test_a_page_is_as_generated(name: str) -> None:
    page = (ROOT / "docs" / name).read_text(encoding="utf-8")
    assert page == GENERATOR["PAGES"][name](), "run ./dev site"


def test_the_version_to_cite_is_that_of_the_package() -> None:
    (version,) = (
        line.split('"')[1]
        for line in (ROOT / "Cargo.toml").read_text(encoding="utf-8").splitlines()
        if line.startswith("version = ")
    )
    assert f"{{{version}}}" in (ROOT / "docs" / "citing.md").read_text(encoding="utf-8")
    assert f"version: {version}\n" in (ROOT / "CITATION.cff").read_text(encoding="utf-8")
