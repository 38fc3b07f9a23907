"""Check spelling and wording with codespell: `python .ci/prose.py [FILE ...]`, by default all.

Two passes: codespell's own dictionary, and the phrases of `.ci/vocabulary.txt`, in codespell's
format, which may have several words. `codespell:ignore` in a line's comment lets it stand.
"""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

from codespell_lib import main as codespell

ROOT = Path(__file__).resolve().parent.parent
VOCABULARY = ROOT / ".ci" / "vocabulary.txt"
SUFFIXES = (".md", ".py", ".pyi", ".rs", ".toml", ".yml", ".cff", "dev")
# Terms that look like mistakes.
IGNORED = "statics,fro"


def phrases() -> str:
    """Return a regular expression for the phrases, as words or parts of names."""
    lines = VOCABULARY.read_text(encoding="utf-8").splitlines()
    known = sorted((line.partition("->")[0] for line in lines), key=len, reverse=True)
    return rf"(?i)(?<![a-z])(?:{'|'.join(map(re.escape, known))})(?![a-z])"


def tracked() -> list[str]:
    """Return the files that people read, without tests: those make mistakes on purpose."""
    listed = subprocess.run(
        ["git", "ls-files", "--cached", "--others", "--exclude-standard", "-z"],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=True,
    )
    return [str(ROOT / name) for name in listed.stdout.split("\0") if (ROOT / name).is_file()]


def main() -> int:
    """Return how many lines are to be changed."""
    tests = str(ROOT / "tests")
    files = [
        name
        for name in sys.argv[1:] or tracked()
        if name.endswith(SUFFIXES) and not str(Path(name).resolve()).startswith(tests)
    ]
    spelling = codespell("--ignore-words-list", IGNORED, *files)
    wording = codespell("--dictionary", str(VOCABULARY), "--regex", phrases(), *files)
    return min(spelling + wording, 1)


if __name__ == "__main__":
    sys.exit(main())
