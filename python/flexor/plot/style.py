"""Style of all figures: colour-blind safe and readable at column width."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path as FilePath
from typing import TYPE_CHECKING, Any

import numpy as np

from flexor.arrays import Array
from flexor.errors import InputError, one_line
from flexor.store.files import check_writable, reason, replaced

if TYPE_CHECKING:
    from matplotlib.figure import Figure

COLUMN = 3.5  # in, one column of a two-column page
PAGE = 7.2  # in, both columns
FORMATS = (".png", ".svg", ".pdf")

# Colours of Okabe and Ito, distinguishable with colour vision deficiency.
EXOSUIT = "#E69F00"
FINGER = "#E3E8EC"
LINE = "#30363B"
FORCE = "#0072B2"
CHAMBER = "#D55E00"
STRAP = "#CC79A7"
AIR = "#BFE3F7"
LAYERS = ("#6B4F1D", "#B5651D", "#C9B18A", "#F0E442", "#56B4E9", "#7570B3", "#8A949C")

# How places of extremes are marked.
MARK: dict[str, Any] = {"color": "white", "markeredgecolor": "black", "markersize": 4.5}

_RC: dict[Any, Any] = {
    "font.family": "sans-serif",
    "font.sans-serif": ["DejaVu Sans"],
    "font.size": 8.0,
    "axes.titlesize": 8.5,
    "axes.labelsize": 8.0,
    "axes.linewidth": 0.6,
    "axes.edgecolor": LINE,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": False,
    "grid.linewidth": 0.4,
    "grid.color": "#D5DADE",
    "axes.axisbelow": True,
    "xtick.labelsize": 7.5,
    "ytick.labelsize": 7.5,
    "xtick.major.width": 0.6,
    "ytick.major.width": 0.6,
    "legend.fontsize": 7.5,
    "legend.frameon": False,
    "lines.linewidth": 1.2,
    "patch.linewidth": 0.8,
    "figure.dpi": 150.0,
    "savefig.dpi": 300.0,
    "savefig.facecolor": "white",
    "svg.fonttype": "path",
    "svg.hashsalt": "flexor",
}


@contextmanager
def style() -> Iterator[None]:
    """Apply Flexor's style within the context, then restore matplotlib's settings."""
    import matplotlib

    with matplotlib.rc_context(_RC):
        yield


def shades(count: int) -> Array:
    """Return colours (count, 4) for an ordered series, light to dark, evenly spaced in lightness.

    They are viridis without its palest end.
    """
    import matplotlib

    positions = np.linspace(0.92, 0.0, count) if count > 1 else np.array([0.35])
    return np.asarray(matplotlib.colormaps["viridis"](positions), dtype=np.float64)


def distinct(count: int) -> list[dict[str, Any]]:
    """Return line styles for series without order: colours, then also dashes, that differ."""
    colours = (FORCE, CHAMBER, "#009E73", "#CC79A7", EXOSUIT, "#56B4E9", LINE)
    dashes = ("-", (0, (4, 1.5)), (0, (1, 1)), (0, (4, 1.5, 1, 1.5)))
    styles = [{"color": c, "linestyle": dash} for dash in dashes for c in colours]
    return [styles[i % len(styles)] for i in range(count)]


def own_name(name: str) -> str:
    """Return the name of an entry without those of the parts that it belongs to."""
    return name.rpartition(".")[2]


def material_shades(names: Iterable[str], first: Any = EXOSUIT) -> dict[str, Any]:
    """Return the colour of each material by name, the same for those of several parts."""
    colours = (first, *LAYERS)
    names = list(dict.fromkeys(names))
    order = list(dict.fromkeys(map(own_name, names)))
    return {name: colours[order.index(own_name(name)) % len(colours)] for name in names}


def literal(text: str) -> str:
    """Return a text, possibly from somebody's file, that matplotlib shows as it is."""
    return one_line(text).replace("$", r"\$")


def save(figure: Figure, file: str | FilePath) -> FilePath:
    """Save a figure as PNG, SVG or PDF, according to the file name's extension.

    Return its path; InputError if the extension is not supported, or it cannot be written.
    """
    target = writable(file)
    # Without a date, so that the file is reproducible.
    metadata: dict[str, str | None] = {"Date": None} if target.suffix == ".svg" else {}
    if target.suffix == ".pdf":
        metadata = {"CreationDate": None}
    try:
        with style(), replaced(target) as draft:
            figure.savefig(draft, metadata=metadata)
    except OSError as error:
        raise InputError(f'cannot write the figure "{target}": {reason(error)}.') from None
    return target


def writable(file: str | FilePath) -> FilePath:
    """Return the path of a figure, checked before it is drawn.

    InputError if the extension is not supported, or the file cannot be written.
    """
    target = FilePath(file)
    if target.suffix.lower() not in FORMATS:
        raise InputError(
            f'cannot write the figure "{target}": its name must end in {" or ".join(FORMATS)}.'
        )
    check_writable(target)
    return target
