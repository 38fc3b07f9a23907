"""Finding an objective by its name."""

from __future__ import annotations

from collections.abc import Sequence

from flexor.errors import InputError, unknown
from flexor.model.structure import Structure
from flexor.objectives.base import Objective
from flexor.objectives.bending import Bending, BendingContact, BendingContactPrinted
from flexor.objectives.extremum import SENSES, extremum
from flexor.objectives.several import SEPARATOR, several
from flexor.objectives.tip_force import TipForce

_OBJECTIVES: dict[str, Objective] = {
    found.name: found
    for found in (Bending(), TipForce(), BendingContact(), BendingContactPrinted())
}
_SPELLINGS = {"maximize": "maximise", "minimize": "minimise"}
_PAPER_SYMBOLS = {"f_b": "bending", "f_exo": "tip-force", "f_bc": "bending-contact"}


def names() -> tuple[str, ...]:
    """Names that `objective` knows, besides the paper's symbols f_b, f_exo and f_bc."""
    return tuple(_OBJECTIVES)


def needs_model(name: str) -> bool:
    """Return whether an objective of a name is that of an observable, which a model has."""
    sense = name.strip().partition(" ")[0]
    return _SPELLINGS.get(sense, sense) in SENSES


def objective(
    name: str | Objective | Sequence[str | Objective], model: Structure | None = None
) -> Objective:
    """Find an objective by its name or the paper's symbol for it; one that is ready is returned.

    For a model also ``"maximise NAME"`` and ``"minimise NAME"`` of its observables. Several, in a
    sequence or a text with commas, make one `Several`. InputError if one is not known (the nearest
    name is suggested) or neither name nor objective.
    """
    if isinstance(name, Objective):
        return name
    if isinstance(name, str):
        parts = name.split(SEPARATOR.strip())
        return several([_one(part.strip(), model) for part in parts])
    if isinstance(name, Sequence):
        return several([objective(each, model) for each in name])
    raise InputError(
        f"objective is {name!r}: expected a name or an objective; flexor.objectives.custom "
        "makes one of a function."
    )


def _one(name: str, model: Structure | None) -> Objective:
    sense, _, wanted = name.partition(" ")
    sense = _SPELLINGS.get(sense, sense)
    if sense in SENSES and not wanted.strip():
        raise InputError(f'objective "{name}": say what, such as "{sense} range-of-motion".')
    if model is not None and sense in SENSES and wanted.strip():
        return extremum(sense, wanted.strip(), model)
    plain = name.casefold()
    found = _OBJECTIVES.get(_PAPER_SYMBOLS.get(plain, plain.replace("_", "-")))
    if found is None:
        raise unknown("objective", name, (*_OBJECTIVES, *_PAPER_SYMBOLS))
    return found
