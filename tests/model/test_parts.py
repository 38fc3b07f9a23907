"""Models that are made of others: poses, mirror images, names, inputs, variants, and bad files."""

from __future__ import annotations

import os
import pickle
import warnings
from pathlib import Path

import numpy as np
import pytest

import flexor
from flexor.design.drawn_file import drawn_file
from flexor.errors import InputError
from flexor.model import Model, load, parse
from flexor.model.reading import locate
from flexor.model.separate import Separate

ARM = """
name = "arm"

[bodies.base]
kind = "link"
length = "5 cm"
radius = { base = "2 cm", tip = "1.5 cm" }
placement = { x = "1 cm", y = "2 cm", rotation = { x = "10 deg", y = "-20 deg", z = "30 deg" } }
joint = { kind = "revolute", axis = [0.6, 0.0, 0.8], stiffness = "0.3 N*m/rad" }

[bodies.slider]
kind = "link"
parent = "base"
length = "3 cm"
radius = "1 cm"
joint = { kind = "prismatic", axis = [0.0, 0.6, 0.8], stiffness = "50 N/m" }

[bodies.turned]
kind = "link"
parent = "slider"
length = "3 cm"
radius = "1 cm"
joint = { kind = "universal", stiffness = "0.2 N*m/rad" }

[bodies.rod]
kind = "rod"
parent = "base"
placement = { y = "1 cm", z = "1 cm", reference = "underside" }
length = "12 cm"
radius = { base = "8 mm", tip = "6 mm" }
young_modulus = "100 kPa"
poisson_ratio = 0.4
reference_strain = { twist_x = "1 1/m", bend_y = "2 1/m", bend_z = "-3 1/m", shear_y = 0.05 }
elements = 3
gauss_points = 3
strain = { twist_x = "nodal_linear", bend_y = "nodal_linear", bend_z = "nodal_linear", \
extend_x = "nodal_linear", shear_y = "nodal_linear", shear_z = "nodal_linear" }

[actuators.helix]
kind = "cable"
rod = "rod"
path = { radius = "5 mm", start = "20 deg", turn = "50 deg" }

[actuators.side]
kind = "chamber"
rod = "rod"
path = { y = ["3 mm", "1 mm", "2 mm"], z = "1 mm" }
lever = { y = 0.2, z = 0.5 }

[springs.line]
first = { body = "turned", at = "tip", offset = { y = "1 cm" } }
second = { world = { x = "10 cm", y = "-3 cm", z = "2 cm" } }
stiffness = "20 N/m"
rest_length = "1 cm"

[torques.spastic]
kind = "spastic"
body = "turned"
coordinate = "theta_z"
threshold = "2 deg"
stiffness = "0.1 N*m/rad"

[couplings.both]
first = "turned"
second = "turned"
first_coordinate = "theta_y"
second_coordinate = "theta_z"
ratio = 0.7
offset = "5 deg"
stiffness = "0.1 N*m/rad"

[obstacles.wall]
kind = "half-space"
spheres = ["hand"]
normal = [0.2, -0.6, 1.0]
point = { x = "10 cm", y = "1 cm", z = "1 cm" }
stiffness = "100 N/m"

[spheres.hand]
bodies = ["turned", "slider"]
"""
# Coordinates that change their sign in the mirror.
ODD = ("theta_z", "twist_x", "bend_z", "shear_y")


def written(folder: Path, text: str, name: str = "whole.toml") -> Path:
    (folder / "arm.toml").write_text(ARM)
    (folder / name).write_text(text)
    return folder / name


def whole(folder: Path, keys: str, more: str = "") -> Model:
    text = f'name = "whole"\n{more}\n[parts.a]\nfile = "arm.toml"\n{keys}\n'
    return load(written(folder, text))


def states(model: Model, seed: int = 1) -> np.ndarray:
    return 0.2 * np.random.default_rng(seed).uniform(-1.0, 1.0, model.dof)


def signs(model: Model) -> np.ndarray:
    names = [name.rpartition(".")[2].partition("[")[0] for name in model.engine.coordinates]
    return np.array([-1.0 if name in ODD else 1.0 for name in names])


def energy(model: Model, q: np.ndarray) -> float:
    return model.engine.energy(model.parameters, q, np.full(len(model.inputs), 0.7))


