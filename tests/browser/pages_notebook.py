"""What notebooks show, in a light and in a dark page of real browsers."""

from __future__ import annotations

import pytest

import flexor
from flexor.materials.library import find

from .bidi import Browser

SHOWN = ("model", "path", "study", "landscape", "material", "animation")
# As themes of notebooks do: the page has colours, and what it shows inherits them.
THEMES = {"light": ("#ffffff", "#1d2226"), "dark": ("#14181b", "#e8ecef")}


@pytest.fixture(scope="module")
def pages(tmp_path_factory) -> dict[str, str]:
    model = flexor.load("pneumatic-finger")
    bounds = {"exosuit.section.wall": ("1.5 mm", "3 mm"), "exosuit.length": ("9 cm", "11 cm")}
    path = model.equilibrium()
    shown = [
        model,
        path,
        flexor.optimize(model, bounds, "maximise range-of-motion", budget=12),
        flexor.landscape(model, bounds, "maximise range-of-motion", grid=4),
        find("dragon-skin-30"),
    ]
    texts = [each._repr_html_() for each in shown] + [flexor.plot.animation(path)._repr_html_()]
    body = "".join(f'<section id="{n}">{t}</section>' for n, t in zip(SHOWN, texts, strict=True))
    folder, made = tmp_path_factory.mktemp("notebook"), {}
    for theme, (paper, ink) in THEMES.items():
        file = folder / f"{theme}.html"
        style = f"body {{ background: {paper}; color: {ink}; font: 14px sans-serif }}"
        file.write_text(
            f'<!doctype html><meta charset="utf-8"><link rel="icon" href="data:,">'
            f"<title>{theme}</title><style>{style}</style>{body}",
            encoding="utf-8",
        )
        made[theme] = f"file://{file}"
    return made


@pytest.mark.parametrize("theme", THEMES)
def test_everything_is_seen(tab: Browser, pages, theme, picture) -> None:
    tab.size(1000, 3400)
    try:
        tab.open(pages[theme])
        tab.wait("[...document.images].every(each => each.complete)")
        widths = tab.run("[...document.images].map(each => each.naturalWidth)")
        assert min(widths) > 200
        assert len(widths) == len(SHOWN)
        cells = tab.run("""(() => {
          const bright = (text) => {
            const [r, g, b] = text.match(/[\\d.]+/g).map(Number).map((v) => v / 255)
              .map((v) => (v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4));
            return 0.2126 * r + 0.7152 * g + 0.0722 * b;
          };
          const page = bright(getComputedStyle(document.body).backgroundColor);
          return [...document.querySelectorAll('strong, th, td')]
            .map((each) => bright(getComputedStyle(each).color))
            .map((l) => (Math.max(l, page) + 0.05) / (Math.min(l, page) + 0.05));
        })()""")
        assert len(cells) > 50
        assert min(cells) >= 4.5
        assert tab.run("document.documentElement.scrollWidth") <= 1000
        picture(f"notebook-{theme}")
    finally:
        tab.size(1500, 1100)


def test_a_path_moves(tab: Browser, pages) -> None:
    tab.open(pages["light"])
    tab.wait("[...document.images].every(each => each.complete)")
    source = "document.querySelector('#animation img').src"
    symbols = "[...document.querySelectorAll('#animation button')].map(e => e.textContent.trim())"
    assert all(tab.run(symbols))
    first = tab.run(source)
    tab.run("[...document.querySelectorAll('#animation button')].at(-3).click()")
    tab.wait(f"{source} !== {first!r}", 10)
