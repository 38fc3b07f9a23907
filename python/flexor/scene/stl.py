"""Meshes as STL, the format of printers and of other viewers."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from flexor.scene.objects import Object

_FACET = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])


def stl(objects: Iterable[Object], step: int = -1) -> bytes:
    """Return meshes as one binary STL file, in millimetres.

    Parameters
    ----------
    objects
        Closed meshes; those that touch stay separate shells.
    step
        The load step.
    """
    corners = [1e3 * each.vertices(step)[each.faces] for each in objects]
    every = np.concatenate(corners) if corners else np.zeros((0, 3, 3))
    normal = np.cross(every[:, 1] - every[:, 0], every[:, 2] - every[:, 0])
    length = np.linalg.norm(normal, axis=1)
    kept = length > 0.0
    facets = np.zeros(int(kept.sum()), dtype=_FACET)
    facets["corners"] = every[kept]
    facets["normal"] = normal[kept] / length[kept, None]
    header = b"Flexor, in millimetres".ljust(80)
    return header + len(facets).to_bytes(4, "little") + facets.tobytes()