def frames(model: Model, q: np.ndarray) -> np.ndarray:
    return np.asarray(model.engine.frames(model.parameters, q))


def test_a_part_is_where_it_is_placed(tmp_path: Path) -> None:
    turn = 'rotation = { x = "40 deg", z = "-70 deg" }'
    place = f'placement = {{ x = "3 cm", y = "-2 cm", z = "1 cm", {turn} }}'
    model = whole(tmp_path, place)
    alone = load(tmp_path / "arm.toml")
    q = states(alone)
    assert model.joints == tuple(f"a.{name}" for name in alone.joints)
    assert model.inputs == ("a.helix", "a.side")
    from scipy.spatial.transform import Rotation

    frame = np.eye(4)
    frame[:3, :3] = Rotation.from_rotvec(np.radians([40.0, 0.0, -70.0])).as_matrix()
    frame[:3, 3] = [0.03, -0.02, 0.01]
    expected = frames(alone, q)
    expected[1:] = frame @ expected[1:]  # all but the world
    assert frames(model, q) == pytest.approx(expected, abs=1e-14)
    # Its springs to the world and its obstacles went with it.
    assert energy(model, q) == pytest.approx(energy(alone, q), rel=1e-12)


def test_a_part_at_the_tip_of_a_body(tmp_path: Path) -> None:
    body = """[bodies.palm]
kind = "link"
length = "8 cm"
radius = "2 cm"
placement = { rotation = { y = "25 deg" } }
joint = { kind = "revolute", axis = "z", stiffness = "1 N*m/rad" }
"""
    model = whole(tmp_path, 'parent = "palm"', body)
    alone = load(tmp_path / "arm.toml")
    q = states(alone)
    at = model.engine.coordinates.index("palm.theta")
    moved = np.insert(q, at, 0.0)
    assert energy(model, moved) == pytest.approx(energy(alone, q), rel=1e-12)
    # Its world turns with the palm: nothing in it feels that.
    turned = np.insert(q, at, 0.4)
    assert energy(model, turned) - 0.5 * 0.4**2 == pytest.approx(energy(alone, q), rel=1e-12)
    found = model.engine.frames(model.parameters, turned)
    first, last = model.body_frames["palm"]
    assert model.file.obstacles["a.wall"].point.body == "palm"  # type: ignore[union-attr]
    tip = found[last - 1]
    root, _ = model.body_frames["a.base"]
    start, _ = alone.body_frames["base"]
    assert found[root] == pytest.approx(tip @ frames(alone, q)[start], abs=1e-14)
    assert first < last


def test_the_mirror_image(tmp_path: Path) -> None:
    model, alone = whole(tmp_path, "mirror = true"), load(tmp_path / "arm.toml")
    q = states(alone)
    image = signs(alone) * q
    assert energy(model, image) == pytest.approx(energy(alone, q), rel=1e-12)
    flip = np.diag([1.0, -1.0, 1.0, 1.0])
    expected = flip @ frames(alone, q) @ flip
    expected[0] = np.eye(4)
    assert frames(model, image) == pytest.approx(expected, abs=1e-14)
    # The mirror image of the mirror image is the model itself.
    (tmp_path / "twice.toml").write_text(
        'name = "twice"\n[parts.b]\nfile = "whole.toml"\nmirror = true\n'
    )
    twice = load(tmp_path / "twice.toml")
    assert twice.joints[0] == "b.a.base.theta"
    assert energy(twice, q) == pytest.approx(energy(alone, q), rel=1e-12)


def test_scale_is_that_of_lengths(tmp_path: Path) -> None:
    model, alone = whole(tmp_path, "scale = 2.0"), load(tmp_path / "arm.toml")
    q = states(alone)
    lengths = np.array([name.endswith(".d") for name in alone.engine.coordinates])
    larger = np.where(lengths, 2.0 * q, q)
    expected = frames(alone, q)
    expected[:, :3, 3] *= 2.0
    assert frames(model, larger) == pytest.approx(expected, abs=1e-14)
    table, own = model.file.bodies["a.rod"], alone.file.bodies["rod"]
    assert table.young_modulus == own.young_modulus  # type: ignore[union-attr]
    assert model.file.bodies["a.base"].joint == alone.file.bodies["base"].joint
    assert table.reference_strain.bend_y == pytest.approx(0.5 * own.reference_strain.bend_y)  # type: ignore[union-attr]
    # The same material makes a rod of twice the size eight times as stiff as a whole.
    bent = {name: i for i, name in enumerate(alone.engine.coordinates) if ".bend_y" in name}
    for index in bent.values():
        one, two = (
            each.engine.tangent(each.parameters, 0 * q, [0.0, 0.0]) for each in (alone, model)
        )
        assert two[index, index] == pytest.approx(8.0 * one[index, index], rel=1e-12)


