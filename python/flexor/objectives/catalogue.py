"""Finding an objective by its name."""

from __future__ import annotations

from flexor.errors import InputError, unknown
from flexor.model.structure import Structure
from flexor.objectives.base import Objective
from flexor.objectives.bending import Bending, BendingContact, BendingContactPrinted
from flexor.objectives.extremum import SENSES, extremum
from flexor.objectives.tip_force import TipForce

_OBJECTIVES: dict[str, Objective] = {
    found.name: found
    for found in (Bending(), TipForce(), BendingContact(), BendingContactPrinted())
}
_PAPER_SYMBOLS = {"f_b": "bending", "f_exo": "tip-force", "f_bc": "bending-contact"}


def names() -> tuple[str, ...]:
    """Names that `objective` knows, besides the paper's symbols f_b, f_exo and f_bc."""
    return tuple(_OBJECTIVES)


def objective(name: str | Objective, model: Structure | None = None) -> Objective:
    """Find an objective by its name or the paper's symbol for it; one that is ready is returned.

    For a model also ``"maximise NAME"`` and ``"minimise NAME"`` of its observables. InputError if
    it is not known (the nearest name is suggested) or neither name nor objective.
    """
    if isinstance(name, Objective):
        return name
    if not isinstance(name, str):
        raise InputError(
            f"objective is {name!r}: expected a name or an objective; flexor.objectives.custom "
            "makes one of a function."
        )
    sense, _, wanted = name.strip().partition(" ")
    if model is not None and sense in SENSES and wanted.strip():
        return extremum(sense, wanted, model)
    plain = name.strip().casefold()
    found = _OBJECTIVES.get(_PAPER_SYMBOLS.get(plain, plain.replace("_", "-")))
    if found is None:
        raise unknown("objective", name.strip(), (*_OBJECTIVES, *_PAPER_SYMBOLS))
    return found
