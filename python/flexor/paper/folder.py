"""The folder of a reproduction: what was computed is kept there, part by part.

reproduction.json   settings, provenance and the items asked for
parts/NAME.json     each finished part of the computation, with the time it took
studies/            studies and comparisons on their way, resumable in themselves
figures/, tables/   PNG and SVG, CSV
report.html         everything on one page
lock                held by the process that is at it
"""

from __future__ import annotations

import json
import os
import time
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from flexor.errors import InputError

FORMAT = 1
STAMP = "reproduction.json"

Data = dict[str, Any]


@dataclass(frozen=True)
class Part:
    """A finished part of the computation.

    Attributes
    ----------
    data : dict
        Plain JSON values.
    seconds : float
        How long it took [s].
    """

    data: Data
    seconds: float


class Folder:
    """A folder in which parts are computed once.

    Parameters
    ----------
    path : Path
        Where it is; made by `Folder.create` or found by `Folder.resume`.
    stamp : dict
        What its ``reproduction.json`` says.
    """

    def __init__(self, path: Path, stamp: Data) -> None:
        self.path = path
        self.stamp = stamp

    @classmethod
    def create(cls, path: Path, stamp: Mapping[str, Any]) -> Folder:
        """Make a folder for a new reproduction.

        Raises
        ------
        InputError
            If the place is taken or cannot be written.
        """
        if (path / STAMP).exists():
            raise InputError(
                f'"{path}" holds a reproduction already: go on with --resume or choose another '
                "folder with --out."
            )
        if path.exists() and (not path.is_dir() or any(path.iterdir())):
            raise InputError(f'"{path}" is not an empty folder: choose another with --out.')
        folder = cls(path, {"format": FORMAT, **stamp})
        try:
            path.mkdir(parents=True, exist_ok=True)
            folder._write(path / STAMP, folder.stamp)
        except OSError as error:
            raise InputError(f'the folder "{path}" cannot be made: {_why(error)}.') from error
        return folder

    @classmethod
    def resume(cls, path: Path) -> Folder:
        """Find the folder of a reproduction.

        Raises
        ------
        InputError
            If it is none, or one that this version cannot read.
        """
        file = path / STAMP
        if not file.is_file():
            what = f"it has no {STAMP}" if path.is_dir() else "there is no such folder"
            raise InputError(f'there is nothing to resume in "{path}": {what}.')
        stamp = _read(file)
        if stamp.get("format") != FORMAT:
            raise InputError(
                f'"{file}" has format {stamp.get("format")!r}; this version of Flexor reads '
                f"format {FORMAT}."
            )
        if not {"settings", "provenance", "items"} <= set(stamp):
            raise InputError(f'"{file}" is damaged.')
        return cls(path, stamp)

    def ask_for(self, items: Iterable[str]) -> tuple[str, ...]:
        """Remember items that are asked for, and return all that ever were."""
        asked = tuple(dict.fromkeys([*self.stamp["items"], *items]))
        if list(asked) != self.stamp["items"]:
            self.stamp["items"] = list(asked)
            self._write(self.path / STAMP, self.stamp)
        return asked

    def part(self, name: str, compute: Callable[[], Data]) -> Part:
        """Return a part: the one that is kept, or else computed and kept.

        Parameters
        ----------
        name : str
            Name of its file, without ending.
        compute : callable
            Returns plain JSON values; called if the part is not there.

        Raises
        ------
        InputError
            If its file is damaged or cannot be written.
        """
        file = self.path / "parts" / f"{name}.json"
        if not file.is_file():
            began, processor = time.perf_counter(), time.process_time()
            data = compute()
            spent = {
                "seconds": time.perf_counter() - began,
                "processor": time.process_time() - processor,
            }
            try:
                file.parent.mkdir(parents=True, exist_ok=True)
                self._write(file, {**spent, "data": data})
            except OSError as error:
                raise InputError(f'"{file}" cannot be written: {_why(error)}.') from error
        # Read back also what was just computed, so that a resumed report cannot differ.
        kept = _read(file)
        if not {"seconds", "data"} <= set(kept):
            raise InputError(f'"{file}" is damaged: delete it to compute it again.')
        return Part(kept["data"], float(kept["seconds"]))

    def processor(self) -> float:
        """Return the processor time of all parts, which other work on the machine leaves alone [s].

        What other processes computed for them is not in it.
        """
        files = sorted((self.path / "parts").glob("*.json"))
        return sum(float(_read(file).get("processor", 0.0)) for file in files)

    def study(self, name: str) -> tuple[Path, bool]:
        """Return the folder of a study, and whether there is one to resume."""
        place = self.path / "studies" / name
        return place, place.is_dir() and any(place.iterdir())

    def write(self, name: str, content: str | bytes) -> Path:
        """Write a file of the report, whole or not at all.

        Raises
        ------
        InputError
            If it cannot be written.
        """
        file = self.path / name
        try:
            file.parent.mkdir(parents=True, exist_ok=True)
            draft = file.with_name(f".{file.name}.new")
            draft.write_bytes(content.encode() if isinstance(content, str) else content)
            os.replace(draft, file)
        except OSError as error:
            raise InputError(f'"{file}" cannot be written: {_why(error)}.') from error
        return file

    @staticmethod
    def _write(file: Path, values: Mapping[str, Any]) -> None:
        draft = file.with_name(f".{file.name}.new")
        text = json.dumps(values, indent=1, ensure_ascii=False, allow_nan=False)
        draft.write_text(text + "\n", encoding="utf-8")
        os.replace(draft, file)


def _read(file: Path) -> Data:
    try:
        values = json.loads(file.read_text(encoding="utf-8"))
    except OSError as error:
        raise InputError(f'"{file}" cannot be read: {_why(error)}.') from error
    except (ValueError, RecursionError):
        raise InputError(f'"{file}" is damaged: delete it to compute it again.') from None
    if not isinstance(values, dict):
        raise InputError(f'"{file}" is damaged: delete it to compute it again.')
    return values


def _why(error: OSError) -> str:
    return (error.strerror or str(error)).lower()
