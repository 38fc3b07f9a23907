"""The page of `flexor studio` in real browsers: every control used."""

from __future__ import annotations

import io
import re

import numpy as np
import pytest
from matplotlib.image import imread

import flexor
from flexor.model import parse
from flexor.studio import serve, workbench
from flexor.study import Problem

from .bidi import Browser

SEARCH, LANDSCAPE = "#search", "#landscape"


@pytest.fixture(scope="module")
def url():
    model = flexor.load("pneumatic-finger")
    stated = model.file.design
    problem = Problem.of(
        model, dict(stated.varied), "maximise range-of-motion", subject_to=stated.subject_to
    )
    studio = serve(workbench(model, problem, source="pneumatic-finger.toml")).start()
    yield studio.url
    studio.stop()


@pytest.fixture
def page(tab: Browser, url: str) -> Browser:
    tab.size(1700, 1300)
    tab.open(url)
    tab.wait("document.body.dataset.ready")
    return tab


def settled(page: Browser) -> None:
    """Wait until the last move has been solved and is shown."""
    page.wait("!document.body.dataset.busy")


def view(page: Browser) -> np.ndarray:
    return imread(io.BytesIO(page.screenshot(".host")))[..., :3]


def differ(one: np.ndarray, other: np.ndarray) -> bool:
    return one.shape != other.shape or bool((np.abs(one - other).max(axis=2) > 0.05).sum() > 200)


def number(page: Browser, selector: str) -> float:
    return float(page.run(f"document.querySelector({selector!r}).value"))


def bending(page: Browser) -> float:
    text = page.text(".observables tbody tr td")
    return float(re.findall(r"[\d.]+", text)[0])


def test_sliders_solve_again(page, picture) -> None:
    before, seen = bending(page), view(page)
    many = page.run("document.querySelectorAll('.slider').length")
    assert many == 9
    for k in range(8):
        low, high = (number_of(page, f"#values-{k}", end) for end in ("min", "max"))
        middle = low + 0.4 * (high - low)
        page.slide(f"#values-{k}", middle)
        settled(page)
        assert page.text("#message") == ""
        assert number(page, f"#values-{k}") == pytest.approx(middle, rel=1e-6)
    assert bending(page) != before
    assert differ(view(page), seen)
    page.slide("#loads-0", 90.0)
    settled(page)
    assert page.text(".stepper output") == "90 kPa"
    picture("studio")


def number_of(page: Browser, selector: str, attribute: str) -> float:
    return float(page.run(f"document.querySelector({selector!r}).getAttribute({attribute!r})"))


def test_keys_and_numbers_move_sliders(page) -> None:
    start = number(page, "#values-0")
    page.run("document.querySelector('#values-0').focus()")
    page.keys("Right", "Right")
    settled(page)
    step = (number_of(page, "#values-0", "max") - number_of(page, "#values-0", "min")) / 200
    assert number(page, "#values-0") == pytest.approx(start + 2 * step)
    box = ".slider input[type=number]"
    page.run(f"(() => {{ const e = document.querySelector('{box}'); e.value = 30;"
             " e.dispatchEvent(new Event('change', {bubbles: true})); })()")  # fmt: skip
    settled(page)
    assert page.text(".stepper output") == "30 kPa"


def test_undo_redo_and_reset(page) -> None:
    start = number(page, "#values-3")
    assert page.run("document.querySelector('#undo').disabled")
    page.run("document.querySelector('#values-3').focus()")
    page.keys("Right")
    page.keys("Right")
    settled(page)
    moved = number(page, "#values-3")
    page.click("#undo")
    page.click("#undo")
    settled(page)
    assert number(page, "#values-3") == pytest.approx(start)
    page.click("#redo")
    page.keys("Z", holding="Control")
    page.click("#redo")
    page.click("#redo")
    settled(page)
    assert number(page, "#values-3") == pytest.approx(moved)
    page.click("#reset")
    settled(page)
    assert number(page, "#values-3") == pytest.approx(start)


def test_two_designs_are_compared(page, picture) -> None:
    page.click("#keep")
    page.slide("#values-3", 1.5)
    settled(page)
    assert page.run("document.querySelectorAll('.names span').length") == 2
    assert page.run("document.querySelectorAll('.series.second').length") > 4
    page.choose("#field", "strain")
    picture("studio-compare")
    page.choose("#field", "")
    page.click("#compare")
    assert page.run("document.querySelectorAll('.names span').length") == 0
    page.click("#restore")
    settled(page)
    assert number(page, "#values-3") == pytest.approx(2.0)


def test_verdict_follows_the_design(page) -> None:
    assert "Feasible" in page.text(".say")
    page.slide("#loads-0", 120.0)
    settled(page)
    assert "NOT FEASIBLE" in page.text(".say")
    assert "BROKEN" in page.text(".verdict")


