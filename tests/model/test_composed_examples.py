"""Every example, twice in a model or beside another one, is what it is alone."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
import pytest

import flexor
from flexor.model import Model, Path, parse, presets
from flexor.model.schema import ModelFile
from flexor.model.separate import Separate

# All of their path would take seconds.
FRACTIONS = {"capstan": 0.02, "glove": 0.2}
CASES = [case for case in itertools.product(presets(), (True, False)) if case != ("capstan", False)]
PAIRED = ("finger-two-chambers", "four-bar", "load-cell", "muscle-finger", "tendon-arm", "wrist")


def composed(names: Sequence[str], planar: bool) -> Model:
    """Return a model of two examples, with the gravity of the first."""
    weight = flexor.load(names[0]).file.gravity.components
    pairs = zip("xyz", weight, strict=True)
    gravity = ", ".join(f"{axis} = '{float(g)!r} m/s^2'" for axis, g in pairs)
    head = f'name = "both"\nplanar = {str(planar).lower()}\ngravity = {{ {gravity} }}\n'
    parts = [f'[parts.{key}]\nfile = "{name}"\n' for key, name in zip("ab", names, strict=True)]
    return Model(parse(head + "".join(parts)))


def alone(name: str, whole: Model) -> Model:
    """Return an example by itself, in the plane or in space and with the gravity of the whole."""
    document = flexor.load(name).file.to_document()
    for table in ("variants", "constants", "use"):
        document.pop(table, None)
    gravity = whole.file.to_document().get("gravity", {"x": 0.0})
    return Model(ModelFile.model_validate({**document, "planar": whole.planar, "gravity": gravity}))


def followed(names: Sequence[str], planar: bool) -> tuple[Path, list[Path]]:
    """Return the path of a model of two examples, and that of each alone."""
    model, paths, columns = composed(names, planar), [], {}
    for key, name in zip("ab", names, strict=True):
        own, loads = alone(name, model), flexor.load(name).evaluation_loads
        largest = np.abs(loads).sum(axis=1).argmax()
        loads = FRACTIONS.get(name, 1.0) * loads[largest] * np.array([[0.5], [1.0]])
        paths.append(own.equilibrium(loads))
        columns |= {f"{key}.{each}": loads[:, i] for i, each in enumerate(own.inputs)}
    return model.equilibrium(np.column_stack([columns[name] for name in model.inputs])), paths


def by_name(document: Any, *keys: str) -> Iterator[tuple[tuple[str, ...], Any]]:
    """Yield what a document has for each name of an entry of the model."""
    for key, value in document.items():
        if isinstance(value, dict):
            yield from by_name(value, *keys, key)
        elif keys and keys[0] not in ("loads", "places"):
            yield (*keys, key), value


def check_same(found: Path, paths: Sequence[Path], tolerance: float = 1e-8) -> None:
    """Check that each of both has the path that it has alone."""
    model, document = found.model, dict(by_name(found.to_dict()))
    for key, path in zip("ab", paths, strict=True):
        assert (found.status == path.status).all()
        names = [f"{key}.{name}" for name in path.model.engine.coordinates]
        q = found.q[:, [model.engine.coordinates.index(name) for name in names]]
        np.testing.assert_allclose(q, path.q, rtol=0.0, atol=tolerance * np.abs(path.q).max())
        for (table, entry, *more), value in by_name(path.to_dict()):
            expected = np.array(value, dtype=float)
            size = np.nanmax(np.abs(expected), initial=0.0)
            np.testing.assert_allclose(
                np.array(document.pop((table, f"{key}.{entry}", *more)), dtype=float),
                expected,
                rtol=0.0,
                atol=100.0 * tolerance * size + 1e-12,
                err_msg=f"{table} of {key}.{entry}",
            )
    assert not document
    energy = np.sum([path.energy for path in paths], axis=0)
    np.testing.assert_allclose(found.energy, energy, rtol=1e-6)
    tip = np.sum([path.tip_force for path in paths], axis=0)
    if isinstance(model.followed, Separate):
        np.testing.assert_allclose(found.tip_force, tip, rtol=1e-6, atol=1e-9)


def check_slopes(found: Path) -> None:
    """Check derivatives of all that an equilibrium gives with those of the whole as one system."""
    model = found.model
    groups = model.engine.outputs
    weights = np.eye(max(stop for _, stop in groups.values()))
    # The sum of those of the components, which is not that of the whole; see docs/method.md.
    weights[slice(*groups["tip_force"])] = 0.0
    none, first = np.zeros(0, dtype=np.intp), np.zeros(1, dtype=np.intp)
    sums, wanted = np.zeros(len(weights), dtype=np.intp), np.arange(len(model.parameters))
    at = (none, np.zeros((1, 0)), first, found.q[-1:], found.applied[-1:])
    one, other = (
        each.differentiate(*at, sums, weights, wanted) for each in (model.followed, model.engine)
    )
    assert (one["regularity"] == other["regularity"]).all()
    for name in ("by_parameters", "by_loads"):
        size = np.abs(other[name]).max(axis=1, keepdims=True, initial=0.0)
        assert (np.abs(one[name] - other[name]) <= 1e-6 * size + 1e-8).all(), name


@pytest.mark.parametrize(("name", "planar"), CASES)
def test_an_example_twice(name: str, planar: bool) -> None:
    if planar and not flexor.load(name).planar:
        with pytest.raises(flexor.InputError, match=r"^model: bodies\.a\.\S+ is .* planar"):
            composed((name, name), planar)
        return
    found, paths = followed((name, name), planar)
    check_same(found, paths)
    if isinstance(found.model.followed, Separate) and name != "glove":
        check_slopes(found)


@pytest.mark.parametrize("names", [*itertools.combinations(PAIRED, 2)], ids="+".join)
def test_two_examples(names: tuple[str, str]) -> None:
    check_same(*followed(names, planar=False))


CABLES = """
name = "links"
planar = true
evaluation = {{ loads = {{ {loads} }} }}
{parts}
"""
LINK = """
[bodies.{name}]
kind = "link"
length = "4 cm"
radius = "4 mm"
placement = {{ z = "{z} mm" }}
joint = {{ kind = "revolute", stiffness = "0.05 N*m/rad" }}

