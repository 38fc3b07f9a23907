"""One process at a time on a study."""

from __future__ import annotations

import os
import sys
from contextlib import suppress
from pathlib import Path

from flexor.errors import InputError


class Lock:
    """An exclusive lock on a study folder, held until released or until the process dies.

    It is the operating system's lock on the file ``lock``, so that a killed process leaves nothing
    behind that would have to be cleaned up.

    Parameters
    ----------
    folder : Path
        The study folder.

    Raises
    ------
    InputError
        If another process holds it, or the folder cannot be written.
    """

    def __init__(self, folder: Path) -> None:
        try:
            self._file: int | None = os.open(folder / "lock", os.O_RDWR | os.O_CREAT, 0o666)
        except OSError as error:
            raise InputError(
                f'the study "{folder}" cannot be locked: {(error.strerror or str(error)).lower()}.'
            ) from error
        try:
            _take(self._file)
        except OSError:
            os.lseek(self._file, 0, os.SEEK_SET)
            holder = os.read(self._file, 100).decode("ascii", "ignore").strip()
            os.close(self._file)
            raise InputError(
                f'the study "{folder}" is in use by another process'
                f"{f' ({holder})' if holder else ''}: wait for it or stop it."
            ) from None
        self._say(f"process {os.getpid()}")

    def release(self) -> None:
        """Let others have the study."""
        if self._file is not None:
            self._say("")
            os.close(self._file)
            self._file = None

    def _say(self, who: str) -> None:
        assert self._file is not None
        with suppress(OSError):  # a full disk has the lock all the same
            os.truncate(self._file, 0)
            os.lseek(self._file, 0, os.SEEK_SET)
            os.write(self._file, who.encode("ascii"))


if sys.platform == "win32":
    import msvcrt

    def _take(descriptor: int) -> None:
        # Far beyond the text, which others must be able to read.
        os.lseek(descriptor, 1 << 20, os.SEEK_SET)
        msvcrt.locking(descriptor, msvcrt.LK_NBLCK, 1)
else:
    import fcntl

    def _take(descriptor: int) -> None:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
