"""How paths were followed, to follow them once more."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from flexor.arrays import Array


@dataclass(frozen=True, eq=False)
class Followed:
    """What the engine was given beside the designs and the listed loads."""

    settings: Mapping[str, Any]  # start, slips and options
    steps: int  # number of listed loads
    before: (
        Array | None
    )  # load of the start, (inputs,), if a path begins there and not at the first

    def loads(self, listed: Array) -> Array:
        """Return the loads from that of the start on, of listed ones (..., s, inputs)."""
        if self.before is None:
            return listed
        first = np.broadcast_to(self.before, (*listed.shape[:-2], 1, listed.shape[-1]))
        return np.concatenate([first, listed], axis=-2)