def test_variants_sets_and_changes_of_parts(tmp_path: Path) -> None:
    more = """
[parts.a]
file = "arm.toml"
set = { "rod.length" = "13 cm" }

[variants.small]
parts.a.scale = 0.5
bodies."a.base".radius = { base = "3 cm" }
"""
    path = written(tmp_path, f'name = "whole"\n{more}')
    assert float(load(path).file.bodies["a.rod"].length) == pytest.approx(0.13)
    small = load(path, "small")
    assert float(small.file.bodies["a.rod"].length) == pytest.approx(0.065)
    assert float(small.file.bodies["a.base"].radius.base) == pytest.approx(0.03)  # type: ignore[union-attr]
    assert small.file.bodies["a.base"].length == pytest.approx(0.025)
    changes = {
        "parts.a.scale": 0.25,
        "a.rod.length": "9 cm",
        "parts.a.set.rod.young_modulus": "2 MPa",
    }
    changed = load(path, changes=changes)
    assert float(changed.file.bodies["a.rod"].length) == pytest.approx(0.09)
    assert float(changed.file.bodies["a.base"].length) == pytest.approx(0.0125)
    assert changed.file.bodies["a.rod"].young_modulus == 2e6  # type: ignore[union-attr]


def test_it_is_written_as_one_file(tmp_path: Path) -> None:
    model = whole(tmp_path, "scale = 1.5\nmirror = true")
    again = parse(model.to_toml())
    assert again == model.file
    assert Model(again).hash == model.hash
    assert pickle.loads(pickle.dumps(model)).hash == model.hash


GLOVE = """
name = "two"
planar = true
[parts.index]
file = "pneumatic-finger"
[parts.middle]
file = "pneumatic-finger.toml"
scale = 1.1
[inputs]
air = ["index.chamber", "middle.chamber"]
[evaluation]
loads = { air = "0:48:24 kPa" }
"""


def test_parts_that_are_not_joined_are_followed_by_themselves(tmp_path: Path) -> None:
    path = written(tmp_path, GLOVE)
    model, together = load(path), load(path)
    together.__dict__["followed"] = together.engine  # the whole as one system
    found, expected = model.equilibrium(), together.equilibrium()
    assert model.inputs == ("air",)
    assert found.converged.all() and found.stable.all()
    for name in ("q", "energy", "volume", "applied", "rod_bending", "max_overlap", "stretch"):
        assert getattr(found, name) == pytest.approx(getattr(expected, name), rel=1e-6, abs=1e-7), (
            name
        )
    assert (found.touching == expected.touching).all()
    # As alone: the same numbers.
    alone = load("pneumatic-finger").equilibrium(["0 kPa", "24 kPa", "48 kPa"])
    assert (found.joint_angles[:, :3] == alone.joint_angles).all()
    frames_here, frames_alone = found.frames(-1), alone.frames(-1)
    assert frames_here["index.exosuit"] == pytest.approx(frames_alone["exosuit"], abs=1e-12)
    assert set(found.to_dict()["volume"]) == {"index.chamber", "middle.chamber"}


