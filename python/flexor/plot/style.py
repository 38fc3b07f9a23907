"""The look of every figure: plain, colour-blind safe, readable at the width of a column."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path as FilePath
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from flexor.errors import InputError

if TYPE_CHECKING:
    from matplotlib.figure import Figure

COLUMN = 3.5  # in, one column of a two-column page
PAGE = 7.2  # in, both columns
FORMATS = (".png", ".svg", ".pdf")

# Okabe and Ito's colours, told apart with every common kind of colour vision.
EXOSUIT = "#E69F00"
FINGER = "#E3E8EC"
LINE = "#30363B"
FORCE = "#0072B2"
CHAMBER = "#D55E00"

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
    """Draw in Flexor's style inside the block, and leave matplotlib's settings as they were."""
    import matplotlib

    with matplotlib.rc_context(_RC):
        yield


def shades(count: int) -> NDArray[np.float64]:
    """Return colours for an ordered series, light to dark.

    Parameters
    ----------
    count : int
        How many.

    Returns
    -------
    ndarray, shape (count, 4)
        RGBA, evenly spaced in lightness (viridis without its palest end).
    """
    import matplotlib

    positions = np.linspace(0.92, 0.0, count) if count > 1 else np.array([0.35])
    return np.asarray(matplotlib.colormaps["viridis"](positions), dtype=np.float64)


def save(figure: Figure, file: str | FilePath) -> FilePath:
    """Write a figure; the name's ending chooses PNG, SVG or PDF.

    Parameters
    ----------
    figure : matplotlib.figure.Figure
        What to write.
    file : str or pathlib.Path
        Where to.

    Returns
    -------
    pathlib.Path
        The file written.

    Raises
    ------
    InputError
        If the ending is none of these, or the file cannot be written.
    """
    target = writable(file)
    # No date inside: the same picture is the same file.
    metadata: dict[str, str | None] = {"Date": None} if target.suffix == ".svg" else {}
    if target.suffix == ".pdf":
        metadata = {"CreationDate": None}
    try:
        with style():
            figure.savefig(target, metadata=metadata)
    except OSError as error:
        why = (error.strerror or str(error)).lower()
        raise InputError(f'cannot write the figure "{target}": {why}.') from None
    return target


def writable(file: str | FilePath) -> FilePath:
    """Return the path of a figure to be written, after checking ending and folder.

    Parameters
    ----------
    file : str or pathlib.Path
        Where the figure is to go.

    Returns
    -------
    pathlib.Path
        The same.

    Raises
    ------
    InputError
        If the ending is not a figure's, or the folder is missing.
    """
    target = FilePath(file)
    if target.suffix.lower() not in FORMATS:
        raise InputError(
            f'cannot write the figure "{target}": its name must end in {", ".join(FORMATS)}.'
        )
    if not target.parent.is_dir():
        raise InputError(
            f'cannot write the figure "{target}": there is no folder "{target.parent}".'
        )
    return target
