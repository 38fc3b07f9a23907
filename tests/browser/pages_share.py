"""The page of `flexor share`, opened from a file in real browsers: every control used."""

from __future__ import annotations

import io
from itertools import pairwise

import numpy as np
import pytest
from matplotlib.image import imread

import flexor
from flexor.viewer import share_page

from .bidi import Browser, browser
from .conftest import PICTURES

SHOWN = "document.querySelector('.stepper output').textContent"


@pytest.fixture(scope="module")
def file(tmp_path_factory) -> str:
    model = flexor.load("pneumatic-finger")
    bounds = {"exosuit.section.wall": ("1.5 mm", "3 mm")}
    study = flexor.optimize(
        model, bounds, "maximise range-of-motion", "grid", method_options={"points": 3}
    )
    made = tmp_path_factory.mktemp("share") / "design.html"
    made.write_text(share_page(study, "studies/wall"), encoding="utf-8")
    return f"file://{made}"


@pytest.fixture(scope="module")
def rubbing(tmp_path_factory) -> str:
    made = tmp_path_factory.mktemp("share") / "capstan.html"
    made.write_text(share_page(flexor.load("capstan")), encoding="utf-8")
    return f"file://{made}"


@pytest.fixture(scope="module")
def front(tmp_path_factory) -> str:
    aims = ["maximise range-of-motion", "minimise mass"]
    bounds = {"exosuit.section.wall": ("1.5 mm", "3 mm"), "exosuit.length": ("9 cm", "11 cm")}
    study = flexor.optimize(flexor.load("pneumatic-finger"), bounds, aims, "pareto", budget=40)
    made = tmp_path_factory.mktemp("share") / "front.html"
    made.write_text(share_page(study), encoding="utf-8")
    return f"file://{made}"


@pytest.fixture
def page(tab: Browser, file: str) -> Browser:
    tab.open(file)
    tab.wait("document.body.dataset.ready")
    return tab


def view(tab: Browser) -> np.ndarray:
    """Return the picture of the view, (h, w, 3)."""
    return imread(io.BytesIO(tab.screenshot(".host")))[..., :3]


def differ(one: np.ndarray, other: np.ndarray) -> bool:
    """Whether two pictures differ in more than a few points."""
    return one.shape != other.shape or bool((np.abs(one - other).max(axis=2) > 0.05).sum() > 200)


def test_page_shows_the_design(page, picture) -> None:
    seen = view(page)
    saturated = np.ptp(seen, axis=2) > 0.25
    assert 0.03 < saturated.mean() < 0.6
    assert len(np.unique((31 * seen).astype(int).reshape(-1, 3), axis=0)) > 100
    assert page.run(SHOWN) == "60 kPa"
    assert page.text("h1").startswith("Half-round silicone exosuit")
    assert page.run("document.querySelectorAll('.chart').length") == 6
    picture("share")


def test_slider_and_keys_move_through_the_loads(page) -> None:
    before = view(page)
    page.slide("#step", 2)
    assert page.run(SHOWN) == "24 kPa"
    assert differ(view(page), before)
    page.click("#step")
    page.keys("Home")
    assert page.run(SHOWN) == "0 kPa"
    page.keys("Right")
    assert page.run(SHOWN) == "12 kPa"
    assert page.run("document.querySelector('#step').getAttribute('aria-valuetext')") == "12 kPa"


def test_play_runs_through_the_loads_and_stops(page) -> None:
    page.click("#play")
    page.wait(f"{SHOWN} === '12 kPa'", 10)
    page.click("#play")
    stopped = page.run(f"new Promise(r => setTimeout(() => r({SHOWN}), 900))")
    assert stopped == page.run(SHOWN)


def test_fields_have_a_scale_with_unit(page, picture) -> None:
    plain = view(page)
    page.choose("#field", "contact-pressure")
    assert "pressure of contact / kPa" in page.text(".legend")
    page.click("[data-from=oblique]")
    picture("share-pressure")
    page.choose("#field", "strain")
    assert "/ %" in page.text(".legend")
    assert differ(view(page), plain)
    picture("share-strain")
    page.choose("#field", "")
    assert page.run("document.querySelector('.legend')") is None


def test_see_through_shows_the_chamber(page, picture) -> None:
    before = view(page)
    page.click("#through")
    assert differ(view(page), before)
    picture("share-through")
    page.click("#through")


