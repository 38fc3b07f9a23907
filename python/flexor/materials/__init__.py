"""Materials: constitutive laws, their constants, and their fit to tensile tests."""

from __future__ import annotations

from flexor.materials.library import find, library
from flexor.materials.material import KINDS, Material

__all__ = ["KINDS", "Material", "find", "library"]
