"""Models of limbs in the formats of others: MJCF and URDF are read, MJCF is written."""

from __future__ import annotations

from flexor.exchange.document import document_of
from flexor.exchange.limb import Limb
from flexor.exchange.reading import read_limb
from flexor.exchange.written import mjcf_of

__all__ = ["Limb", "document_of", "mjcf_of", "read_limb"]
