"""The report as Markdown from templates with figures, and as one self-contained HTML file."""

from __future__ import annotations

import base64
import re
import shutil
from pathlib import Path
from types import ModuleType

from markdown_it import MarkdownIt

from flexor.errors import InputError, unknown
from flexor.plot import save
from flexor.store import write_text
from reproduction import (
    conclusions,
    constants,
    fig3,
    fig4,
    fig5,
    fig6,
    mesh,
    optimisers,
    table3,
    table4,
)
from reproduction.markdown import rendered
from reproduction.study import (
    CONSTANTS,
    HERE,
    OBJECTIVES,
    PUBLISHED,
    SETS,
    SYMBOLS,
    Data,
    Study,
    made,
    parameters,
    provenance,
    published_design,
)

# In the order of the report.
ITEMS: dict[str, ModuleType] = {
    "constants": constants,
    "conclusions": conclusions,
    "fig3": fig3,
    "fig4": fig4,
    "table3": table3,
    "fig5": fig5,
    "table4": table4,
    "fig6": fig6,
    "mesh": mesh,
    "optimisers": optimisers,
}


def chosen(names: str | None) -> tuple[str, ...]:
    """Return the items listed in a text, all by default, in the order of the report."""
    if names is None:
        return tuple(ITEMS)
    wanted = [name.strip().lower() for name in names.split(",") if name.strip()]
    for name in wanted:
        if name not in ITEMS:
            raise unknown("item of the study", name, ITEMS)
    if not wanted:
        raise InputError(f"no item of the study is named: expected some of {', '.join(ITEMS)}.")
    return tuple(name for name in ITEMS if name in wanted)


def write_report(study: Study, results: Data) -> Path:
    """Draw the figures and write report.md and report.html; return the folder."""
    figures = made(study.folder / "figures")
    for name, data in results.items():
        if hasattr(ITEMS[name], "draw"):
            for title, figure in ITEMS[name].draw(study, data).items():
                save(figure, figures / f"{title}.png")
                figure.set_layout_engine(None)  # it is laid out
                save(figure, figures / f"{title}.svg")
    text = render(results, study)
    write_text(study.folder / "report.md", text)
    write_text(study.folder / "report.html", html(text, study.folder))
    return study.folder


def write_docs(report: Path, docs: Path) -> None:
    """Copy the report into the documentation."""
    images = docs.parent / "images" / "reproduction"
    shutil.rmtree(images, ignore_errors=True)
    images.mkdir(parents=True)
    text = (report / "report.md").read_text(encoding="utf-8")
    for name in sorted(set(re.findall(r"\(figures/([\w-]+\.png)\)", text))):
        shutil.copy(report / "figures" / name, images / name)
    docs.write_text(text.replace("(figures/", "(images/reproduction/"), encoding="utf-8")


def render(results: Data, study: Study) -> str:
    """Return the report in Markdown."""
    return rendered(
        "report.md.j2",
        {"design": format_design, "number": number},
        **results,
        items=tuple(results),
        paper=PUBLISHED,
        sets=SETS,
        objectives=OBJECTIVES,
        symbols=SYMBOLS,
        constant_sets=CONSTANTS,
        parameters=parameters,
        published_design=lambda *which: published_design(*which) / parameters(which[0]).scale,
        seed=study.seed,
        provenance=provenance(),
        hours=sum(
            search["minutes"]
            for search in (
                *PUBLISHED["table3"].values(),
                *(PUBLISHED["table4"][name] for name in OBJECTIVES[:3]),
            )
        )
        / 60.0,
    )


def html(text: str, folder: Path) -> str:
    """Return the report as HTML with embedded figures."""
    body = MarkdownIt("commonmark").enable("table").render(text)
    body = re.sub(
        r'src="(figures/[\w-]+\.png)"',
        lambda found: f'src="data:image/png;base64,{_encoded(folder / found[1])}"',
        body,
    )
    style = (HERE / "templates" / "report.css").read_text(encoding="utf-8")
    return (
        '<!DOCTYPE html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        f"<title>The published study, reproduced</title>\n<style>{style}</style>\n</head>\n"
        f"<body>\n{body}</body>\n</html>\n"
    )


def format_design(values: list[float], name: str, digits: int = 4) -> str:
    """Return a design in the units of the paper, with at most ``digits`` decimals."""
    chosen_set = parameters(name)
    words: list[str] = []
    for unit in dict.fromkeys(chosen_set.units):
        inside = ", ".join(
            fixed(value, digits)
            for value, its in zip(values, chosen_set.units, strict=True)
            if its == unit
        )
        words.append(inside if unit in ("1", "rad") else f"{inside} {unit}")
    return "; ".join(words)


def fixed(value: float, decimals: int) -> str:
    """Return a number with at most ``decimals`` decimals, without trailing zeros or -0."""
    text = f"{value + 0.0:.{decimals}f}".rstrip("0").rstrip(".") if decimals else f"{value:.0f}"
    return "0" if text in ("-0", "") else text


def number(value: float | None, digits: int = 4) -> str:
    """Return a number with ``digits`` significant digits, without trailing zeros or -0."""
    if value is None:
        return "–"
    if isinstance(value, int):
        return f"{value:,}"
    if abs(value) < 1e-12:
        return "0"
    return f"{value:.{digits}g}"


def _encoded(file: Path) -> str:
    return base64.b64encode(file.read_bytes()).decode()
