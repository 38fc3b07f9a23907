"""What of a reproduction must not depend on when and how often it was interrupted."""

from __future__ import annotations

import csv
import re
from pathlib import Path

from flexor.paper import Reproduction


def timeless(report: Path) -> str:
    """The page without its times."""
    return re.sub(r'<span class="time">[^<]*</span>', "", report.read_text(encoding="utf-8"))


def everything(done: Reproduction) -> dict[str, object]:
    """Report, tables and figures without times."""
    timed = {
        f"{table.name}.csv": [i for i, column in enumerate(table.columns) if column.timing]
        for section in done.sections
        for table in section.all_tables
    }
    found: dict[str, object] = {"report": timeless(done.report)}
    for file in sorted((done.folder / "tables").iterdir()):
        rows = list(csv.reader(file.open(encoding="utf-8")))
        found[file.name] = [
            [cell for i, cell in enumerate(row) if i not in timed[file.name]] for row in rows
        ]
    for file in sorted((done.folder / "figures").iterdir()):
        found[file.name] = file.read_bytes()
    return found
