"""Places of straps on rods as design variables."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

from flexor.design.fields import keys_of
from flexor.errors import InputError
from flexor.model.schema.strap import Loop

if TYPE_CHECKING:
    from flexor.model import Model
    from flexor.model.schema import ModelFile

_END = ".at"


def is_place(keys: tuple[str, ...]) -> bool:
    """Return whether a field is the place of a strap on a rod."""
    return len(keys) == 3 and keys[0] == "straps" and keys[2] == "at"


def check_place(label: str, name: str, file: ModelFile, source: str) -> None:
    """Refuse the place of a strap that loops around a link."""
    if isinstance(file.straps[name].to, Loop):
        raise InputError(
            f'{source}: "{label}" cannot be varied: a loop is at an element boundary of its rod; '
            "give values to choose from, such as by --choose."
        )


def with_moving_straps(model: Model, labels: Iterable[str]) -> Model:
    """Return a model whose straps can be moved along rods where their places are among fields.

    The same model if they can.
    """
    from flexor.model.loading import changed_model

    fields = [keys_of(label, model.file) for label in labels if label.endswith(_END)]
    names = [keys[1] for keys in fields if is_place(keys)]
    fixed = {f"straps.{name}.moving": True for name in names if not model.file.straps[name].moving}
    return changed_model(model, fixed) if fixed else model
