"""`flexor new`: begin a model file with a copy of a preset."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Annotated

import typer

from flexor.cli.console import say
from flexor.errors import InputError

_NAME = re.compile(r'^name = "[^"\n]*"', re.MULTILINE)


def new(
    name: Annotated[
        str, typer.Argument(metavar="NAME", help="The new file; `.toml` is added if missing.")
    ],
    source: Annotated[
        str,
        typer.Option(
            "--from", metavar="PRESET", help="What to copy: a preset, or another model file."
        ),
    ] = "pneumatic-finger",
) -> None:
    """Begin a model file with a copy of a preset, to be changed in a text editor.

    Examples
    --------
    * `flexor new my-finger`
    * `flexor new arm.toml --from tendon-arm`
    """
    from flexor.model import load
    from flexor.model.reading import locate
    from flexor.store.files import reason

    target = Path(name if name.endswith(".toml") else f"{name}.toml")
    stem = target.stem
    if not re.fullmatch(r"[A-Za-z0-9][A-Za-z0-9_.-]*", stem):
        raise InputError(
            f'NAME is "{name}": a model\'s name has letters, digits, "-", "_" and ".".'
        )
    load(source)  # a file that cannot be used is not worth a copy
    text = locate(source).read_text(encoding="utf-8")
    try:
        with target.open("x", encoding="utf-8", newline="\n") as file:
            file.write(_NAME.sub(f'name = "{stem}"', text, count=1))
    except FileExistsError:
        raise InputError(f'"{target}" exists already: choose another name.') from None
    except OSError as error:
        raise InputError(f'cannot write "{target}": {reason(error)}.') from None
    say(f"model:  {target}")
    say(f"try:    flexor simulate {target} --plot {stem}.png")
