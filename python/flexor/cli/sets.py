"""`flexor sets`: list parameter sets and objectives."""

from __future__ import annotations

from typing import Annotated

import typer

from flexor.cli.console import out
from flexor.cli.table import number, show

MODEL_HELP = "Model file or preset whose bounds and start to show."


def sets(
    model: Annotated[str | None, typer.Argument(metavar="[MODEL]", help=MODEL_HELP)] = None,
) -> None:
    """List the parameter sets with their bounds, the objectives and the methods.

    Combine sets with `+`: `flexor optimize finger --parameters L+R01`.
    """
    from flexor import design, objectives, optimizers

    space: design.DesignSpace = design.DesignSpace()
    if model is not None:
        import flexor

        space = flexor.load(model).design
    rows = []
    for name in design.names():
        chosen = design.parameter_set(name, space)
        for i, label in enumerate(chosen.labels):
            low, start, high = (
                number(values[i] / chosen.scale[i])
                for values in (chosen.lower, chosen.start, chosen.upper)
            )
            unit = "" if chosen.units[i] == "1" else chosen.units[i]
            rows.append((name if i == 0 else "", label, unit, low, start, high))
    headings = ("set", "parameter", "unit", "lower", "start", "upper")
    show(headings, rows, left=3)
    available = [(name, objectives.objective(name)) for name in objectives.names()]
    cells = [(name, f"{objective.quantity} / {objective.unit}") for name, objective in available]
    show(("objective", "displayed as"), cells, left=2)
    out.print(f"methods: {', '.join(optimizers.names())}", markup=False)
