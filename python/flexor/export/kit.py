"""A folder with everything to cast a body."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from flexor.errors import InputError
from flexor.export.files import write, write_solid
from flexor.export.instructions import page
from flexor.export.mould import Mould
from flexor.export.sheets import sheets, write_dxf
from flexor.store.files import reason

if TYPE_CHECKING:
    from flexor.model import Path as Equilibria

PAGE = "instructions.html"


def write_kit(mould: Mould, folder: Path, path: Equilibria | None) -> list[Path]:
    """Write the parts of a mould, the body, sheets to cut and instructions into a folder.

    Parameters
    ----------
    mould
        The mould.
    folder
        Made if it is not there.
    path
        Equilibria of the design under the loads it is evaluated at, for the limit of the pressure.

    Returns
    -------
    list of Path
        The files.
    """
    try:
        folder.mkdir(exist_ok=True)
    except OSError as error:
        raise InputError(f'"{folder}" cannot be made: {reason(error)}.') from None
    files = []
    for name, solid in mould.printed().items():
        file = folder / f"{name}.stl"
        write_solid(solid, file)
        files.append(file)
    body = folder / "body.stl"
    write_solid(mould.body.solid, body)
    files.append(body)
    pieces = sheets(mould.body)
    if pieces:
        cut = folder / "sheets.dxf"
        write(cut, lambda draft: write_dxf(pieces, draft))
        files.append(cut)
    text = page(mould, path)
    write(folder / PAGE, lambda draft: draft.write_text(text, encoding="utf-8"))
    return [*files, folder / PAGE]
