"""A model in three dimensions at every load step: meshes and fields, for any renderer.

Data flows from a path to a scene; `flexor.viewer` shows it in a browser.
"""

from __future__ import annotations

from flexor.scene.objects import Attached, Free, Object
from flexor.scene.reading import Scene, scene
from flexor.scene.scale import Scale

__all__ = ["Attached", "Free", "Object", "Scale", "Scene", "scene"]
