"""The published study: its numbers, and everything it takes to do it again."""

from __future__ import annotations

from flexor.paper.context import Doing
from flexor.paper.items import ITEMS
from flexor.paper.run import ItemDone, Reproduction, kept_settings, reproduce
from flexor.paper.section import Column, Compared, Picture, Section, Table
from flexor.paper.settings import Settings

__all__ = [
    "ITEMS",
    "Column",
    "Compared",
    "Doing",
    "ItemDone",
    "Picture",
    "Reproduction",
    "Section",
    "Settings",
    "Table",
    "kept_settings",
    "reproduce",
]
