"""Files of an export: written at once, and none overwritten unasked."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from flexor.errors import InputError
from flexor.export.extra import STEP, required
from flexor.export.solids import Solid, triangles
from flexor.export.step import ENDINGS, write_step
from flexor.store.files import check_regular, check_writable, replaced

FORMATS = (".stl", ".3mf", *ENDINGS)
_SHORTEST = 1e-3  # edges [mm]: shorter ones may vanish where a file has single precision


def require_packages() -> None:
    """Check that the packages of the extra are installed; see `required`."""
    for name in ("manifold3d", "trimesh", "ezdxf"):
        required(name)


def check_target(path: Path, force: bool, formats: tuple[str, ...] = FORMATS) -> None:
    """Check, before the work that fills it, that a file may be written.

    Parameters
    ----------
    path
        The file.
    force
        Whether one that exists may be replaced.
    formats
        Endings that are allowed.

    Raises
    ------
    InputError
        If it may not.
    """
    if path.suffix.lower() not in formats:
        raise InputError(
            f'"{path}" cannot be written: its name must end in {" or ".join(formats)}.'
        )
    if path.suffix.lower() in ENDINGS:
        required("OCP", STEP)
    check_writable(path)
    if check_regular(path) and not force:
        raise InputError(f'"{path}" exists: --force overwrites it.')


def check_folder(path: Path, force: bool) -> None:
    """Check that a folder may be filled: it is empty or new, or `force` is given."""
    if path.exists() and not path.is_dir():
        raise InputError(f'"{path}" cannot be filled: it is a file, not a folder.')
    if not path.parent.is_dir():
        raise InputError(f'"{path}" cannot be made: no folder "{path.parent}".')
    if path.is_dir() and any(path.iterdir()) and not force:
        raise InputError(f'"{path}" is not empty: --force writes into it all the same.')


def write_solid(solid: Solid, path: Path) -> None:
    """Write a solid in mm as STL, 3MF or STEP, by the ending of its name."""
    points, faces = triangles(solid.simplify(_SHORTEST))
    if path.suffix.lower() in ENDINGS:
        write(path, lambda draft: write_step(points, faces, draft))
        return
    trimesh = required("trimesh")
    if path.suffix.lower() == ".3mf":
        required("lxml")
        required("networkx")
    mesh = trimesh.Trimesh(points, faces, process=False)
    mesh.units = "mm"
    write(path, lambda draft: mesh.export(draft))


def write(path: Path, save: Callable[[Path], object]) -> None:
    """Write a file by a function, all of it or nothing.

    Raises
    ------
    InputError
        If the system refuses.
    """
    try:
        with replaced(path) as draft:
            save(draft)
    except OSError as error:
        why = (error.strerror or str(error)).lower()
        raise InputError(f'"{path}" cannot be written: {why}.') from None


def write_text(path: Path, text: str) -> None:
    """Write a text file in UTF-8; see `write`."""
    write(path, lambda draft: draft.write_text(text, encoding="utf-8", newline=""))
