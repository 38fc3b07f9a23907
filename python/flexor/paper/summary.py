"""The findings in Markdown, for the documentation."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from flexor.paper.section import Section, Table


def summary(
    sections: Sequence[Section],
    about: Mapping[str, str],
    lead: str,
    images: str | None,
) -> str:
    """Return the findings in Markdown.

    Parameters
    ----------
    sections : sequence of Section
        In the order they are shown.
    about : dict of str
        Where the numbers come from.
    lead : str
        What it is, in a sentence or two.
    images : str or None
        Where the pictures are, as PNG, relative to the text; None leaves them out.

    Returns
    -------
    str
        Markdown: the words, the pictures and the short tables of every section.
    """
    parts = [
        "# The published study, reproduced",
        f"<!-- Written by `{about['command']} --docs`; do not edit. -->",
        lead,
    ]
    for section in sections:
        parts.append(f"## {section.title}")
        parts += section.text
        if images is not None:
            parts += [
                f"![{picture.caption}]({images}/{picture.name}.png)" for picture in section.pictures
            ]
        parts += [_table(table) for table in section.all_tables if table.brief]
    parts.append("## Where the numbers come from")
    listed = [f"- {key}: `{value}`" for key, value in about.items()]
    # No times: the same numbers are the same page.
    parts.append("\n".join(listed))
    return "\n\n".join(parts) + "\n"


def _table(table: Table) -> str:
    kept = [i for i, column in enumerate(table.columns) if not column.timing]
    lines = [table.caption, ""]
    lines.append("| " + " | ".join(table.columns[i].title for i in kept) + " |")
    lines.append("|" + "---|" * len(kept))
    lines += [
        "| " + " | ".join(table.columns[i].shown(row[i]) for i in kept) + " |" for row in table.rows
    ]
    return "\n".join(lines)
