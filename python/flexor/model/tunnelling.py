"""Contact spheres so far apart that another body may pass between them."""

from __future__ import annotations

import math
import warnings
from collections.abc import Iterator

import numpy as np

from flexor.arrays import Array
from flexor.errors import ModelWarning
from flexor.model.schema import ModelFile, Rod
from flexor.model.structure import Structure


def warn_about_gaps(model: Structure) -> None:
    """Warn, in one sentence for each contact, where it may be missed.

    That is, if in the reference state the gap between neighbouring spheres of a rod exceeds their
    diameter, or a sphere of the other group fits between those of a link.
    """
    if model.file.contacts:
        for sentence in _gaps(model):
            warnings.warn(sentence, ModelWarning, stacklevel=4)


def _gaps(model: Structure) -> Iterator[str]:
    spheres = model.engine.spheres(model.parameters, np.zeros(model.engine.dof))
    groups = {
        name: spheres[start:stop] for name, (start, stop) in model.engine.sphere_groups.items()
    }
    for name, contact in model.file.contacts.items():
        # Round cones, the second group of their contacts, have no gaps.
        sides = [(contact.first, contact.second)]
        if contact.shape == "spheres" and contact.first != contact.second:
            sides.append((contact.second, contact.first))
        found = [
            sentence
            for group, other in sides
            for sentence in _gaps_of(model.file, group, groups[group], groups[other][:, 3].min())
        ]
        if found:
            yield f'contact "{name}" may be missed: {"; ".join(found)}.'


def _gaps_of(file: ModelFile, group: str, spheres: Array, other: float) -> Iterator[str]:
    """Describe the widest gap of each body of a group that has one."""
    begin = 0
    for name in file.spheres[group].bodies:
        body = file.bodies[name]
        count = body.sample_count + 1 if isinstance(body, Rod) else 2
        own = spheres[begin : begin + count]
        begin += count
        apart = np.linalg.norm(np.diff(own[:, :3], axis=0), axis=1)
        width = own[1:, 3] + own[:-1, 3]
        widest = int(np.argmax(apart / width))
        ratio = float(apart[widest] / width[widest])
        gap = (
            f'spheres of the {body.kind} "{name}" have a spacing of {1e3 * apart[widest]:.3g} mm '
            f"and a diameter of {1e3 * width[widest]:.3g} mm"
        )
        if isinstance(body, Rod) and ratio > 1.0 + 1e-9:
            needed = math.ceil(body.elements * ratio - 1e-9)
            yield f"{gap}: {needed} elements close the gaps (it has {body.elements})"
        elif apart[widest] > width[widest] + 2.0 * other:
            yield (
                f"{gap}, so that one of the other group fits between them: "
                'give the link more points, or use shape = "round-cones"'
            )
