"""`flexor methods`: the searches there are."""

from __future__ import annotations

from flexor.cli.table import show


def methods() -> None:
    """List the search methods with their other names and options.

    A method is chosen with `flexor optimize finger --method NAME`, an option of it with
    `--option KEY=VALUE`.
    """
    from flexor import optimizers
    from flexor.installing import install_command
    from flexor.optimizers.extras import missing

    rows = []
    for name, entry in optimizers.entries().items():
        package = missing(name)
        options = ", ".join(
            f"{key}={int(value) if isinstance(value, bool) else f'{value:g}'}"
            for key, value in entry.options.items()
            if not isinstance(value, tuple)
        )
        rows.append((name, f"{entry.about[0].upper()}{entry.about[1:]}."))
        if package:
            rows.append(("", f"Not installed: {install_command(package)}"))
        rows.append((", ".join(entry.aliases), options))
    show(("method", "what it is, and its options"), rows, left=2)
