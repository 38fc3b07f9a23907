"""Draw the pictures of the studio and of a shared page in docs/images, with Chromium.

`.venv/bin/python .ci/page_pictures.py`; needs what `./dev test-browser` needs.
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT))

import flexor  # noqa: E402
from flexor.studio import serve, workbench  # noqa: E402
from flexor.study import Problem  # noqa: E402
from flexor.viewer import share_page  # noqa: E402
from tests.browser.bidi import Browser, browser  # noqa: E402

IMAGES = ROOT / "docs" / "images"
MODEL = "pneumatic-finger"


def studio(tab: Browser) -> None:
    """Draw the start beside what a search of 150 designs finds, with strain as colour."""
    model = flexor.load(MODEL)
    stated = model.file.design
    assert stated is not None
    problem = Problem.of(
        model, dict(stated.varied), "maximise range-of-motion", subject_to=stated.subject_to
    )
    running = serve(workbench(model, problem, source=f"{MODEL}.toml")).start()
    try:
        tab.size(1500, 1180)
        tab.open(running.url)
        tab.wait("document.body.dataset.ready")
        tab.click("#keep")
        tab.run("document.querySelector('#budget').value = 150")
        tab.click("#search")
        tab.wait("document.querySelector('#search-status').textContent.includes('ended')", 300)
        tab.wait("!document.body.dataset.busy")
        tab.choose("#field", "strain")
        tab.click("[data-from=oblique]")
        tab.run("scrollTo(0, 0)")
        (IMAGES / "studio.png").write_bytes(tab.screenshot())
    finally:
        running.stop()


def shared(tab: Browser) -> None:
    """Draw the page of the model as it is."""
    with tempfile.TemporaryDirectory() as folder:
        page = Path(folder) / "page.html"
        page.write_text(share_page(flexor.load(MODEL), f"{MODEL}.toml"), encoding="utf-8")
        tab.size(1300, 900)
        tab.open(f"file://{page}")
        tab.wait("document.body.dataset.ready")
        tab.choose("#field", "strain")
        (IMAGES / "shared-design.png").write_bytes(tab.screenshot())


def main() -> None:
    """Draw both."""
    with browser("chromium") as tab:
        studio(tab)
        shared(tab)


if __name__ == "__main__":
    main()
