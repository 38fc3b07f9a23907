"""Random model files are either valid or rejected with one sentence."""

from __future__ import annotations

import copy
import json
from collections.abc import Iterator
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from flexor.errors import InputError
from flexor.model import Model, parse, presets, read
from flexor.model.reading import check, locate

FILES = {name: json.loads(json.dumps(read(locate(name)).to_document())) for name in presets()}
SCALARS = st.one_of(
    st.none(),
    st.booleans(),
    st.integers(),
    st.floats(),
    st.text(max_size=8),
    st.sampled_from(["10 cm", "-1 N", "exosuit", "ph_1", "finger", "rod", "nan m", "legendre"]),
)
KEYS = st.one_of(st.text(max_size=4), st.sampled_from(["kind", "length", "radius", "world", "at"]))
VALUES = st.recursive(
    SCALARS,
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(KEYS, inner, max_size=3),
    max_leaves=6,
)


def places(table: Any, above: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    entries = table.items() if isinstance(table, dict) else enumerate(table)
    for key, value in entries:
        yield (*above, key)
        if isinstance(value, (dict, list)):
            yield from places(value, (*above, key))


@settings(deadline=None)
@given(st.data())
def test_one_value_replaced_by_anything(data: st.DataObject) -> None:
    document = copy.deepcopy(FILES[data.draw(st.sampled_from(presets()))])
    *above, last = data.draw(st.sampled_from(list(places(document))))
    table = document
    for key in above:
        table = table[key]
    table[last] = data.draw(VALUES)
    try:
        model = Model(check(document, source="file.toml"), source="file.toml")
    except InputError as error:
        assert str(error).startswith("file.toml: ")
        assert str(error).endswith(".")
        assert "\n" not in str(error)
    else:
        assert model.dof == len(model.engine.coordinates)


@given(st.text(max_size=60))
def test_any_text(text: str) -> None:
    with pytest.raises(InputError):
        parse(text)


@given(
    st.dictionaries(
        st.sampled_from(["bodies", "name", "planar", "constants", "variants", "use"]), VALUES
    )
)
def test_any_tables(document: dict[str, Any]) -> None:
    with pytest.raises(InputError):
        check(document)
