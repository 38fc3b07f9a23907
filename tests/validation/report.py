"""What a validation case reports, and docs/validation.md written from all of them."""

from __future__ import annotations

import os
import platform
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from datetime import date
from importlib import import_module, metadata
from pathlib import Path
from typing import Any

import pytest
from matplotlib.figure import Figure

from flexor.installing import install_command

from .comparison import Comparison
from .page import draw_figure, write_page

FAMILIES = ("Closed forms", "Other libraries", "Convergence", "The toolbox of the paper")
LIBRARIES = ("pin", "pyelastica", "soromox", "mujoco", "myo-sim")
IMAGES = Path("images", "validation")


@dataclass
class Case:
    """A validation case: where its reference comes from, and what was compared.

    The test function gives name and docstring (first line: the title; the rest: system, reference
    and its source, in Markdown), its module gives the family.
    """

    name: str
    title: str
    about: str
    family: str
    comparisons: Sequence[Comparison] = ()
    draw: Callable[[Figure], None] | None = None
    caption: str = ""
    panels: int = 1
    verdict: str = "failed"
    reason: str = ""

    def check(
        self,
        comparisons: Sequence[Comparison],
        draw: Callable[[Figure], None] | None = None,
        caption: str = "",
        panels: int = 1,
    ) -> None:
        """Record comparisons and a figure for the report; fail unless every comparison passed."""
        self.comparisons, self.draw, self.caption, self.panels = comparisons, draw, caption, panels
        assert comparisons, "a case must compare something"
        failed = [comparison for comparison in comparisons if not comparison.passed]
        assert not failed, "\n".join(map(str, failed))


def load(package: str, module: str) -> Any:
    """Import a library that serves as reference; skip the test where it is not installed."""
    try:
        return import_module(module)
    except ModuleNotFoundError as error:
        if error.name is None or error.name.split(".")[0] != module.split(".")[0]:
            raise
        pytest.skip(f"{package} is missing: {install_command('flexor[validate]')}")


def write(cases: Sequence[Case], folder: Path) -> Path:
    """Write ``validation.md`` and ``images/validation/`` into a folder; return the page."""
    figures = {}
    for case in cases:
        if case.draw is not None:
            figures[case.name] = (IMAGES / f"{case.name}.png").as_posix()
            draw_figure(case.draw, case.panels, 0.4, folder / figures[case.name])
    families = {name: [case for case in cases if case.family == name] for name in FAMILIES}
    page = folder / "validation.md"
    write_page(
        Path(__file__).with_name("validation.md.jinja"),
        page,
        families={name: members for name, members in families.items() if members},
        figures=figures,
        date=date.today().isoformat(),
        machine=f"{platform.system()} {platform.machine()}, {os.cpu_count()} cores",
        python=platform.python_version(),
        versions=[f"{name} {version}" for name, version in _versions().items()],
    )
    return page


def _versions() -> dict[str, str]:
    found = {}
    for package in ("flexor", "numpy", "scipy", *LIBRARIES):
        try:
            found[package] = metadata.version(package)
        except metadata.PackageNotFoundError:
            continue
    return found
