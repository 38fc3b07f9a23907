"""`flexor import`: a model file from one in another format."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from flexor.cli.console import say
from flexor.errors import InputError


def import_model(
    file: Annotated[Path, typer.Argument(metavar="FILE", help="An MJCF (MuJoCo) or URDF file.")],
    out: Annotated[
        Path, typer.Option(metavar="FILE", help="The model file to write; it ends in .toml.")
    ],
    skip_meshes: Annotated[
        bool,
        typer.Option(
            "--skip-meshes", help="Leave out meshes that would touch; otherwise they are refused."
        ),
    ] = False,
    force: Annotated[bool, typer.Option("--force", help="Overwrite a file that exists.")] = False,
) -> None:
    """Write a model file of a limb: its joints, tendons, muscles, and the capsules that touch.

    What is not carried over is listed; an element that is not known is refused.

    Examples
    --------
    * `flexor import hand.xml --out hand.toml`
    * `flexor import gripper.urdf --out gripper.toml --skip-meshes`
    """
    import tomli_w

    from flexor.exchange import document_of, read_limb
    from flexor.model import Model, parse
    from flexor.store import check_writable, write_text

    if out.suffix != ".toml":
        raise InputError(f'--out is "{out}": a model file must end in .toml.')
    check_writable(out)
    if out.exists() and not force:
        raise InputError(f'--out is "{out}", which exists already: add --force to overwrite it.')
    limb = read_limb(file, skip_meshes=skip_meshes)
    made = document_of(limb)
    text = tomli_w.dumps(made.tables)
    model = Model(parse(text, source=str(out)))
    write_text(out, f"# Imported by flexor from {file.name}.\n\n{text}")
    counts = {
        "bodies": len(limb.bodies),
        "joints": len(model.joints),
        "tendons": len(model.tendons),
    }
    say(f"model:     {out}")
    say(f"contains:  {', '.join(f'{count} {what}' for what, count in counts.items())}")
    for what, count in sorted(limb.left_out.items()):
        say(f"left out:  {what}{f', {count} times' if count > 1 else ''}")
