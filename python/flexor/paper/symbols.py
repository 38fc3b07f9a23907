"""The paper's symbols in HTML."""

from __future__ import annotations

import re
from html import escape

_SUBSCRIPT = re.compile(r"\b(f|R|n|q|a|L|P|phi)_(exo|bc|b|c|A|B|\d+)\b")


def marked(text: str) -> str:
    """Return text as HTML, with subscripts where the paper's symbols have them.

    Parameters
    ----------
    text : str
        Such as ``"f_b at R_0 < 1 cm"``.
    """
    return _SUBSCRIPT.sub(
        lambda found: f"<i>{'φ' if found[1] == 'phi' else found[1]}</i><sub>{found[2]}</sub>",
        escape(text, quote=False),
    )
