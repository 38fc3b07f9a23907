"""Folders of work: settings, lock, record and resuming, the same for every kind of work."""

from __future__ import annotations

from flexor.store.database import Database
from flexor.store.environment import environment, installed
from flexor.store.files import check_regular, check_writable, csv_text, replaced, write_text
from flexor.store.lock import Lock
from flexor.store.settings import SETTINGS, Header, Kind, read_settings
from flexor.store.workspace import RECORD, Workspace, open_record

__all__ = [
    "RECORD",
    "SETTINGS",
    "Database",
    "Header",
    "Kind",
    "Lock",
    "Workspace",
    "check_regular",
    "check_writable",
    "csv_text",
    "environment",
    "installed",
    "open_record",
    "read_settings",
    "replaced",
    "write_text",
]
