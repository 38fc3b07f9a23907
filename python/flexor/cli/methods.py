"""`flexor methods`: list the search methods."""

from __future__ import annotations

from flexor.cli.table import show


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
