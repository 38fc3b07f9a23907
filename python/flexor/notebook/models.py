"""Models as HTML."""

from __future__ import annotations

import numpy as np

from flexor import plot
from flexor.model import Model
from flexor.model.schema import Rod
from flexor.notebook.card import card, html, picture, table


@html.register
def _(model: Model) -> str:
    file = model.file
    facts = [f"{model.dof} degrees of freedom"]
    if model.inputs:
        facts.append(f"loads: {', '.join(model.inputs)}")
    rows = [(name, *_body(name, model)) for name in file.bodies]
    at_rest = model.equilibrium(np.zeros((1, len(model.inputs))))
    drawn = picture(plot.path(at_rest), f"The model {file.name} without load")
    subtitle = "; ".join([file.title, *facts] if file.title else facts)
    return card(file.name, subtitle, drawn, table(("body", "kind", "carried by", "joint"), rows, 4))


def _body(name: str, model: Model) -> tuple[str, str, str]:
    body = model.file.bodies[name]
    kind = "rod" if isinstance(body, Rod) else "link"
    joint = "fixed" if body.joint is None else str(getattr(body.joint, "kind", "fixed"))
    return kind, body.parent or "world", joint
