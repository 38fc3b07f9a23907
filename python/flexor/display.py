"""Objects that notebooks show as pictures and tables."""

from __future__ import annotations

import importlib


class Displayed:
    """Base of what a notebook shows as HTML; how is in `flexor.notebook`, loaded when asked for."""

    def _repr_html_(self) -> str:
        # By name, as those modules import the classes that derive from this one.
        return str(importlib.import_module("flexor.notebook").html(self))
