"""The page of results, with its pictures."""

from __future__ import annotations

import math
import shutil
from pathlib import Path
from typing import TYPE_CHECKING

from flexor.plot import save
from flexor.store import write_text
from reproduction.beyond import models
from reproduction.beyond.cases import CASES, followed
from reproduction.markdown import rendered
from reproduction.panels import draw_designs
from reproduction.report import fixed
from reproduction.study import PUBLISHED, Data, Study, made

if TYPE_CHECKING:
    from matplotlib.figure import Figure

# Figures by their names, each with the cases that it shows.
FIGURES = {
    "ties": ("paper", "pin", "slider", "weld"),
    "interaction": ("friction", "wrapped", "muscles", "tone"),
    "sizes": ("mean", "small", "large"),
    "chambers": ("curl", "curl-slider"),
}
SYMBOLS = {
    "exosuit.length": "L",
    "exosuit.radius.base": "R_0",
    "exosuit.radius.tip": "R_1",
}
HALVES = {
    "exosuit.length": "L of the halves",
    "far.length": "",
    "exosuit.radius.tip": "radii R_1 of the first, R_0 and R_1 of the second",
    "far.radius.base": "",
    "far.radius.tip": "",
    "evaluation.loads.first": "forces",
    "evaluation.loads.second": "",
}


def figures(results: Data) -> dict[str, Figure]:
    """Draw Table I and the best design of every case that has results."""
    drawn = {}
    for name, shown in FIGURES.items():
        panels = {}
        for each in shown:
            if each in results:
                case, data = CASES[each], results[each]
                title = case.title.replace(", ", ",\n")
                panels[f"{title}\nTable I: {_degrees(data['before'])}"] = followed(case)
                panels[f"{title}\nbest: {_degrees(data['after'])}"] = followed(case, data["design"])
        if panels:
            drawn[name] = draw_designs(panels, "at the last load" if name == "chambers" else None)
    return drawn


def write_page(study: Study, results: Data) -> Path:
    """Write the page and its pictures into the folder of the study; return the page."""
    folder = made(study.folder / "figures")
    for name, figure in figures(results).items():
        save(figure, folder / f"{name}.png")
    text = rendered(
        "beyond.md.j2",
        {"degrees": lambda angle: fixed(math.degrees(angle), 1), "angles": _joints},
        results=results,
        cases=CASES,
        design=design,
        models=models,
        published=PUBLISHED,
    )
    page = study.folder / "beyond.md"
    write_text(page, text)
    return page


def write_docs(page: Path, docs: Path) -> None:
    """Copy the page and its pictures into the documentation."""
    images = docs.parent / "images" / "beyond"
    shutil.rmtree(images, ignore_errors=True)
    shutil.copytree(page.parent / "figures", images)
    text = page.read_text(encoding="utf-8")
    docs.write_text(text.replace("(figures/", "(images/beyond/"), encoding="utf-8")


def design(data: Data) -> str:
    """Return a design as text: values of one kind together, with their unit."""
    known = HALVES if "far.length" in data["labels"] else SYMBOLS
    words: list[str] = []
    for label, unit, value in zip(data["labels"], data["units"], data["shown"], strict=True):
        text = fixed(value, 4)
        name = known.get(label, label)
        if name:
            words.append(f"{name} {text} {unit}")
        else:
            words[-1] = f"{words[-1].removesuffix(f' {unit}')}, {text} {unit}"
    return "; ".join(words)


def _joints(angles: list[float]) -> str:
    return ", ".join(fixed(math.degrees(angle), 0) for angle in angles) + "°"


def _degrees(data: Data) -> str:
    return f"{math.degrees(data['bending']):.0f}°"
