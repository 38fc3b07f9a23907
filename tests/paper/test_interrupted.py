"""Killed at any moment and resumed, a reproduction ends in the same report."""

from __future__ import annotations

import json
import subprocess
import sys

import numpy as np
import pytest

from flexor.errors import InputError
from flexor.paper import Settings, kept_settings, reproduce

from .timeless import everything

# Studies, comparisons, parts, tables and figures, and not all of the drawing.
ITEMS = ("fig4", "table3", "optimisers")
RUN = """
import json, sys
from flexor.paper import Settings, reproduce
out, resume, values = sys.argv[1], sys.argv[2] == "resume", json.loads(sys.argv[3])
only = None if resume else sys.argv[4].split()
reproduce(out, only, settings=None if resume else Settings(**values), resume=resume)
"""


@pytest.fixture(scope="module")
def uninterrupted(small, tmp_path_factory) -> dict[str, object]:
    return everything(reproduce(tmp_path_factory.mktemp("p") / "out", ITEMS, settings=small))


def differing(first: dict[str, object], second: dict[str, object]) -> list[str]:
    return [name for name in {**first, **second} if first.get(name) != second.get(name)]


def test_interrupted_again_and_again(uninterrupted, small, tmp_path) -> None:
    out, interruptions = tmp_path / "out", 0
    # Each attempt lives a little longer than the one before, so that it comes to an end.
    for life in (3, 30, 60, 120, None):
        told = 0

        def tell(_: object, life: int | None = life) -> None:
            nonlocal told
            told += 1
            if told == life:
                raise KeyboardInterrupt

        begun = (out / "reproduction.json").exists()
        try:
            done = reproduce(
                out,
                None if begun else ITEMS,
                settings=None if begun else small,
                resume=begun,
                told=tell,
            )
            break
        except KeyboardInterrupt:
            interruptions += 1
    assert interruptions >= 3
    assert differing(uninterrupted, everything(done)) == []


def test_killed_at_random(uninterrupted, small, tmp_path) -> None:
    out, random, kills = tmp_path / "out", np.random.default_rng(0), 0
    while True:
        begun = (out / "reproduction.json").exists()
        how = "resume" if begun else "new"
        words = [
            sys.executable,
            "-c",
            RUN,
            str(out),
            how,
            json.dumps(small.to_dict()),
            " ".join(ITEMS),
        ]
        process = subprocess.Popen(words, stderr=subprocess.PIPE)
        try:
            # The first lives are short, the fifth is whole.
            process.wait(None if kills >= 4 else random.uniform(2.0, 6.0))
        except subprocess.TimeoutExpired:
            process.kill()
            process.communicate()
            kills += 1
            continue
        _, said = process.communicate()
        assert process.returncode == 0, said.decode()
        break
    done = reproduce(out, resume=True)
    assert kills >= 1
    assert differing(uninterrupted, everything(done)) == []


def test_a_comparison_that_was_not_quite_made_is_made_anew(tmp_path, small) -> None:
    begun = tmp_path / "out" / "studies" / "comparison"
    reproduce(tmp_path / "out", "fig3", settings=small)
    begun.mkdir(parents=True)
    (begun / "model.toml").write_text("half", encoding="utf-8")
    done = reproduce(tmp_path / "out", "optimisers", resume=True)
    assert [section.name for section in done.sections] == ["fig3", "optimisers"]


def test_other_settings_are_refused(tmp_path, small) -> None:
    out = tmp_path / "out"
    reproduce(out, "fig3", settings=small)
    assert kept_settings(out) == small
    with pytest.raises(InputError, match="was made with grid = 5, not 81"):
        reproduce(out, resume=True, settings=Settings())
    stamp = out / "reproduction.json"
    values = json.loads(stamp.read_text())
    values["provenance"]["model finger"] = "another"
    stamp.write_text(json.dumps(values))
    with pytest.raises(InputError, match="was made with model finger another, now it is"):
        reproduce(out, resume=True)


def test_one_process_at_a_time(tmp_path, small) -> None:
    from flexor.store import Lock

    out = tmp_path / "out"
    reproduce(out, "fig3", settings=small)
    lock = Lock(out)
    try:
        with pytest.raises(InputError, match="in use by another process"):
            reproduce(out, resume=True)
    finally:
        lock.release()
