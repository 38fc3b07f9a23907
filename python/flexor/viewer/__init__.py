"""Pages for a browser: a design in three dimensions with plots, table, verdict and provenance.

A page is one file without references to the network. `flexor share` writes one, `flexor studio`
serves one that solves again while sliders move; both show the same data, made by `payload`.
"""

from __future__ import annotations

from flexor.viewer.blobs import Blobs
from flexor.viewer.page import page
from flexor.viewer.payload import Shown, design_payload
from flexor.viewer.share import share_page, shared_designs

__all__ = ["Blobs", "Shown", "design_payload", "page", "share_page", "shared_designs"]