[tendons.{name}-cable]
kind = "cable"
path = [
    {{ world = {{ x = "-2 cm", z = "{z} mm" }} }},
    {{ body = "{name}", at = "tip", offset = {{ z = "6 mm" }} }},
]
"""


def links(loads: dict[str, str], places: Sequence[int]) -> Model:
    """Return links at heights [mm], each with a cable of its own."""
    parts = [LINK.format(name=name, z=z) for name, z in zip(loads, places, strict=True)]
    each = [f'{name}-cable = "{load}"' for name, load in loads.items()]
    return Model(parse(CABLES.format(parts="".join(parts), loads=", ".join(each))))


def test_tendons_of_separate_components() -> None:
    """Each has its own rows among lengths and tensions, and among their derivatives."""
    loads = {"one": "0:4:2 N", "two": "0:2:1 N"}
    model = links(loads, (0, 30))
    assert isinstance(model.followed, Separate)
    found = model.equilibrium()
    for (name, load), place in zip(loads.items(), (0, 30), strict=True):
        path, cable = links({name: load}, (place,)).equilibrium(), f"{name}-cable"
        assert np.ptp(path.tendon_lengths()[cable]) > 1e-4
        for read in (Path.tendon_lengths, Path.tendon_forces):
            np.testing.assert_allclose(read(found)[cable], read(path)[cable], rtol=1e-12)
    check_slopes(found)


def test_tendons_of_separate_components_around_one_wrap() -> None:
    """A post in the world, which is in both; and one on a link is in that of its tendon."""
    post = """
[wraps.post]
kind = "cylinder"
point = { x = "-1 cm", z = "1 cm" }
radius = "4 mm"

[wraps.knuckle]
kind = "sphere"
point = { body = "two", at = "base" }
radius = "3 mm"
"""
    loads = {"one": "0:0.4:0.2 N", "two": "0:0.2:0.1 N"}
    file = links(loads, (0, 8)).file.to_toml()
    document = flexor.model.toml.tables(file, "links")
    for name in loads:
        path = document["tendons"][f"{name}-cable"]["path"]
        path.insert(1, {"wrap": "post", "side": {"world": {"x": "-1 cm", "z": "3 cm"}}})
    document |= flexor.model.toml.tables(post, "post")
    side = {"body": "two", "at": "base", "offset": {"z": "2 cm"}}
    document["tendons"]["two-cable"]["path"][2:2] = [
        {"world": {"x": "-5 mm", "z": "14 mm"}},
        {"wrap": "knuckle", "side": side},
    ]
    model = Model(ModelFile.model_validate(document))
    together = Model(model.file)
    together.__dict__["followed"] = together.engine
    assert isinstance(model.followed, Separate)
    assert [len(each.rows["coordinates"]) for each in model.followed.components] == [1, 1]
    found, expected = model.equilibrium(), together.equilibrium()
    assert found.converged.all()
    np.testing.assert_allclose(found.q, expected.q, rtol=1e-8, atol=1e-12)
    check_slopes(found)
