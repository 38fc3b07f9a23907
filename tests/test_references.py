"""docs/references.bib and the places that cite it."""

from __future__ import annotations

import re
from pathlib import Path

ROOT = Path(__file__).parents[1]
PAGES = (*ROOT.glob("docs/*.md"), ROOT / "README.md")


def test_every_source_is_cited_and_every_citation_has_a_source() -> None:
    sources = re.findall(r"^@\w+\{(\w+),", (ROOT / "docs/references.bib").read_text("utf-8"), re.M)
    cited = {
        key for page in PAGES for key in re.findall(r"`([a-z]+\d{4})`", page.read_text("utf-8"))
    }
    assert len(sources) == len(set(sources))
    assert set(sources) - {"exosuit"} == cited
