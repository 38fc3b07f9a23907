"""`flexor presets`: list the model files shipped with Flexor."""

from __future__ import annotations

from flexor.cli.table import show


def presets() -> None:
    """List the model files shipped with Flexor, which can be referred to by name."""
    from flexor import model

    rows = []
    for name in model.presets():
        file = model.load(name).file
        sets = [
            f"{chosen} (default)" if chosen == file.use else chosen for chosen in file.constants
        ]
        rows.append((name, file.title, ", ".join(sets)))
    show(("model", "description", "constants"), rows, left=3)
