"""Files in untrusted folders: links and pipes are not followed."""

from __future__ import annotations

import csv
import errno
import io
import os
import re
import secrets
import stat
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path

from flexor.errors import InputError, one_line

# Not on Windows, where `check_regular` alone has to do.
NO_FOLLOW = getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_NONBLOCK", 0)


_DRAFT = re.compile(r"\..+-[0-9a-f]{8}\.[a-z]+")  # names that `replaced` gives


def check_regular(path: Path) -> bool:
    """Return whether a file exists; refuse a link, a pipe, a device or a folder."""
    try:
        mode = path.lstat().st_mode
    except (FileNotFoundError, NotADirectoryError):
        return False
    except OSError as error:
        raise InputError(f'"{path}" cannot be read: {reason(error)}.') from error
    if stat.S_ISREG(mode):
        return True
    kind = (
        "a link" if stat.S_ISLNK(mode) else "a folder" if stat.S_ISDIR(mode) else "a special file"
    )
    raise InputError(f'"{path}" is not a regular file: it is {kind}.')


def check_writable(path: Path) -> None:
    """Check, before the work that fills it, that a file can be written."""
    why = ""
    if path.is_dir() and not path.is_symlink():
        why = "it is a folder"
    elif not path.parent.is_dir():
        why = f'no folder "{path.parent}"'
    elif not os.access(path.parent, os.W_OK | os.X_OK):
        why = f'the folder "{path.parent}" cannot be written'
    if why:
        raise InputError(f'"{path}" cannot be written: {why}.')


@contextmanager
def replaced(path: Path) -> Iterator[Path]:
    """Write a file atomically, replacing any of its name.

    Yields an empty file beside it with the same suffix, which takes its place at the end. A link
    of that name is replaced, not followed. OSError if it cannot be written.
    """
    if path.is_dir() and not path.is_symlink():
        raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), str(path))
    draft = path.with_name(f".{path.stem}-{secrets.token_hex(4)}{path.suffix}")
    # By open, not tempfile: the umask decides who may read it.
    os.close(os.open(draft, os.O_WRONLY | os.O_CREAT | os.O_EXCL | NO_FOLLOW, 0o666))
    try:
        yield draft
        draft.replace(path)
    finally:
        draft.unlink(missing_ok=True)


def remove_drafts(folder: Path) -> None:
    """Remove what `replaced` left in a folder when its process was killed."""
    for path in folder.iterdir():
        if _DRAFT.fullmatch(path.name) and (path.is_symlink() or path.is_file()):
            path.unlink()


def write_text(path: Path, text: str) -> None:
    """Write a text file in UTF-8; see `replaced`."""
    with replaced(path) as draft:
        draft.write_text(text, encoding="utf-8", newline="")


def csv_text(rows: Iterable[Iterable[object]]) -> str:
    """Return rows as CSV that no spreadsheet takes for formulas.

    Control characters in texts become spaces; a text that then begins with ``=``, ``+``, ``-`` or
    ``@`` and is not a number gets an apostrophe in front.
    """
    out = io.StringIO()
    csv.writer(out, lineterminator="\n").writerows([_cell(each) for each in row] for row in rows)
    return out.getvalue()


def _cell(value: object) -> object:
    if not isinstance(value, str):
        return value
    text = one_line(value)
    if not text.lstrip().startswith(("=", "+", "-", "@")):
        return text
    try:
        float(text)
    except ValueError:
        return f"'{text}"
    return text


def reason(error: OSError) -> str:
    """Return why the operating system refused."""
    return (error.strerror or str(error)).lower()
