"""Figure of the performance and data profiles of a comparison."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from flexor.optimizers import entries
from flexor.plot.legend import fitting_legend
from flexor.plot.style import PAGE, style

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from flexor.study.comparison import MethodComparison, Profile

# Okabe and Ito's colours that are dark enough for lines, combined with line styles so that
# neighbouring lines differ in both.
COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#000000")
STROKES: tuple[Any, ...] = ("-", (0, (4, 1.5)), (0, (1, 1)))
MAX_RATIO = 64.0  # upper limit of the abscissa


def profiles(comparison: MethodComparison, within: float = 0.01) -> Figure:
    """Plot the performance and data profiles of a comparison.

    Parameters
    ----------
    comparison : MethodComparison
        Result of `flexor.compare`.
    within : float
        Relative tolerance: a problem is solved at 1 - `within` of the best known gain.

    Returns
    -------
    matplotlib.figure.Figure
        Performance profile and data profile, one page wide.
    """
    from matplotlib.figure import Figure
    from matplotlib.ticker import FuncFormatter, PercentFormatter

    from flexor.study.comparison import data_profiles, performance_profiles

    performance = performance_profiles(comparison, within)
    data = data_profiles(comparison, within)
    sets, seeds = len(comparison.sets), len(comparison.seeds)
    problems = f"{sets} set{'s' * (sets > 1)} × {seeds} seed{'s' * (seeds > 1)}"
    with style():
        figure = Figure(figsize=(PAGE, 0.46 * PAGE), layout="constrained")
        left, right = figure.subplots(1, 2, sharey=True)
        widest = max((float(p.cost[-1]) for p in performance if p.cost.size), default=1.0)
        last = min(max(2.0, 2.0 ** np.ceil(np.log2(widest) + 0.01)), MAX_RATIO)
        _lines(left, performance, 1.0, last)
        left.set_xscale("log", base=2)
        left.xaxis.set_major_formatter(FuncFormatter(lambda ratio, _: f"{ratio:g}"))
        left.set_xlabel("evaluations / those of the fastest method")
        left.set_title("performance profile")
        longest = max((float(p.cost[-1]) for p in data if p.cost.size), default=1.0)
        _lines(right, data, 0.0, 1.05 * longest)
        right.set_xlabel("evaluations / (parameters + 1)")
        right.set_title("data profile")
        left.set_ylabel(f"solved to {100.0 * within:g} % of the gain\n({problems})")
        for axes in (left, right):
            axes.set_ylim(0.0, 1.03)
            axes.yaxis.set_major_formatter(PercentFormatter(1.0, 0))
            axes.grid(True)
        handles, _ = left.get_legend_handles_labels()
        fitting_legend(figure, handles, "outside lower center", 5, handlelength=2.2)
    return figure


def _lines(axes: Any, profiles: Sequence[Profile], first: float, last: float) -> None:
    for i, profile in enumerate(profiles):
        cost = np.concatenate(([first], profile.cost, [last]))
        solved = np.concatenate(([0.0], profile.solved, [profile.at(np.inf)]))
        entry = entries().get(profile.method)
        axes.step(
            np.maximum(cost, first),
            solved,
            where="post",
            color=COLOURS[i % len(COLOURS)],
            linestyle=STROKES[(i + i // len(COLOURS)) % len(STROKES)],
            label=entry.title if entry is not None else profile.method,
            clip_on=True,
        )
    axes.set_xlim(first, last)
