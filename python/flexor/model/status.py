"""Meaning and remedy of each status of a load step (`flexor._engine.STATUS`)."""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from flexor.model.results import Path
    from flexor.model.structure import Structure

# Gaps up to this count as closed: of the length of the longest body, or in radians.
_CLOSED = 1e-7
# Ties with at least this part of the largest share are named.
_SHARE = 0.1
# No equilibrium is resolved where the rounding of terms is more than this part of the forces.
_LOST = 0.01

# Status: meaning, remedy. The table in `docs/method.md` repeats them, which a test checks.
MEANINGS = MappingProxyType(
    {
        "converged": ("an equilibrium; its stability is reported separately", "none needed"),
        "unstable": (
            "an unstable equilibrium, near which no stable one was found; occurs only with loads "
            "without a potential",
            "inspect the preceding path, in smaller load steps",
        ),
        "iteration-limit": (
            "more than max_iterations iterations in this load step, usually because of many "
            "successive snaps",
            "raise max_iterations, reduce the load, or use a stiffer design",
        ),
        "stalled": (
            "the energy cannot be reduced further, but forces do not balance, or ties are open: "
            "scales too far apart for double precision, normal forces and friction that do not "
            "settle, or a jump of a structure with ties",
            "check units, and reduce differences of many orders of magnitude between stiffnesses; "
            "with friction, use other load steps or a smaller coefficient; with ties, follow the "
            "path by arc length",
        ),
        "diverged": (
            "the energy is not finite, or no acceptable step was found",
            "check units; reduce the load, or use more load steps",
        ),
        "invalid-design": (
            "a number is not finite, a length, radius or modulus is not positive, a stiffness or "
            "density is negative, or the walls of a section leave no room for its cavity",
            "correct the design, or narrow its bounds",
        ),
        "not-reached": ("an earlier load step failed", "see that step"),
        "unrestrained": (
            "a force acts along a motion without stiffness",
            "restrain it by a stiffness, a limit, a spring or a support",
        ),
        "time-limit": (
            "more than max_seconds in this load step",
            "raise max_seconds, or simplify the model",
        ),
        "cancelled": ("the solve was interrupted", "repeat it"),
        "not-closed": (
            "a tie could not be closed: it contradicts other ties or joints, or is out of reach",
            "correct its places, its axis or its rotation, or leave out what holds it open",
        ),
        "singular": (
            "conditions of ties depend on one another here but not nearby, as at the dead centre "
            "of a crank or a change point of a linkage: reactions have no bound, and the motion "
            "may go on in more than one way",
            "stop before it, drive another joint, or guide the linkage past it by another link",
        ),
        "closed-branch": (
            "the branch that is followed by arc length came back to where it began, and never "
            "reaches this load, as where a crank turns back at its dead centres",
            "list loads between the limit points of the branch",
        ),
    }
)


def explained(status: str) -> str:
    """Return meaning and remedy of a status as text."""
    meaning, advice = MEANINGS[status]
    return f"{status}: {meaning}. Remedy: {advice}."


def why_not_closed(path: Path) -> str:
    """Return which tie is open where a path could not be closed, and how far."""
    step = path.status.tolist().index("not-closed")
    found = _open_ties(path, step, at_least_one=True)
    return f"{' and '.join(found)}{_reached(path, step)}"


def _open_ties(path: Path, step: int, at_least_one: bool = False) -> list[str]:
    """Return the tie that is open furthest and the one that is turned furthest, with how far."""
    distances, angles = np.asarray(path.tie_gaps[step]).T
    found = []
    longest = max(float(body.length) for body in path.model.file.bodies.values())
    if distances.max() > _CLOSED * longest:
        name = path.model.ties[distances.argmax()]
        found.append(f"ties.{name} is open by {1e3 * distances.max():.3g} mm")
    if angles.max() > _CLOSED or (at_least_one and not found):
        name = path.model.ties[angles.argmax()]
        found.append(f"ties.{name} is turned by {np.degrees(angles.max()):.3g} deg")
    return found


def why_singular(path: Path) -> str:
    """Return which ties become dependent where a path meets a singular configuration, and where."""
    step = path.status.tolist().index("singular")
    shares = np.asarray(path.tie_singularity[step])
    most = np.argsort(-shares, kind="stable")
    names = [f"ties.{path.model.ties[i]}" for i in most if shares[i] >= _SHARE * shares.max()]
    verb = "becomes dependent on joints" if len(names) == 1 else "become dependent on one another"
    return f"{' and '.join(names)} {verb}{_reached(path, step)}"


def _reached(path: Path, step: int) -> str:
    """Return up to where a path was followed; nothing if it ends at its first load."""
    loads = np.asarray(path.applied[step])
    if step == 0 or not np.isfinite(loads).all():
        return ""
    return f"; the path ends at {path.model.show_loads(loads)}"


def why_stalled(path: Path) -> str:
    """Return what is out of balance or open where a path stalled, and the largest stiffness."""
    step = path.status.tolist().index("stalled")
    residual, tolerance = float(path.residual[step]), float(path.tolerance[step])
    model = path.model
    if residual <= tolerance and tolerance > _LOST:
        said = f"rounding is {tolerance:.2g} of the forces, of which it must be less than {_LOST:g}"
        return said + _stiffest(model)
    if residual <= tolerance:
        # By arc length the numbers are those of the last state found.
        if path.followed is None:
            return "forces balance in the last state found, and no equilibrium was found beyond it"
        opened = _open_ties(path, step) if model.ties else []
        if opened:
            return f"forces balance, but {' and '.join(opened)} in the last state"
        if model.frictions:
            return (
                "normal forces and friction did not settle: renewed normal forces change the state "
                "in every round, as where friction presses its own contact"
            )
        return "forces balance in the last state, which is not a stable equilibrium"
    said = f"the residual is {residual:.2g} of the forces, above its bound of {tolerance:.2g}"
    turning = [name for name, wrench in model.file.wrenches.items() if wrench.frame == "body"]
    if turning:
        names = " and ".join(f"wrenches.{name}" for name in turning)
        verb = "turns with its body" if len(turning) == 1 else "turn with their bodies"
        return f"{said}; {names} {verb}, so that there may be no equilibrium: begin with less"
    return said + _stiffest(model)


def _stiffest(model: Structure) -> str:
    """Return which contact, spring or obstacle is the stiffest; nothing without any."""
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
        return ""
    largest, name = max(stiff)
    return f"; the largest stiffness is that of {name}, {largest:.3g} N/m"
