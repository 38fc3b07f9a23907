"""Stress against strain: of materials, and of laws fitted to tensile tests."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure

from flexor.plot.style import distinct, literal, style

if TYPE_CHECKING:
    from flexor.materials import Material
    from flexor.materials.fit import Curve, Fit
    from flexor.materials.tensile import TensileTest

_SIZE = (4.8, 3.4)


def draw_materials(materials: Sequence[Material]) -> Figure:
    """Draw the nominal stress of materials over the strains at which they were measured.

    Parameters
    ----------
    materials
        To compare.

    Returns
    -------
    matplotlib.figure.Figure
        One panel.
    """
    with style():
        figure = Figure(figsize=_SIZE, layout="constrained")
        axes = figure.subplots()
        for material, line in zip(materials, distinct(len(materials)), strict=True):
            low, high = material.stretch_range or (1.0, 2.0)
            stretch = np.linspace(min(low, 1.0), high, 200)
            stress = material.nominal_stress(stretch) / 1e3
            axes.plot(100.0 * (stretch - 1.0), stress, **line, label=literal(material.name))
        axes.set(xlabel="strain / %", ylabel="nominal stress / kPa")
        if len(materials) > 1:
            axes.set_yscale("log")
        figure.legend(loc="outside right upper")
    return figure


def draw_fits(curve: Curve, tests: Sequence[TensileTest], fits: Sequence[Fit]) -> Figure:
    """Draw fitted laws over the tensile tests.

    Parameters
    ----------
    curve
        The mean of the tests.
    tests
        The specimens.
    fits
        The laws, the chosen one first.

    Returns
    -------
    matplotlib.figure.Figure
        One panel.
    """
    with style():
        figure = Figure(figsize=_SIZE, layout="constrained")
        axes = figure.subplots()
        for test in tests:
            inside = test.stretch <= curve.stretch[-1] * (1.0 + curve.slack)
            strain = 100.0 * (test.stretch[inside] / (1.0 + curve.slack) - 1.0)
            axes.plot(strain, test.stress[inside] / 1e3, "k.", markersize=2.0, zorder=3)
        for index, (fit, line) in enumerate(zip(fits, distinct(len(fits)), strict=True)):
            stress = fit.material.nominal_stress(curve.stretch) / 1e3
            strain = 100.0 * (curve.stretch - 1.0)
            width = 1.5 if index == 0 else 0.7
            axes.plot(strain, stress, **line, linewidth=width, label=fit.law)
        axes.set(xlabel="strain / %", ylabel="nominal stress / kPa")
        axes.legend()
    return figure
