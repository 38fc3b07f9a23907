"""An animation that shows itself in notebooks and needs no network."""

from __future__ import annotations

import re

from matplotlib.animation import FuncAnimation

# Matplotlib's page takes the icons of its buttons from a font in the network.
_FONT = re.compile(r"<link\s[^>]*font-awesome[^>]*>")
_ICON = re.compile(r'<i class="fa fa-([a-z -]+)"></i>')
_ICONS = {
    "minus": "−",
    "fast-backward": "|◀◀",
    "step-backward": "|◀",
    "play fa-flip-horizontal": "◀",
    "pause": "||",
    "play": "▶",
    "step-forward": "▶|",
    "fast-forward": "▶▶|",
    "plus": "+",
}


class PathAnimation(FuncAnimation):
    """An animation with buttons in a notebook or in a page."""

    def to_jshtml(
        self,
        fps: int | None = None,
        embed_frames: bool = True,
        default_mode: str | None = None,
    ) -> str:
        """Return it as HTML, as Matplotlib does, with icons that are texts."""
        text = super().to_jshtml(fps, embed_frames, default_mode)
        text = _FONT.sub("", text)
        return _ICON.sub(lambda found: _ICONS.get(found[1], found[0]), text)

    def _repr_html_(self) -> str:
        """Show it in a notebook, whatever Matplotlib is set to."""
        return self.to_jshtml()
