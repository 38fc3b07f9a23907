"""Check the built site: `python .ci/check_site.py site`. Links lead somewhere, names are there."""

from __future__ import annotations

import re
import sys
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

# Pages of other sites are not asked; the addresses of the repository's files are.
REPOSITORY = "https://github.com/flexor/flexor/blob/main/"
ROOT = Path(__file__).resolve().parent.parent


class Page(HTMLParser):
    """The links and anchors of a page."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.links: set[str] = set()
        self.anchors: set[str] = set()
        self.without_text: list[str] = []
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Collect them."""
        given = {name: value or "" for name, value in attrs}
        self.anchors |= {given[name] for name in ("id", "name") if name in given}
        self.links |= {given[name] for name in ("href", "src") if name in given}
        if tag == "img" and not given.get("alt"):
            self.without_text.append(given.get("src", ""))


def faults(folder: Path) -> list[str]:
    """Return what is wrong with the site in a folder."""
    pages = {
        path: Page(path.read_text(encoding="utf-8"))
        for path in sorted(folder.rglob("*.html"))
        if path.name != "404.html"  # its links are absolute
    }
    found = []
    for path, page in pages.items():
        name = path.relative_to(folder)
        found += [f"{name}: no description of {image}" for image in page.without_text]
        for link in sorted(page.links):
            if why := broken(link, path, pages):
                found.append(f"{name}: {link}: {why}")
    reference = pages[folder / "python" / "index.html"].anchors
    source = (ROOT / "docs" / "python.md").read_text(encoding="utf-8")
    for name_asked in documented(source):
        if name_asked not in reference:
            found.append(f"python/index.html: {name_asked} is not there")
    return found


def documented(source: str) -> list[str]:
    """Return the names that a page asks mkdocstrings for: members, or the object itself."""
    names = []
    for section in re.split(r"^::: ", source, flags=re.MULTILINE)[1:]:
        home = section.split()[0]
        members = re.findall(r"^ +- (\w+)$", section, flags=re.MULTILINE)
        names += [f"{home}.{member}" for member in members] or [home]
    return names


def broken(link: str, page: Path, pages: dict[Path, Page]) -> str | None:
    """Return why a link of a page does not lead anywhere, or None."""
    if link.startswith(REPOSITORY):
        file = unquote(link.removeprefix(REPOSITORY).partition("#")[0])
        return None if (ROOT / file).exists() else "no such file in the repository"
    parts = urlsplit(link)
    if parts.scheme or parts.netloc or not link:
        return None
    target = (page.parent / unquote(parts.path)).resolve() if parts.path else page
    if target.is_dir():
        target /= "index.html"
    if not target.exists():
        return "no such page"
    if parts.fragment and target in pages and parts.fragment not in pages[target].anchors:
        return "no such place in the page"
    return None


def main() -> int:
    """Print the faults."""
    found = faults(Path(sys.argv[1]).resolve())
    print("\n".join(found) or "links, pictures and names: as they should be")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