def test_landscape_shows_where_the_design_is(page, picture) -> None:
    page.choose("#across", "3")
    page.choose("#up", "0")
    page.run("document.querySelector('#points').value = 9")
    page.click(LANDSCAPE)
    page.wait(f"document.querySelector('{LANDSCAPE}').textContent === 'Evaluate'", 120)
    assert "81 of 81 designs" in page.text("#landscape-status")
    page.run("document.querySelector('#map').scrollIntoView({block: 'center'})")
    picture("studio-landscape")
    before = number(page, "#values-3"), number(page, "#values-0")
    page.click("#map")
    settled(page)
    after = number(page, "#values-3"), number(page, "#values-0")
    assert after != before
    page.run("document.querySelector('#points').value = 101")
    page.click(LANDSCAPE)
    page.wait("/[1-9]\\d* of 10201/.test(document.querySelector('#landscape-status').textContent)")
    page.click(LANDSCAPE)
    page.wait("document.querySelector('#landscape-status').textContent.includes('stopped')", 20)


def test_a_search_is_watched_and_stopped(page, picture) -> None:
    start = bending(page)
    page.run("document.querySelector('#budget').value = 60")
    page.choose("#method", "pattern-search")
    page.click(SEARCH)
    page.wait(f"document.querySelector('{SEARCH}').textContent === 'Run'", 120)
    settled(page)
    assert "ended" in page.text("#search-status")
    assert bending(page) > start
    assert page.run("document.querySelectorAll('#history svg').length") == 1
    picture("studio-search")
    page.run("document.querySelector('#budget').value = 100000")
    page.click("#follow")
    page.click(SEARCH)
    page.wait("/^\\d+ designs/.test(document.querySelector('#search-status').textContent)")
    page.click(SEARCH)
    page.wait("document.querySelector('#search-status').textContent.includes('stopped')", 20)
    page.click("#undo")
    settled(page)


def test_everything_is_saved(page) -> None:
    for name, ending, least in [
        ("model", ".toml", 2000),
        ("png", ".png", 5000),
        ("json", ".json", 2000),
        ("stl", ".stl", 50_000),
        ("share", ".html", 700_000),
    ]:
        page.run("delete document.body.dataset.saved")
        page.click(f"#save-{name}")
        page.wait("document.body.dataset.saved", 60)
        kind, size = str(page.run("document.body.dataset.saved")).split()
        assert kind == ending
        assert int(size) > least
        assert page.text("#message") == ""


def test_fields_camera_and_steps_are_those_of_a_shared_page(page, picture) -> None:
    seen = view(page)
    page.choose("#field", "contact-pressure")
    assert "kPa" in page.text(".legend")
    assert differ(view(page), seen)
    page.click("#through")
    page.click("[data-from=top]")
    picture("studio-pressure")
    page.click("#through")
    page.choose("#field", "")
    page.slide("#step", 1)
    assert page.text(".stepper output") == "12 kPa"
    page.click("#play")
    page.wait("document.querySelector('.stepper output').textContent === '24 kPa'", 10)
    page.click("#play")


def test_two_tabs_do_not_disturb_each_other(page, url) -> None:
    first = page.another()
    page.open(url)
    page.wait("document.body.dataset.ready")
    page.slide("#values-3", 2.9)
    settled(page)
    page.close_tab()
    page.use(first)
    assert number(page, "#values-3") == pytest.approx(2.0)
    before = bending(page)
    page.slide("#values-3", 2.0)
    settled(page)
    assert bending(page) == pytest.approx(before)


@pytest.mark.parametrize("width", [900, 480])
def test_the_view_is_in_sight_in_a_narrow_frame(tab, url, picture, width) -> None:
    tab.size(width, 900)
    tab.open(url)
    tab.wait("document.body.dataset.ready")

    def bounds(selector: str) -> list[float]:
        box = f"document.querySelector({selector!r}).getBoundingClientRect()"
        return [float(tab.run(f"{box}.{each}")) for each in ("top", "bottom", "left", "right")]

    top, bottom, left, right = bounds(".host")
    assert top >= 0.0
    assert bottom <= 900.0
    assert right - left >= 400.0
    assert tab.run("document.documentElement.scrollWidth") <= width
    # It still is when the last of the sliders has been reached.
    tab.run("document.querySelector('#values-7').scrollIntoView({block: 'end'})")
    top, bottom, *_ = bounds(".host")
    assert top >= 0.0
    assert bottom <= 900.0
    tab.slide("#values-7", 0.5)
    settled(tab)
    assert tab.text("#message") == ""
    picture(f"studio-{width}")


def test_a_model_with_nothing_to_vary_has_loads(tab) -> None:
    text = flexor.load("tendon-arm").file.to_toml()
    studio = serve(workbench(flexor.load(parse(text)))).start()
    try:
        tab.open(studio.url)
        tab.wait("document.body.dataset.ready")
        assert tab.run("document.querySelector('#search')") is None
        assert tab.run("document.querySelectorAll('.slider').length") >= 1
    finally:
        studio.stop()
