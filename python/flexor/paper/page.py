"""The report as one HTML page that needs nothing else.

Written with plain string formatting: one page of one fixed structure, which no one extends with
templates of their own, does not earn a template library among the dependencies.
"""

from __future__ import annotations

import base64
from collections.abc import Mapping, Sequence
from html import escape

from flexor.paper.section import Cell, Column, Picture, Section, Table
from flexor.paper.symbols import marked

CSS = """
:root { color-scheme: light; --line: #d5dade; --ink: #24292e; --soft: #59636b; --yes: #00664b;
  --no: #a33c00; }
* { box-sizing: border-box; }
body { margin: 0 auto; max-width: 62rem; padding: 2rem 1.25rem 5rem; color: var(--ink);
  background: white; font: 16px/1.55 system-ui, "Segoe UI", Roboto, "DejaVu Sans", sans-serif; }
h1 { font-size: 1.75rem; line-height: 1.25; margin: 0 0 .5rem; }
h2 { font-size: 1.25rem; margin: 3.25rem 0 .5rem; padding-top: .75rem;
  border-top: 1px solid var(--line); }
p { margin: .6rem 0; max-width: 46rem; }
nav ul { columns: 2; padding-left: 1.1rem; margin: 1rem 0; }
a { color: #005a8f; }
figure { margin: 1.5rem 0; }
figure img { max-width: 100%; height: auto; display: block; }
figcaption, caption { color: var(--soft); font-size: .875rem; text-align: left; max-width: 46rem; }
caption { padding: 0 0 .4rem; caption-side: top; }
.table { overflow-x: auto; margin: 1.5rem 0; }
table { border-collapse: collapse; font-size: .875rem; line-height: 1.35; }
th, td { padding: .28rem .7rem .28rem 0; border-bottom: 1px solid var(--line);
  vertical-align: top; text-align: left; }
th { font-weight: 600; vertical-align: bottom; border-bottom: 2px solid var(--ink); }
th.number, td.number { text-align: right; font-variant-numeric: tabular-nums; }
td.number { white-space: nowrap; }
sub { line-height: 0; }
tbody tr:hover { background: #f4f6f8; }
.yes { color: var(--yes); font-weight: 600; } .no { color: var(--no); font-weight: 600; }
.hash { font-family: ui-monospace, "DejaVu Sans Mono", monospace; font-size: .8125rem;
  overflow-wrap: anywhere; }
.unit { color: var(--soft); font-weight: 400; white-space: nowrap; }
@media print { h2 { break-after: avoid; } figure, tr { break-inside: avoid; }
  .table { overflow: visible; } }
"""


def page(
    sections: Sequence[Section],
    images: Mapping[str, bytes],
    about: Mapping[str, str],
    took: str,
    lead: str,
) -> str:
    """Return the report.

    Parameters
    ----------
    sections : sequence of Section
        In the order they are shown.
    images : dict of bytes
        PNG of each picture, by its name.
    about : dict of str
        Where the numbers come from.
    took : str
        How long it all took, in words.
    lead : str
        What the report is, in a sentence or two.

    Returns
    -------
    str
        HTML with style and images inside.
    """
    title = "The published study, reproduced"
    contents = "\n".join(
        f'<li><a href="#{section.name}">{marked(section.title)}</a></li>' for section in sections
    )
    rows = "\n".join(
        f'<tr><th scope="row">{escape(key)}</th><td class="hash">{escape(value)}</td></tr>'
        for key, value in about.items()
    )
    return f"""<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>{title}</title>
<style>{CSS}</style>
</head>
<body>
<h1>{title}</h1>
<p>{marked(lead)}</p>
<nav aria-label="Contents"><ul>
{contents}
<li><a href="#provenance">Where the numbers come from</a></li>
</ul></nav>
{chr(10).join(_section(section, images) for section in sections)}
<section id="provenance">
<h2>Where the numbers come from</h2>
<div class="table"><table><tbody>
{rows}
<tr><th scope="row">time</th><td><span class="time">{took}</span></td></tr>
</tbody></table></div>
</section>
</body>
</html>
"""


def _section(section: Section, images: Mapping[str, bytes]) -> str:
    parts = [f"<p>{marked(paragraph)}</p>" for paragraph in section.text]
    parts += [_figure(picture, images[picture.name]) for picture in section.pictures]
    parts += [_table(table) for table in section.all_tables]
    inside = "\n".join(parts)
    heading = f"<h2>{marked(section.title)}</h2>"
    return f'<section id="{section.name}">\n{heading}\n{inside}\n</section>'


def _figure(picture: Picture, image: bytes) -> str:
    caption = picture.caption
    return (
        f'<figure><img alt="{escape(caption)}" '
        f'src="data:image/png;base64,{base64.b64encode(image).decode()}">\n'
        f"<figcaption>{marked(caption)}</figcaption></figure>"
    )


def _table(table: Table) -> str:
    numeric = [_numeric(table, column) for column in range(len(table.columns))]
    head = "".join(
        f'<th scope="col"{_number_class(right)}>{_heading(column)}</th>'
        for column, right in zip(table.columns, numeric, strict=True)
    )
    body = "\n".join(
        "<tr>"
        + "".join(
            f"<td{_number_class(right)}>{_cell(column, cell)}</td>"
            for column, cell, right in zip(table.columns, row, numeric, strict=True)
        )
        + "</tr>"
        for row in table.rows
    )
    return (
        f'<div class="table"><table>\n<caption>{marked(table.caption)}</caption>\n'
        f"<thead><tr>{head}</tr></thead>\n<tbody>\n{body}\n</tbody></table></div>"
    )


def _heading(column: Column) -> str:
    unit = f' <span class="unit">/ {escape(column.unit)}</span>' if column.unit else ""
    return marked(column.heading) + unit


def _cell(column: Column, cell: Cell) -> str:
    shown = marked(column.shown(cell))
    if isinstance(cell, bool):
        return f'<span class="{"yes" if cell else "no"}">{shown}</span>'
    return f'<span class="time">{shown}</span>' if column.timing else shown


def _numeric(table: Table, column: int) -> bool:
    return any(
        isinstance(row[column], (int, float)) and not isinstance(row[column], bool)
        for row in table.rows
    )


def _number_class(right: bool) -> str:
    return ' class="number"' if right else ""
