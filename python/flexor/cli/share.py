"""`flexor share`: a design as one file for a browser."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from flexor.cli import options
from flexor.cli.console import say
from flexor.cli.folders import study_folder
from flexor.cli.progress import working
from flexor.cli.values import load_changed
from flexor.errors import InputError

if TYPE_CHECKING:
    from flexor.model import Model
    from flexor.study import Study


def share(
    source: Annotated[
        str,
        typer.Argument(
            metavar="STUDY_OR_MODEL", help="Study folder, model file, or name of a preset."
        ),
    ],
    out: Annotated[Path, typer.Option(help="HTML file to write.")],
    force: Annotated[
        bool, typer.Option("--force", help="Replace the file if there is one.")
    ] = False,
    design: options.OneOf = None,
    variant: options.Variant = None,
    changes: options.Set = None,
) -> int:
    """Write a design as one HTML file that needs no network.

    It shows the model in three dimensions at every load, with the pressure of contact and the
    strain as colours, plots along the load, all observables, the verdict of the constraints and
    where the design comes from. Of a study, the optimum and its start; of one with several
    objectives, the best design for each of them and the start.

    Examples
    --------
    * `flexor share pneumatic-finger --out finger.html`
    * `flexor share studies/press --out press.html`
    * `flexor share studies/choices --design 2 --out second.html`
    """
    from flexor.store.files import check_writable, write_text
    from flexor.study import Study
    from flexor.viewer import share_page

    if out.suffix.lower() not in (".html", ".htm"):
        raise InputError(f'--out is "{out}": its name must end in .html.')
    check_writable(out)
    if (out.exists() or out.is_symlink()) and not force:
        raise InputError(f'"{out}" exists: give --force to replace it, or another name.')
    shown = _source(source, design, variant, changes)
    origin = str(shown.folder) if isinstance(shown, Study) else source
    if isinstance(shown, Study) and shown.best.has_verdict:
        with working("checking the best design") as progress:
            shown.best.evaluate_verdict(progress)
    with working("drawing the design"):
        text = share_page(shown, origin)
    write_text(out, text)
    say(f"page: {out} ({len(text.encode()) / 1e6:.2f} MB)")
    return 0


def _source(
    source: str, design: str | None, variant: str | None, changes: list[str] | None
) -> Model | Study:
    from flexor.study import Study

    folder = Path(source)
    if not folder.is_dir():
        if design is not None:
            raise InputError(f'--design is for a folder of studies, and "{source}" is none.')
        return load_changed(source, variant, changes)
    if variant is not None or changes:
        given = "--variant" if variant is not None else "--set"
        raise InputError(f'{given} is for models: "{source}" is a folder, whose design is settled.')
    return Study.open(study_folder(folder, design))