def test_see_through_leaves_the_pressure_on_the_skin(page, picture) -> None:
    page.choose("#field", "contact-pressure")
    page.click("[data-from=top]")
    before = view(page)
    page.click("#through")
    after = view(page)
    picture("share-pressure-through")
    page.click("#through")
    page.choose("#field", "")
    page.click("[data-from=oblique]")
    assert (np.ptp(after, axis=2) > 0.3).sum() > 0.9 * (np.ptp(before, axis=2) > 0.3).sum() > 100


def test_friction_is_seen_where_it_holds_and_where_it_slides(tab, rubbing, picture) -> None:
    tab.open(rubbing)
    tab.wait("document.body.dataset.ready")
    assert "friction holds" in tab.text(".marks")
    seen = [view(tab)]
    picture("share-friction")
    for step in (1, 9):
        tab.slide("#step", step)
        seen.append(view(tab))
    assert all(differ(one, other) for one, other in pairwise(seen))
    assert tab.run("document.querySelector('.say').className").strip() == "say"


def test_ends_of_a_front_are_chosen_and_compared(tab, front, picture) -> None:
    tab.open(front)
    tab.wait("document.body.dataset.ready")
    titles = tab.run("[...document.querySelectorAll('#designs option')].map(o => o.textContent)")
    assert any("maximise range-of-motion" in title for title in titles)
    assert any("minimise mass" in title for title in titles)
    one = view(tab)
    tab.choose("#designs", "1")
    assert differ(view(tab), one)
    tab.choose("#designs", "both")
    columns = tab.run("document.querySelectorAll('.names span').length")
    assert columns == len(titles) - 1
    picture("share-front")


def test_camera_turns_by_mouse_keys_and_buttons(page) -> None:
    seen = [view(page)]
    for name in ("side", "top", "front", "oblique"):
        page.click(f"[data-from={name}]")
        seen.append(view(page))
    page.drag(".host canvas", 120, 40)
    seen.append(view(page))
    page.run("document.querySelector('.host canvas').focus()")
    for key in ("Left", "Up", "+", "-"):
        page.keys(key)
        seen.append(view(page))
    assert all(differ(one, other) for one, other in pairwise(seen[1:]))


def test_start_and_optimum_side_by_side(page, picture) -> None:
    one = view(page)
    page.choose("#designs", "both")
    assert page.run("document.querySelectorAll('.names span').length") == 2
    assert differ(view(page), one)
    assert page.run("document.querySelectorAll('.series.second').length") > 4
    picture("share-both")
    page.choose("#designs", "1")
    assert page.run("document.querySelectorAll('.names span').length") == 0
    page.choose("#designs", "0")


def test_all_controls_are_reached_by_tab(page) -> None:
    page.run("document.activeElement.blur()")
    reached = set()
    for _ in range(25):
        page.keys("Tab")
        reached.add(page.run(
            "document.activeElement.id || document.activeElement.dataset.from ||"
            " document.activeElement.tagName"))  # fmt: skip
    assert {"field", "through", "step", "play", "designs", "CANVAS"} <= reached
    assert {"side", "top", "front", "oblique"} <= reached


def test_text_has_contrast_in_light_and_dark(page, file) -> None:
    ratio = """(() => {
      const bright = (text) => {
        const [r, g, b] = text.match(/[\\d.]+/g).map(Number).map((v) => v / 255)
          .map((v) => (v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4));
        return 0.2126 * r + 0.7152 * g + 0.0722 * b;
      };
      const page = bright(getComputedStyle(document.body).backgroundColor);
      return Math.min(...[...document.querySelectorAll('h1, p, td, th, dt, figcaption, .value')]
        .map((e) => bright(getComputedStyle(e).color))
        .map((l) => (Math.max(l, page) + 0.05) / (Math.min(l, page) + 0.05)));
    })()"""
    assert not page.run("matchMedia('(prefers-color-scheme: dark)').matches")
    assert page.run(ratio) >= 4.5
    with browser(page.name, dark=True) as other:
        other.size(1500, 1100)
        other.open(file)
        other.wait("document.body.dataset.ready")
        assert other.run("matchMedia('(prefers-color-scheme: dark)').matches")
        assert other.run(ratio) >= 4.5
        other.choose("#field", "strain")
        (PICTURES / f"{page.name}-share-dark.png").write_bytes(other.screenshot())


def test_narrow_windows_have_one_column(page, picture) -> None:
    page.size(600, 900)
    try:
        assert page.run("document.documentElement.scrollWidth") <= 600
        picture("share-narrow")
    finally:
        page.size(1500, 1100)