def test_designs_of_one_part_are_followed_once_for_the_others(tmp_path: Path) -> None:
    """With their snaps, and each with the states of the others."""
    parts = "".join(f'[parts.{key}]\nfile = "truss"\n' for key in "ab")
    text = f'name = "two"\nplanar = true\n{parts}[inputs]\nload = ["a.push", "b.push"]\n'
    model = load(written(tmp_path, text))
    assert isinstance(model.followed, Separate)
    bounds = {f"{key}.left.stiffness": ("0.8 kN/m", "1.3 kN/m") for key in "ab"}
    chosen = flexor.design.variables(bounds, model)
    x = np.array([[1.0, 1.0], [1.1, 1.0], [1.0, 1.1], [1.0, 1.0], [1.1, 1.1]]) * chosen.start
    slots, valid = chosen.designs(x, model)
    assert valid.all()
    found = model.evaluate(slots, "0:0.4:0.1 N")
    for k in range(len(x)):
        alone = model.evaluate(slots[k : k + 1], "0:0.4:0.1 N")
        np.testing.assert_array_equal(found.q[k], alone.q[0])
        np.testing.assert_array_equal(found.energy[k], alone.energy[0])
        assert len(found.event_table[k]) >= 1
        for name in found.event_table[k].dtype.names:
            np.testing.assert_array_equal(
                found.event_table[k][name], alone.event_table[0][name], err_msg=name
            )
        assert found[k].free.tolist() == alone[0].free.tolist()


def test_derivatives_of_separate_parts(tmp_path: Path) -> None:
    path = written(tmp_path, GLOVE)
    model, together = load(path), load(path)
    together.__dict__["followed"] = together.engine
    names = ("index.exosuit.section.wall", "middle.ph_2.joint.stiffness", "*.exosuit.radius.base")
    ends = [("1.5 mm", "2.5 mm"), ("0.02 N*m/rad", "0.05 N*m/rad"), ("7 mm", "9 mm")]
    rows = []
    for each in (model, together):
        chosen = flexor.design.variables(dict(zip(names, ends, strict=True)), each)
        assert chosen.fields[-2:] == ("index.exosuit.radius.base", "middle.exosuit.radius.base")
        designs = np.array([chosen.start, chosen.start * 1.02])
        slots, valid = chosen.designs(designs, each)
        assert valid.all()
        paths = each.evaluate(slots, gradient=True)
        assert (paths.regularity == "regular").all()
        rows.append(paths.gradient @ chosen.slot_jacobian(designs, each))
        if each is model:
            step = 1e-5
            for k in range(3):
                sides = []
                for side in (-1.0, 1.0):
                    moved = designs.copy()
                    moved[:, k] *= 1.0 + side * step
                    angles = each.evaluate(chosen.designs(moved, each)[0]).joint_angles[:, -1]
                    sides.append(angles)
                slope = (sides[1] - sides[0]) / (2.0 * step * designs[:, k, None])
                size = np.abs(slope).max()
                assert rows[0][:, :-1, k] == pytest.approx(slope, abs=1e-4 * size)
    assert rows[0][:, :-1] == pytest.approx(
        rows[1][:, :-1], rel=1e-6, abs=1e-6 * np.abs(rows[1]).max()
    )


def test_a_pattern_keeps_ratios(tmp_path: Path) -> None:
    model = load(written(tmp_path, GLOVE))
    chosen = flexor.design.variables({"*.exosuit.section.wall": ("1 mm", "3 mm")}, model)
    assert chosen.labels == ("*.exosuit.section.wall",)
    changes = chosen.changes(np.array([1.5e-3]))
    made = load(model.file, changes=changes)
    walls = [made.file.bodies[f"{part}.exosuit"].section.wall for part in ("index", "middle")]  # type: ignore[union-attr]
    assert walls == pytest.approx([1.5e-3, 1.65e-3], rel=1e-12)
    # Also beside a load, which changes nothing of what is drawn.
    both = {
        "*.exosuit.section.wall": ("1 mm", "3 mm"),
        "evaluation.loads.air": ("24 kPa", "48 kPa"),
    }
    chosen = flexor.design.variables(both, model)
    drawn = drawn_file(chosen, np.array([1.5e-3, 30e3]), model)
    walls = [drawn.bodies[f"{part}.exosuit"].section.wall for part in ("index", "middle")]  # type: ignore[union-attr]
    assert walls == pytest.approx([1.5e-3, 1.65e-3], rel=1e-12)


def test_a_wrong_key_in_a_pattern_is_that_of_the_entry_that_is_meant(tmp_path: Path) -> None:
    """Not one of a body with a name of one part, whose keys begin after the first dot."""
    model = load(written(tmp_path, GLOVE))
    with pytest.raises(InputError, match=r'index\.exosuit\.lenth.*did you mean "length"'):
        flexor.design.variables({"*.exosuit.lenth": ("8 cm", "10 cm")}, model)


