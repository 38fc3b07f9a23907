"""Design variables of parts that do nothing to one another: a part's map is found on it alone."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pytest

import flexor
from flexor.design import variables
from flexor.design.changes_by_part import ChangesByPart
from flexor.design.lowered import Lowered, parameters_with
from flexor.design.parts_map import PartsMap
from flexor.model import Model, parse
from flexor.study.fragility import numbers

HAND = """
name = "hand"
[materials.rubber]
library = "ecoflex-00-30"
[bodies.palm]
kind = "link"
length = "7 cm"
radius = "1 cm"
[parts.index]
file = "glove-finger"
parent = "palm"
[parts.middle]
file = "glove-finger"
parent = "palm"
placement = { y = "3 cm", rotation = { z = "10 deg" } }
scale = 1.1
"""
FIELDS: dict[str, tuple[object, object]] = {
    "index.exosuit.section.wall": ("1.5 mm", "2.2 mm"),
    "index.exosuit.radius.base": ("5 mm", "8 mm"),
    "index.exosuit.length": ("9 cm", "12 cm"),
    "middle.exosuit.section.wall": ("1.5 mm", "2.2 mm"),
    "middle.ph_2.joint.stiffness": ("0.01 N*m/rad", "0.1 N*m/rad"),
    "middle.ph_1.length": ("5 cm", "5.5 cm"),
}


def hand(text: str = HAND) -> Model:
    """Return a hand of two fingers that cannot touch themselves, whatever their length."""
    own = {f"{part}.exosuit.self_contact": False for part in ("index", "middle")}
    return flexor.load(parse(text), changes=own)


def check_values(
    model: Model, bounds: Mapping[str, tuple[object, object]], count: int = 3
) -> flexor.design.Variables:
    """Check that designs have the parameters of changed files, and slopes those of differences."""
    chosen = variables(bounds, model)
    random = np.random.default_rng(0)
    designs = random.uniform(chosen.lower, chosen.upper, (count, chosen.size))
    found, valid = chosen.designs(designs, model)
    assert valid.all()
    for design, values in zip(designs, found.values, strict=True):
        expected = flexor.load(model.file, changes=chosen.changes(design)).parameters
        actual = model.parameters.copy()
        actual[found.indices] = values
        for name, (start, stop) in model.engine.slots.items():
            size = np.abs(expected[start:stop]).max(initial=0.0)
            assert (
                np.abs(actual[start:stop] - expected[start:stop]).max(initial=0.0)
                <= 2e-11 * size + 1e-17
            ), name
    slopes = chosen.slot_jacobian(designs, model)
    for i, span in enumerate((chosen.upper - chosen.lower).tolist()):
        step = 1e-4 * span * np.eye(chosen.size)[i]
        ends = [chosen.designs(designs + side * step, model)[0].values for side in (-1.0, 1.0)]
        difference = (ends[1] - ends[0]) / 2e-4
        size = np.abs(found.values) + np.abs(difference)
        assert (np.abs(slopes[:, :, i] * span - difference) <= 1e-6 * size + 1e-15).all()
    return chosen


def test_each_part_is_lowered_by_itself(monkeypatch: pytest.MonkeyPatch) -> None:
    lowered: list[set[str]] = []
    whole = Lowered.at

    def at(self: Lowered, *given: object) -> np.ndarray:
        lowered.append(set(self._model.file.bodies))
        return whole(self, *given)  # type: ignore[arg-type]

    monkeypatch.setattr(Lowered, "at", at)
    model = hand()
    # A question that was not asked before in this process.
    chosen = check_values(model, {**FIELDS, "index.exosuit.section.wall": ("1.5 mm", "2.1 mm")})
    found = chosen._map(model)
    assert isinstance(found, PartsMap)
    assert [each.fields.tolist() for each in found.groups] == [[0, 1, 2], [3, 4, 5]]
    own = {
        frozenset({"palm", *(f"{part}.{body}" for body in ("ph_1", "ph_2", "ph_3", "exosuit"))})
        for part in ("index", "middle")
    }
    assert set(map(frozenset, lowered)) == own
    # A third of what three variables that interact take, and no more for those of another part.
    assert len(lowered) < 200


def test_the_map_of_another_hand_follows() -> None:
    model = hand()
    chosen = check_values(model, FIELDS, 1)
    other = flexor.load(model.file, changes={"index.ph_1.joint.stiffness": "0.1 N*m/rad"})
    designs = np.array([chosen.start])
    expected = variables(FIELDS, other).designs(designs, other)[0]
    found = chosen.designs(designs, other)[0]
    assert isinstance(chosen._map(other), PartsMap)
    np.testing.assert_array_equal(found.indices, expected.indices)
    np.testing.assert_allclose(found.values, expected.values, rtol=1e-10, atol=1e-18)


def test_what_parts_have_in_common_joins_them() -> None:
    """The material of both, and the link that carries both."""
    text = HAND.replace("[materials.rubber]", "[materials.silicone]").replace(
        "ecoflex-00-30", "dragon-skin-30"
    )
    model = hand(text)
    fields = {
        "palm.length": ("6 cm", "8 cm"),
        "index.exosuit.section.wall": ("1.5 mm", "2.2 mm"),
        "index.fabric.young_modulus": ("20 MPa", "40 MPa"),
    }
    chosen = check_values(model, fields, 1)
    assert not isinstance(chosen._map(model), PartsMap)
    alone = check_values(model, {"index.fabric.young_modulus": ("20 MPa", "40 MPa")}, 1)
    assert isinstance(alone._map(model), PartsMap)


def test_parts_that_are_tied_interact() -> None:
    web = """
[springs.web]
first = { body = "index.ph_1", at = "tip" }
second = { body = "middle.ph_1", at = "tip" }
stiffness = "10 N/m"
rest_length = "1 cm"
"""
    model = hand(HAND + web)
    fields = {name: FIELDS[name] for name in list(FIELDS)[2:5]}
    assert not isinstance(check_values(model, fields, 1)._map(model), PartsMap)


def test_a_loop_slides_off_the_end_of_its_link() -> None:
    """Its rest length has a kink where the nearest place is the end of the link."""
    model = flexor.load("glove-finger", changes={"exosuit.self_contact": False})
    bounds: dict[str, tuple[object, object]] = {
        "exosuit.length": ("8.5 cm", "12.5 cm"),
        "exosuit.radius.base": ("5 mm", "8 mm"),
        "ph_1.length": ("4.5 cm", "5 cm"),
    }
    chosen = check_values(model, bounds, 8)
    column = model.engine.slots["middle.rest_length"][0]
    designs = np.repeat(chosen.start[None], 400, axis=0)
    designs[:, 0] = np.linspace(chosen.lower[0], chosen.upper[0], 400)
    found = chosen.designs(designs, model)[0]
    lengths = found.values[:, found.indices.tolist().index(column)]
    turns = np.abs(np.diff(lengths, 2))
    assert turns.max() > 100.0 * np.median(turns)


def test_every_number_changed_on_its_part_is_that_of_the_whole() -> None:
    model = hand()
    changes, found = ChangesByPart(model), 0
    for keys, value in numbers(model):
        expected = parameters_with(model, {keys: 1.01 * value})
        actual = changes.parameters_with(keys, 1.01 * value)
        assert (actual is None) == (expected is None), keys
        if expected is not None and actual is not None:
            np.testing.assert_array_equal(actual, expected, err_msg=".".join(keys))
            found += not np.array_equal(expected, model.parameters)
    assert found > 80
