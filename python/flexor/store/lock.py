"""Exclusive locks on folders."""

from __future__ import annotations

import os
import sys
from contextlib import suppress
from pathlib import Path

from flexor.errors import InputError
from flexor.store.files import NO_FOLLOW, check_regular, reason


class Lock:
    """An exclusive lock on a folder, held until released or until the process dies.

    It is the operating system's lock on the file ``lock``, so a killed process leaves nothing
    behind that would have to be cleaned up. InputError if another process holds it, or the folder
    (of work of this ``kind``, for messages) cannot be written.
    """

    def __init__(self, folder: Path, kind: str) -> None:
        path = folder / "lock"
        check_regular(path)
        try:
            self._file: int | None = os.open(path, os.O_RDWR | os.O_CREAT | NO_FOLLOW, 0o666)
        except OSError as error:
            raise InputError(f'the {kind} "{folder}" cannot be locked: {reason(error)}.') from error
        try:
            _lock(self._file)
        except OSError:
            os.lseek(self._file, 0, os.SEEK_SET)
            holder = os.read(self._file, 100).decode("ascii", "ignore").strip()
            os.close(self._file)
            raise InputError(
                f'the {kind} "{folder}" is in use by another process'
                f"{f' ({holder})' if holder else ''}: wait for it or stop it."
            ) from None
        self._write(f"process {os.getpid()}")

    def release(self) -> None:
        """Let others have the folder."""
        if self._file is not None:
            self._write("")
            os.close(self._file)
            self._file = None

    def _write(self, holder: str) -> None:
        assert self._file is not None
        with suppress(OSError):  # the lock is valid even if the disk is full
            os.truncate(self._file, 0)
            os.lseek(self._file, 0, os.SEEK_SET)
            os.write(self._file, holder.encode("ascii"))


if sys.platform == "win32":
    import msvcrt

    def _lock(descriptor: int) -> None:
        # Far beyond the text, which others must be able to read.
        os.lseek(descriptor, 1 << 20, os.SEEK_SET)
        msvcrt.locking(descriptor, msvcrt.LK_NBLCK, 1)
else:
    import fcntl

    def _lock(descriptor: int) -> None:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
