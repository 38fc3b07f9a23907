"""What it means that a load step ended as it did, and what one can do.

The engine has the statuses (`flexor._engine.STATUS`); this says them to people.
"""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from flexor.model.results import Path

# Status: what it means; what to do.
MEANINGS = MappingProxyType(
    {
        "converged": (
            "an equilibrium; its stability is given separately",
            "no action needed",
        ),
        "unstable": (
            "an equilibrium from which some motion grows by itself, without a stable one to be "
            "found near it; only loads without a potential end there",
            "look at the path before it, in smaller load steps",
        ),
        "iteration-limit": (
            "more iterations in this load step than max_iterations allows, mostly many snaps in a "
            "row",
            "raise max_iterations if each snap matters; otherwise less load, or a stiffer design",
        ),
        "stalled": (
            "the energy cannot be lowered any more, yet forces do not balance: scales too far "
            "apart for double precision",
            "check units, and bring stiffnesses that differ by many orders of magnitude together",
        ),
        "diverged": (
            "the energy is not finite, or no step could be found",
            "check units; apply far less load, or reach it in more steps",
        ),
        "invalid-design": (
            "a number is not finite, a length, radius or modulus not positive, or a stiffness or "
            "density negative",
            "correct the design, or narrow its bounds",
        ),
        "not-reached": ("an earlier load step failed", "see that step"),
        "unrestrained": (
            "a force acts on a motion that nothing holds",
            "hold it: with a stiffness, a limit, a spring or a support",
        ),
        "time-limit": (
            "more time for this load step than max_seconds allows",
            "raise max_seconds, or take a smaller model or fewer snaps",
        ),
        "cancelled": ("the solve was asked to stop", "start it again"),
    }
)


def explained(status: str) -> str:
    """Say what a status, one of `flexor._engine.STATUS`, means and what one can do."""
    meaning, advice = MEANINGS[status]
    return f"{status}: {meaning}. What to do: {advice}."


def why_stalled(path: Path) -> str:
    """Say how far forces are from balance where a path stalled, and what stiffness is behind it."""
    step = path.status.tolist().index("stalled")
    residual, tolerance = float(path.residual[step]), float(path.tolerance[step])
    said = f"residual {residual:.2g} of the forces, where rounding allows for {tolerance:.2g}"
    model = path.model
    file, slots = model.file, model.engine.slots
    names = [("contacts", name) for name in file.contacts]
    names += [("springs", name) for name in file.springs]
    names += [("obstacles", name) for name in file.obstacles]
    stiff = [
        (float(model.parameters[slots[f"{name}.stiffness"][0]]), f"{table}.{name}")
        for table, name in names
        if f"{name}.stiffness" in slots
    ]
    if not stiff:
        return said
    largest, name = max(stiff)
    return f"{said}; the largest stiffness is that of {name}, {largest:.3g} N/m"
