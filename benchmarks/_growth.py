"""Cost of one benchmark as a function of its size."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Growth:
    """Cost over size.

    Attributes
    ----------
    sizes : list of int
        Problem sizes.
    costs : list of float
        Median cost at each size.
    extra : list of float
        A further column at each size, such as iterations per design.
    name : str
        Name of the model.
    """

    sizes: list[int]
    costs: list[float]
    extra: list[float]
    name: str = ""
