"""`flexor presets`: the model files that come with Flexor."""

from __future__ import annotations

from flexor.cli.table import show


def presets() -> None:
    """List the model files that come with Flexor; their names stand for them everywhere."""
    from flexor import model

    rows = []
    for name in model.presets():
        file = model.load(name).file
        sets = [
            f"{chosen} (default)" if chosen == file.use else chosen for chosen in file.constants
        ]
        rows.append((name, file.title, ", ".join(sets)))
    show(("model", "what it is", "constants"), rows, left=3)
