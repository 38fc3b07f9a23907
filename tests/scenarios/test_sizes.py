"""Sizes that together serve a population."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest

import flexor
from flexor.cli.app import main
from flexor.errors import InputError
from flexor.model.reading import check
from flexor.scenarios import Scenario
from flexor.study.sizes import _choose, sizes

VARIED = {"exosuit.length": ("8 cm", "12 cm")}


def test_designs_are_chosen_as_by_trying_all() -> None:
    random = np.random.default_rng(1)
    for _ in range(5):
        cost, weights = random.uniform(size=(9, 12)), random.uniform(0.5, 1.0, 12)
        chosen = _choose(cost, weights, 3)
        every = (weights @ cost[list(rows)].min(axis=0) for rows in combinations(range(9), 3))
        assert weights @ cost[chosen].min(axis=0) <= min(every) * 1.02
        assert len(set(chosen)) == 3


def test_two_sizes_for_two_kinds_of_fingers(tmp_path) -> None:
    """Each serves its kind, better than one size serves all."""
    document = flexor.load("pneumatic-finger").file.to_document()
    document["bodies"]["exosuit"]["elements"] = 8
    for name, place in (("proximal", 0.25), ("middle", 0.625), ("distal", 0.875)):
        document["straps"][name]["at"] = place
    model = flexor.load(check(document))
    people = [
        Scenario(f"{kind} {i}", 1.0, {"bodies": {"ph_1": {"length": f"{length + 0.02 * i} cm"}}})
        for kind, length in (("short", 3.2), ("long", 5.6))
        for i in range(2)
    ]
    words = {
        "scenarios": people,
        "method_options": {"tolerance": 0.01},
        "budget": 25,
    }
    found = sizes(model, VARIED, "maximise angle.ph_3", 2, folder=tmp_path / "s", **words)
    assert found.served == 1.0
    for i in range(2):
        kinds = {each.name.split()[0] for each in found.members(i)}
        assert len(kinds) == 1
        assert found.studies[i].folder == tmp_path / "s" / f"size-{i + 1}"
        design = found.design(i)
        assert design is not None and design.feasible
        assert all(row.place.partition(":")[0].split()[0] in kinds for row in design.kept)
    one = sizes(model, VARIED, "maximise angle.ph_3", 1, **words)
    each = np.arange(4)
    assert found.shown[found.size, each].mean() > one.shown[one.size, each].mean()
    assert flexor.study.rerun(tmp_path / "s" / "size-1").same
    with pytest.raises(InputError, match="sizes is 7, more than the 4 wearers"):
        sizes(model, VARIED, "maximise bending", 7, **words)


def test_a_size_that_serves_no_one_is_called_so(capsys, tmp_path) -> None:
    """Though every constraint holds, no finger bends so far."""
    words = ["pneumatic-finger", "--vary", "exosuit.length=8 cm:11 cm", "--maximise", "bending"]
    aim = ["--wearers", "2", "--sizes", "1", "--aggregate", "served 170 deg", "--budget", "8"]
    with pytest.raises(SystemExit) as ended:
        main(["optimize", *words, *aim, "--out", str(tmp_path / "s")])
    assert not ended.value.code
    said = capsys.readouterr().out
    assert "size 1 SERVES NO ONE: no wearer reaches 170 deg" in said
    assert "feasible" not in said and "0 % of 2 wearers are served" in said
