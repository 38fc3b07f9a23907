"""One process at a time on a study."""

from __future__ import annotations

import os
import sys
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
        path = folder / "lock"
        try:
            self._file = open(path, "a+", encoding="ascii")  # noqa: SIM115 - held while locked
        except OSError as error:
            raise InputError(
                f'the study "{folder}" cannot be locked: {(error.strerror or str(error)).lower()}.'
            ) from error
        try:
            _take(self._file.fileno())
        except OSError:
            self._file.seek(0)
            holder = self._file.read().strip()
            self._file.close()
            raise InputError(
                f'the study "{folder}" is in use by another process'
                f"{f' ({holder})' if holder else ''}: wait for it or stop it."
            ) from None
        self._file.truncate(0)
        self._file.write(f"process {os.getpid()}")
        self._file.flush()

    def release(self) -> None:
        """Let others have the study."""
        if not self._file.closed:
            self._file.truncate(0)
            self._file.close()


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