def test_every_alternative_of_a_pattern_is_one(tmp_path: Path) -> None:
    model = load(written(tmp_path, GLOVE))
    both = flexor.design.variables({"{index,middle}.exosuit.length": ("8 cm", "10 cm")}, model)
    assert both.size == 1
    with pytest.raises(InputError, match=r'nothing is like "mddle" \(did you mean "middle"\?\)'):
        flexor.design.variables({"{index,mddle}.exosuit.length": ("8 cm", "10 cm")}, model)


def test_a_failure_is_that_of_the_part_that_failed(tmp_path: Path) -> None:
    model = load(written(tmp_path, GLOVE))
    start, stop = model.engine.slots["middle.exosuit.length"]
    slots = flexor.model.SlotValues(np.arange(start, stop), np.array([[0.11], [-1.0]]))
    paths = model.evaluate(slots)
    assert paths.converged[0].all()
    assert (paths.status[1] == "invalid-design").all()
    assert np.isnan(paths.q[1]).all()


@pytest.mark.parametrize("error", [ValueError("could not broadcast"), TypeError("not a number")])
def test_a_defect_is_no_error_of_the_input(
    error: Exception, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    model = load(written(tmp_path, GLOVE))

    def broken(*_: object) -> None:
        raise error

    monkeypatch.setattr("flexor.model.separate.Separate._together", broken)
    with pytest.raises(type(error)) as found:
        model.equilibrium()
    assert not isinstance(found.value, InputError)


BAD = {
    "itself": (
        '[parts.a]\nfile = "whole.toml"',
        "a model cannot be a part of itself (whole.toml -> whole.toml)",
    ),
    "scale": (
        '[parts.a]\nfile = "arm.toml"\nscale = 0.0',
        "parts.a.scale is 0.0: it must be at least 0.01",
    ),
    "huge": (
        '[parts.a]\nfile = "arm.toml"\nscale = 1e9',
        "parts.a.scale is 1000000000.0: it must be at most 100",
    ),
    "missing": (
        '[parts.a]\nfile = "arn.toml"',
        'the unknown file "arn.toml" (did you mean "arm.toml"?)',
    ),
    "outside": (
        '[parts.a]\nfile = "../arm.toml"',
        "the file of a part must be in the folder of the model file, or in one within it",
    ),
    "absolute": (
        '[parts.a]\nfile = "/etc/passwd"',
        "the file of a part must be in the folder of the model file, or in one within it",
    ),
    "twice": ('[parts.a]\nfile = "arm.toml"\n[parts.a]\nfile = "arm.toml"', "not valid TOML"),
    "clash": (
        '[bodies."a.rod"]\nkind = "link"\nlength = "1 cm"\nradius = "1 cm"\n'
        '[parts.a]\nfile = "arm.toml"',
        'bodies."a.rod" has the name of an entry of the part "a"',
    ),
    "part and body": (
        '[bodies.a]\nkind = "link"\nlength = "1 cm"\nradius = "1 cm"\n[parts.a]\nfile = "arm.toml"',
        'bodies.a has the same name as the part "a", of which bodies.a.base is: rename one',
    ),
    "a table": (
        '[parts.start]\nfile = "arm.toml"',
        "a part cannot have the name of a table of the file",
    ),
    "parent": (
        '[parts.a]\nfile = "arm.toml"\nparent = "palm"',
        'parts.a.parent refers to the unknown body "palm"',
    ),
    "reference": (
        '[parts.a]\nfile = "arm.toml"\n[contacts.c]\nfirst = "a.hnd"\nsecond = "a.hand"\n'
        'stiffness = "1 N/m"',
        'contacts.c.first refers to the unknown sphere group "a.hnd" (did you mean "a.hand"?)',
    ),
    "key": (
        '[parts.a]\nfile = "arm.toml"\nscal = 1.0',
        'parts.a has an unknown key "scal" (did you mean "scale"?)',
    ),
    "set": (
        '[parts.a]\nfile = "arm.toml"\nset = { "rud.length" = "1 cm" }',
        'unknown field "rud" (did you mean "rod"?)',
    ),
    "variant": ('[parts.a]\nfile = "arm.toml"\nvariant = "x"', 'unknown variant "x"'),
    "inputs": (
        '[parts.a]\nfile = "arm.toml"\n[inputs]\nair = ["a.helx"]',
        'inputs.air refers to the unknown input "a.helx" (did you mean "a.helix"?)',
    ),
    "two inputs": (
        '[parts.a]\nfile = "arm.toml"\n[inputs]\none = ["a.helix"]\ntwo = ["a.helix"]',
        'inputs.two contains "a.helix", which inputs.one drives: a force has one input',
    ),
    "variants": (
        '[parts.a]\nfile = "arm.toml"\n[variants.v]\nparts.b.scale = 2.0',
        'variants.v.parts has an unknown part "b": expected "a"',
    ),
}


@pytest.mark.parametrize("case", BAD)
def test_bad_files(case: str, tmp_path: Path) -> None:
    text, expected = BAD[case]
    path = written(tmp_path, f'name = "whole"\n{text}\n')
    with pytest.raises(InputError) as error:
        load(path)
    assert expected in str(error.value)
    assert str(error.value).startswith(str(path))


def test_a_misspelt_table_of_parts() -> None:
    """The nearest key is ``parts``, which models do not keep."""
    with pytest.raises(InputError, match='unknown key "part" \\(did you mean "parts"\\?\\)'):
        parse('name = "one"\n[part.index]\nfile = "glove-finger"')
    with pytest.raises(InputError, match='unknown field "part" \\(did you mean "parts"\\?\\)'):
        flexor.load("glove", changes={"part.index.scale": 1.1})


def test_a_ring_of_parts(tmp_path: Path) -> None:
    for name, other in (("one", "two"), ("two", "one")):
        written(tmp_path, f'name = "{name}"\n[parts.p]\nfile = "{other}.toml"\n', f"{name}.toml")
    with pytest.raises(InputError, match=r"\(one\.toml -> two\.toml -> one\.toml\)"):
        load(tmp_path / "one.toml")


HEAVY = 'name = "h"\nplanar = true\n{}\n[parts.a]\nfile = "wrist"\n'


def test_gravity_of_a_part_is_left_behind(tmp_path: Path) -> None:
    with pytest.warns(flexor.ModelWarning, match=r'"wrist.toml" has gravity, which a part leaves'):
        file = parse(HEAVY.format(""))
    assert not any(file.gravity.components)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        for stated in ("0 m/s^2", "-9.81 m/s^2"):
            parse(HEAVY.format(f'gravity = {{ z = "{stated}" }}'))
        # That of a part of a part, too.
        text = HEAVY.format('gravity = { z = "1 m/s^2" }').replace('"wrist"', '"middle.toml"')
        written(tmp_path, HEAVY.format(""), "middle.toml")
        load(written(tmp_path, text))


def test_links_are_no_presets(tmp_path: Path) -> None:
    """A link that leads nowhere or out of the folder, with the name of a preset."""
    folder = tmp_path / "here"
    folder.mkdir()
    path = written(folder, 'name = "x"\nplanar = true\n[parts.a]\nfile = "column.toml"\n')
    assert "a.column" in load(path).body_frames
    if os.name == "nt":
        pytest.skip("making links needs a privilege")
    link, target = folder / "column.toml", tmp_path / "elsewhere.toml"
    link.symlink_to(target)
    with pytest.raises(InputError, match=r"column.toml\", which leads to a file that does not"):
        load(path)
    target.write_text(ARM)
    with pytest.raises(InputError, match="which leads out of the folder of the model file"):
        load(path)
    examples = tmp_path / "examples"
    assert locate(examples / "column.toml").name == "column.toml"
    examples.mkdir()
    (examples / "column.toml").symlink_to(tmp_path / "nothing")
    with pytest.raises(InputError, match=r"cannot read the model file .*: no such file"):
        locate(examples / "column.toml")


def test_a_text_without_a_place_has_presets_only() -> None:
    text = 'name = "x"\nplanar = true\n[parts.a]\nfile = "{}"\n'
    assert "a.exosuit" in parse(text.format("pneumatic-finger.toml")).bodies
    with pytest.raises(InputError, match="refers to the unknown file"):
        parse(text.format("arm.toml"))
