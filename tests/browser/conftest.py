"""Browsers for the tests of pages; pictures of these go to target/browser/."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from pathlib import Path

import pytest

from .bidi import Browser, browser

PICTURES = Path(__file__).resolve().parents[2] / "target" / "browser"


@pytest.fixture(scope="module", params=["chromium", "firefox"])
def tab(request) -> Iterator[Browser]:
    """A tab of each browser; errors on its console fail the test that made them."""
    PICTURES.mkdir(parents=True, exist_ok=True)
    with browser(request.param) as made:
        made.size(1500, 1100)
        yield made


@pytest.fixture(autouse=True)
def silent(request) -> Iterator[None]:
    """Check that a test leaves no error on the console."""
    made: Browser | None = None
    with contextlib.suppress(pytest.FixtureLookupError):
        made = request.getfixturevalue("tab")
    assert made is not None
    made.console.clear()
    yield
    made.run("null")
    # What a software renderer says of its speed is no error of the page.
    assert [line for line in made.console if "GPU stall" not in line] == []


@pytest.fixture
def picture(tab):
    """A function that saves a picture of the page."""

    def save(name: str) -> None:
        (PICTURES / f"{tab.name}-{name}.png").write_bytes(tab.screenshot())

    return save
