"""A page in one file: scripts and style inside, data as JSON that cannot end its element."""

from __future__ import annotations

import base64
import hashlib
import html
import json
from collections.abc import Mapping, Sequence
from importlib.resources import files
from typing import Any

LIBRARY = "three.min.js"
_SCRIPTS = (LIBRARY, "decode.js", "scales.js", "view.js", "charts.js", "report.js")


def page(
    title: str,
    scripts: Sequence[str],
    data: Mapping[str, Any],
    *,
    connects: bool = False,
) -> str:
    """Return an HTML page.

    Parameters
    ----------
    title
        Its title, shown as text.
    scripts
        Names of further scripts among the assets; the last one draws the page.
    data
        What it shows, JSON values.
    connects
        Whether it talks to the server that it came from.

    Notes
    -----
    The content security policy allows these scripts by their hashes and nothing else, so that no
    text of a model file can run. `<`, `>` and `&` in data are escaped.
    """
    sources = [_script(name) for name in (*_SCRIPTS, *scripts)]
    style = _asset("style.css")
    policy = "; ".join(
        [
            "default-src 'none'",
            f"script-src {' '.join(map(_hash, sources))}",
            f"style-src {_hash(style)}",
            "img-src data: blob:",
            f"connect-src {chr(39)}{'self' if connects else 'none'}{chr(39)}",
            "base-uri 'none'",
            "form-action 'none'",
        ]
    )
    licence = _asset("LICENSE-three").replace("--", "- -")
    return "".join(
        [
            '<!doctype html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n',
            f'<meta http-equiv="Content-Security-Policy" content="{policy}">\n',
            '<meta name="viewport" content="width=device-width, initial-scale=1">\n',
            '<meta name="color-scheme" content="light dark">\n',
            '<link rel="icon" href="data:,">\n',
            f"<title>{html.escape(title)}</title>\n<style>{style}</style>\n</head>\n",
            f"<!-- Contains three.js:\n{licence}-->\n<body>\n",
            '<main id="page"></main>\n',
            "<noscript>This page needs JavaScript.</noscript>\n",
            f'<script type="application/json" id="data">{_json(data)}</script>\n',
            *(f"<script>{source}</script>\n" for source in sources),
            "</body>\n</html>\n",
        ]
    )


def _json(data: Mapping[str, Any]) -> str:
    text = json.dumps(data, allow_nan=False, separators=(",", ":"))
    return text.replace("<", "\\u003c").replace(">", "\\u003e").replace("&", "\\u0026")


def _script(name: str) -> str:
    # An element ends at its closing tag even within a text of the script.
    return _asset(name).replace("</script", "<\\/script")


def _asset(name: str) -> str:
    return (files("flexor.viewer") / "assets" / name).read_text(encoding="utf-8")


def _hash(source: str) -> str:
    digest = hashlib.sha256(source.encode()).digest()
    return f"'sha256-{base64.b64encode(digest).decode()}'"
