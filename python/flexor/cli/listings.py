"""`flexor presets`, `sets` and `methods`: lists of names that other commands take."""

from __future__ import annotations

from typing import Annotated

import typer

from flexor.cli.console import out
from flexor.cli.table import number, show
from flexor.errors import InputError, unknown_name


def presets(
    name: Annotated[
        str | None, typer.Argument(metavar="NAME", help="A preset to show; omit to list all.")
    ] = None,
) -> None:
    """List the model files shipped with Flexor, which can be referred to by name, or show one.

    `flexor new FILE --from NAME` copies one.
    """
    from flexor import model
    from flexor.model.reading import locate

    if name is not None:
        if name not in model.presets():
            raise InputError(f"{unknown_name('preset', name, model.presets())}.")
        print(locate(name).read_text(encoding="utf-8"), end="")
        return
    rows = []
    for name in model.presets():
        file = model.load(name).file
        sets = [
            f"{chosen} (default)" if chosen == file.use else chosen
            for chosen in (*file.constants, *file.variants)
        ]
        rows.append((name, file.title, ", ".join(sets)))
    show(("model", "description", "variants"), rows, left=3)


def sets(
    model: Annotated[
        str | None,
        typer.Argument(
            metavar="MODEL", help="Model file or preset whose bounds and start to show."
        ),
    ] = None,
) -> None:
    """List the parameter sets with their bounds, the objectives, the observables and the methods.

    Combine sets with `+`: `flexor optimize finger --parameters L+R01`.
    """
    from flexor import design, objectives, observables, optimizers

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
    show(("set", "parameter", "unit", "lower", "start", "upper"), rows, left=3)
    available = [(name, objectives.objective(name)) for name in objectives.names()]
    cells = [(name, f"{objective.quantity} / {objective.unit}") for name, objective in available]
    show(("objective", "displayed as"), cells, left=2)
    show(("observable", "what it is"), list(observables.kinds().items()), left=2)
    out.print(f"methods: {', '.join(optimizers.names())}")


def methods() -> None:
    """List the search methods with their aliases, options and defaults.

    Select a method with `flexor optimize finger --method NAME` and set its options with
    `--option KEY=VALUE`.
    """
    from flexor import optimizers
    from flexor.installing import install_command
    from flexor.optimizers.extras import missing_package

    rows = []
    for name, entry in optimizers.entries().items():
        package = missing_package(name)
        options = ", ".join(
            f"{key}={int(value) if isinstance(value, bool) else f'{value:g}'}"
            for key, value in entry.options.items()
            if not isinstance(value, tuple)
        )
        rows.append((name, f"{entry.description[0].upper()}{entry.description[1:]}."))
        if package:
            rows.append(("", f"Not installed: {install_command(package)}"))
        rows.append((", ".join(entry.aliases), options))
    show(("method", "description and options"), rows, left=2)
